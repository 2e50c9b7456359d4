/// Tables as text; a column's name and the format of its values are given together.
#pragma once

#include <fmt/format.h>

#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace settings {

///     auto table = TextTable::screen("surface:<18|c1:>9.4f");
///     for (const Surface& s : surfaces) table.add(s.name, s.c1);
///     fmt::print("{}", table.text());
///
/// Columns are separated by |; the last colon of a column separates its name from its fmt format, if any. Names and text values use only the
/// alignment and width of that format.
class TextTable {
  public:
    /// Columns of fixed width, each line after `indent`.
    [[nodiscard]] static TextTable screen(std::string_view columns, std::string_view indent = {}) { return {columns, indent, "", "\n"}; }
    /// Values are not quoted: pass text that may contain a separator through csv_field().
    [[nodiscard]] static TextTable csv(std::string_view columns) { return {columns, "", ",", "\n"}; }
    [[nodiscard]] static TextTable markdown(std::string_view columns) {
        TextTable table(columns, "| ", " | ", " |\n");
        for (std::size_t i = 0; i < table.formats_.size(); ++i) table.text_ += "|---";
        table.text_ += "|\n";
        return table;
    }

    /// Adds the next values of the row; a row ends after its last column. A std::optional without value leaves the cell empty.
    template <typename... Values>
    void add(const Values&... values) {
        (put(values), ...);
    }
    /// Adds `text` unchanged as a line below the rows so far.
    void line(std::string_view text) { text_.append(text).push_back('\n'); }

    [[nodiscard]] const std::string& text() const { return text_; }

  private:
    struct Format {
        std::string value, text;
    };

    TextTable(std::string_view columns, std::string_view begin, std::string_view between, std::string_view end)
        : begin_(begin), between_(between), end_(end) {
        std::vector<std::string_view> names;
        for (std::size_t from = 0; from <= columns.size(); from += names.back().size() + 1) {
            const std::string_view column = names.emplace_back(columns.substr(from, columns.find('|', from) - from));
            const auto colon = column.rfind(':');
            const std::string spec(colon == std::string_view::npos ? std::string_view() : column.substr(colon + 1));
            formats_.push_back({"{:" + spec + "}", "{:" + spec.substr(0, spec.find_first_not_of("<>0123456789")) + "}"});
        }
        for (const std::string_view name : names) put(name.substr(0, name.rfind(':')));
    }

    template <typename Value>
    void put(const Value& value) {
        const Format& format = formats_[next_];
        text_ += next_ == 0 ? begin_ : between_;
        const std::size_t before = text_.size();
        fmt::format_to(std::back_inserter(text_), fmt::runtime(std::is_convertible_v<Value, std::string_view> ? format.text : format.value), value);
        if (text_.size() == before && between_ == " | ") text_.pop_back();  // one blank in an empty cell of Markdown
        next_ = (next_ + 1) % formats_.size();
        if (next_ == 0) text_ += end_;
    }
    template <typename Value>
    void put(const std::optional<Value>& value) {
        value ? put(*value) : put(std::string_view());
    }

    std::vector<Format> formats_{};
    std::string begin_, between_, end_;
    std::string text_{};
    std::size_t next_ = 0;  ///< column
};

}  // namespace settings
