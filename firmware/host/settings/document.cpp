#include <algorithm>
#include <utility>

#include "firmware/host/settings/content.hpp"
#include "firmware/host/settings/input_file.hpp"
#include "firmware/host/settings/near_miss.hpp"

namespace settings {

namespace {

/// The parser builds one table inside another for every dot of a dotted key and takes them down recursively,
/// so the length of a line bounds the stack it needs.
void reject_long_lines(std::string_view text, const std::string& name) {
    constexpr std::size_t kLongestLine = 4096;
    std::uint32_t line = 1;
    while (!text.empty()) {
        const auto length = std::min(text.find('\n'), text.size());
        if (length > kLongestLine) throw Error(name, line, "", "the line is longer than " + std::to_string(kLongestLine) + " bytes");
        text.remove_prefix(std::min(length + 1, text.size()));
        ++line;
    }
}

}  // namespace

Document Document::load(const std::filesystem::path& path) {
    return parse(read_file(path), path.string());
}

Document Document::parse(std::string text, std::string name) {
    reject_long_lines(text, name);
    auto content = std::make_shared<Content>();
    content->name = std::move(name);
    content->text = std::move(text);
    try {
        content->root = toml::parse(std::string_view(content->text), content->name);
    } catch (const toml::parse_error& error) {
        throw Error(content->name, error.source().begin.line, "", printable(error.description()));
    }
    return Document(std::move(content));
}

Table Document::root() const {
    return Table(std::make_shared<const Table::Scope>(Table::Scope{content_, &content_->root, "", ""}));
}

const std::string& Document::bytes() const {
    return content_->text;
}

void Document::finish() const {
    std::vector<Table::Scope::Unknown> unknown;
    for (std::vector<Table> pending{root()}; !pending.empty();) {
        const auto table = std::move(pending.back());
        pending.pop_back();
        table.scope_->inspect(unknown, pending);
    }
    const auto first = std::min_element(unknown.begin(), unknown.end(), [](const auto& a, const auto& b) { return a.place < b.place; });
    if (first != unknown.end()) first->scope.reject_unknown(first->key);
}

}  // namespace settings
