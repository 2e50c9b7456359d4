#include "rig_bridge/record/specimen.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <string_view>

namespace rig::record {

namespace {

/// Length of the UTF-8 character at the start of `text`; 0: there is none. Overlong forms and surrogates do not count.
std::size_t utf8_length(std::string_view text) {
    const auto byte = [text](std::size_t i) -> unsigned { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
    const unsigned first = byte(0);
    if (first < 0x80U) return 1;
    const std::size_t length = first < 0xC2U ? 0 : first < 0xE0U ? 2 : first < 0xF0U ? 3 : first < 0xF5U ? 4 : 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xC0U) != 0x80U) return 0;
    const unsigned second = byte(1);
    const bool none = (first == 0xE0U && second < 0xA0U) || (first == 0xEDU && second > 0x9FU) || (first == 0xF0U && second < 0x90U) ||
                      (first == 0xF4U && second > 0x8FU);
    return none ? 0 : length;
}

}  // namespace

void check_text(const std::string& what, const std::string& text) {
    if (text.size() > kLongestText)
        throw std::invalid_argument(fmt::format("{}: {} bytes are too long; at most {}", what, text.size(), kLongestText));
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = utf8_length(std::string_view(text).substr(i));
        if (length == 0) throw std::invalid_argument(fmt::format("{}: byte {} is no UTF-8", what, i + 1));
        const auto c = static_cast<unsigned char>(text[i]);
        if (c < 0x20U || c == 0x7FU)
            throw std::invalid_argument(fmt::format("{}: byte {} is a control character (0x{:02x}); expected a text of one line", what, i + 1, c));
        i += length;
    }
}

void check_texts(const Specimen& specimen) {
    for (const SpecimenField& field : kSpecimenFields) check_text(field.option, specimen.*field.value);
}

Specimen taken_over(Specimen said, const Specimen& before) {
    for (const SpecimenField& field : kSpecimenFields)
        if ((said.*field.value).empty()) said.*field.value = before.*field.value;
    return said;
}

std::string to_text(const Specimen& specimen) {
    std::string text;
    for (const SpecimenField& field : kSpecimenFields) {
        const std::string& value = specimen.*field.value;
        if (!value.empty()) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", field.label, value);
    }
    return text;
}

}  // namespace rig::record
