#include "rig_bridge/wear/provenance.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace wear {

namespace {

int distrust(const std::string& origin) {
    if (origin.starts_with("made up")) return 2;
    return origin == kUnknownOrigin ? 1 : 0;
}

}  // namespace

bool is_origin(std::string_view text) {
    return text == kUnknownOrigin || text.starts_with("measured") || text.starts_with("made up");
}

std::string origin_phrase(const std::string& origin) {
    return origin == kUnknownOrigin ? "of " + origin : origin;
}

std::string Provenance::sentence() const {
    return fmt::format("{}, {} {}", origin_phrase(origin), lives, lives == 1 ? "life" : "lives");
}

std::string common_origin(const std::vector<std::string>& origins) {
    if (origins.empty()) return kUnknownOrigin;
    const auto worst =
        std::max_element(origins.begin(), origins.end(), [](const std::string& a, const std::string& b) { return distrust(a) < distrust(b); });
    const auto alike = std::count(origins.begin(), origins.end(), *worst);
    const auto all = static_cast<std::ptrdiff_t>(origins.size());
    return alike == all || *worst == kUnknownOrigin ? *worst : fmt::format("{} ({} of {} lives; others are of other origin)", *worst, alike, all);
}

}  // namespace wear
