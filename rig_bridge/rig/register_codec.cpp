#include "rig_bridge/rig/register_codec.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace rig {
namespace {

/// The raw value of an integer field, or the bits of a float32.
std::uint32_t to_bits(RegisterType type, double raw) {
    switch (type) {
        case RegisterType::u16:
        case RegisterType::u32:
            return static_cast<std::uint32_t>(std::llround(raw));
        case RegisterType::i16:
            return static_cast<std::uint16_t>(static_cast<std::int16_t>(std::llround(raw)));
        case RegisterType::float32:
            break;
    }
    return std::bit_cast<std::uint32_t>(static_cast<float>(raw));
}

double from_bits(RegisterType type, std::uint32_t bits) {
    switch (type) {
        case RegisterType::u16:
        case RegisterType::u32:
            return bits;
        case RegisterType::i16:
            return static_cast<std::int16_t>(static_cast<std::uint16_t>(bits));
        case RegisterType::float32:
            break;
    }
    return std::bit_cast<float>(bits);
}

/// About one step of the register: rounding must not make the ends of a range implausible.
double tolerance(const Field& field) {
    if (field.type != RegisterType::float32) return 0.5 * std::abs(field.scale);
    constexpr double kStep = 0x1p-23;
    return kStep * std::max({std::abs(field.min), std::abs(field.max), std::abs(field.offset)});
}

unsigned moved(unsigned bits, unsigned from, unsigned to) {
    return (bits >> from & 1U) << to;
}

}  // namespace

std::string_view name(ValueQuality quality) {
    constexpr std::array<std::string_view, 4> kNames{"never read", "good", "implausible", "not a number"};
    return kNames[static_cast<std::size_t>(quality)];
}

Reading decode(const Field& field, WordOrder order, std::span<const std::uint16_t> words) {
    std::uint32_t bits = words[0];
    if (width(field.type) == 2) {
        const std::uint32_t high = order == WordOrder::big ? words[0] : words[1];
        const std::uint32_t low = order == WordOrder::big ? words[1] : words[0];
        bits = high << 16U | low;
    }
    const double value = from_bits(field.type, bits) * field.scale + field.offset;
    if (std::isnan(value)) return {value, ValueQuality::not_a_number};
    const double slack = tolerance(field);
    const bool plausible = value >= field.min - slack && value <= field.max + slack;
    return {value, plausible ? ValueQuality::good : ValueQuality::implausible};
}

bool encode(const Field& field, WordOrder order, double value, std::span<std::uint16_t> words) {
    if (std::isnan(value)) return false;
    const double raw = (std::clamp(value, field.min, field.max) - field.offset) / field.scale;
    const std::uint32_t bits = to_bits(field.type, raw);
    const auto low = static_cast<std::uint16_t>(bits & 0xFFFFU);
    if (width(field.type) == 1) {
        words[0] = low;
        return true;
    }
    const auto high = static_cast<std::uint16_t>(bits >> 16U);
    words[0] = order == WordOrder::big ? high : low;
    words[1] = order == WordOrder::big ? low : high;
    return true;
}

RegisterImage::RegisterImage(std::span<const Field> fields, WordOrder order) : order_(order) {
    if (fields.empty()) return;
    std::size_t end = 0;
    std::size_t first = 65536;
    for (const Field& field : fields) {
        first = std::min<std::size_t>(first, field.address);
        end = std::max<std::size_t>(end, std::size_t{field.address} + width(field.type));
    }
    first_ = static_cast<std::uint16_t>(first);
    words_.resize(end - first);
}

std::span<std::uint16_t> RegisterImage::words(std::uint16_t address, std::size_t count) {
    return std::span(words_).subspan(static_cast<std::size_t>(address - first_), count);
}

std::span<const std::uint16_t> RegisterImage::words(std::uint16_t address, std::size_t count) const {
    return std::span(words_).subspan(static_cast<std::size_t>(address - first_), count);
}

Reading RegisterImage::read(const Field& field) const {
    return decode(field, order_, words(field.address, width(field.type)));
}

bool RegisterImage::write(const Field& field, double value) {
    return encode(field, order_, value, words(field.address, width(field.type)));
}

unsigned interlocks_from_register(const RegisterMap& map, unsigned bits) {
    unsigned result = 0;
    for (unsigned i = 0; i < kInterlockCount; ++i) result |= moved(bits, map.interlock_bit[i], i);
    return result;
}

unsigned interlocks_to_register(const RegisterMap& map, unsigned bits) {
    unsigned result = 0;
    for (unsigned i = 0; i < kInterlockCount; ++i) result |= moved(bits, i, map.interlock_bit[i]);
    return result;
}

Reading read(const RegisterMap& map, const RegisterImage& inputs, Measured q) {
    Reading reading = inputs.read(map.field(q));
    if (q == Measured::interlocks) reading.value = interlocks_from_register(map, static_cast<unsigned>(reading.value));
    return reading;
}

void write(const RegisterMap& map, RegisterImage& inputs, const MeasuredValues& values) {
    for (std::size_t i = 0; i < kMeasuredCount; ++i) {
        const auto q = static_cast<Measured>(i);
        double value = values[i];
        if (q == Measured::interlocks && value >= 0.0 && value < 65536.0) value = interlocks_to_register(map, static_cast<unsigned>(value));
        static_cast<void>(inputs.write(map.measured[i], value));
    }
}

CommandedValues read_commanded(const RegisterMap& map, const RegisterImage& holdings) {
    CommandedValues values{};
    for (std::size_t i = 0; i < kCommandedCount; ++i) values[i] = holdings.read(map.commanded[i]).value;
    return values;
}

}  // namespace rig
