/// A number in a text.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace settings {

/// The number that all of `text` is, e.g. number_in<double>("0.24"), number_in<int>("7F0", 16); nothing where it is none, or none of that type.
template <typename Number, typename... Base>
[[nodiscard]] std::optional<Number> number_in(std::string_view text, Base... base) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base...);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace settings
