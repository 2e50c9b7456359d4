/// Converts between SI values and 16-bit registers.
///
/// Writing: raw = (value - offset) / scale, rounded to the nearest, halves away from zero. A value outside the field's
/// declared range is saturated to it first; NaN is refused and leaves the registers as they are. Reading: raw * scale +
/// offset, with a validity; an invalid value is returned unchanged. float32 is IEEE 754 binary32.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "rig_bridge/rig/register_map.hpp"

namespace rig {

enum class ValueQuality : std::uint8_t {
    never,  ///< not read yet
    good,
    implausible,   ///< outside its declared range, infinities included
    not_a_number,  ///< float32 NaN
};
[[nodiscard]] std::string_view name(ValueQuality quality);

struct Reading {
    double value = 0.0;
    ValueQuality quality = ValueQuality::never;
};

/// `words`: the field's width(field.type) registers.
[[nodiscard]] Reading decode(const Field& field, WordOrder order, std::span<const std::uint16_t> words);
/// False, and `words` untouched, for NaN.
[[nodiscard]] bool encode(const Field& field, WordOrder order, double value, std::span<std::uint16_t> words);

/// The registers of one space from the lowest to the highest used address. Unused ones are 0.
class RegisterImage {
  public:
    RegisterImage(std::span<const Field> fields, WordOrder order);

    [[nodiscard]] std::uint16_t first() const { return first_; }  ///< address of words()[0]
    [[nodiscard]] std::span<std::uint16_t> words() { return words_; }
    [[nodiscard]] std::span<const std::uint16_t> words() const { return words_; }
    /// `count` registers from `address` on, which must be inside.
    [[nodiscard]] std::span<std::uint16_t> words(std::uint16_t address, std::size_t count);
    [[nodiscard]] std::span<const std::uint16_t> words(std::uint16_t address, std::size_t count) const;

    [[nodiscard]] Reading read(const Field& field) const;
    [[nodiscard]] bool write(const Field& field, double value);

    friend bool operator==(const RegisterImage&, const RegisterImage&) = default;

  private:
    std::uint16_t first_ = 0;
    WordOrder order_;
    std::vector<std::uint16_t> words_;
};

/// Bits of Measured::interlocks, between the register's numbering and Interlock's.
[[nodiscard]] unsigned interlocks_from_register(const RegisterMap& map, unsigned bits);
[[nodiscard]] unsigned interlocks_to_register(const RegisterMap& map, unsigned bits);

/// One quantity of an image of input registers in SI; the interlock bits are numbered as Interlock.
[[nodiscard]] Reading read(const RegisterMap& map, const RegisterImage& inputs, Measured q);
/// Encodes all values; NaN leaves its register unchanged.
void write(const RegisterMap& map, RegisterImage& inputs, const MeasuredValues& values);

[[nodiscard]] CommandedValues read_commanded(const RegisterMap& map, const RegisterImage& holdings);

}  // namespace rig
