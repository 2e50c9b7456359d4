#include "rig_bridge/replay/id_filter.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <stdexcept>

namespace rig::replay {

namespace {

std::optional<std::uint32_t> hexadecimal(std::string_view text) {
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace

void IdFilter::add(std::string_view rule) {
    const auto colon = rule.find(':');
    const std::string_view id_text = rule.substr(0, colon);
    const bool extended = id_text.size() == 8;
    const std::uint32_t all = extended ? 0x1FFFFFFFU : 0x7FFU;
    const auto id = hexadecimal(id_text);
    const auto mask = colon == std::string_view::npos ? all : hexadecimal(rule.substr(colon + 1));
    if ((id_text.size() != 3 && !extended) || !id || *id > all || !mask)
        throw std::invalid_argument("--id " + std::string(rule) +
                                    ": expected an identifier of three or eight hexadecimal digits, with or without a mask, "
                                    "like 110, 100:7F0 or 18FF0000");
    rules_.push_back({*id, *mask & all, extended});
}

bool IdFilter::passes(const LogFrame& frame) const {
    return rules_.empty() || std::any_of(rules_.begin(), rules_.end(), [&](const Rule& rule) {
               return frame.extended == rule.extended && ((frame.frame.id ^ rule.id) & rule.mask) == 0;
           });
}

}  // namespace rig::replay
