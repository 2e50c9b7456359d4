/// Position of one value in the eight bytes of a classic CAN frame, and its rounding. Freestanding.
///
/// raw = round((value - offset) / scale), halves away from zero, limited to raw_min..raw_max; value = raw *
/// scale + offset. `value` is in the controller's unit of the quantity (rad/s, Pa, mA, m/s2, N, N m, ns, 1):
/// scale and offset include the conversion from the bus unit.
#pragma once

#include <array>
#include <cstdint>

namespace antiskid::can {

struct Signal {
    std::uint8_t shift = 0;   ///< position of the least significant bit in the payload word of its byte order
    std::uint8_t bits = 0;    ///< 1 to 48; 0: the layout has no such signal
    bool big_endian = false;  ///< Motorola order
    bool is_signed = false;
    std::int64_t raw_min = 0;  ///< encoder's limits: the DBC's range, or the field's if that is narrower
    std::int64_t raw_max = 0;
    double scale = 1.0;      ///< never 0
    double per_scale = 1.0;  ///< 1 / scale
    double offset = 0.0;

    [[nodiscard]] constexpr bool bound() const { return bits != 0; }
    [[nodiscard]] constexpr std::uint64_t mask() const { return (std::uint64_t{1} << bits) - 1U; }

    /// NaN is encoded as 0, so that it cannot become full scale.
    [[nodiscard]] constexpr std::int64_t raw(double value) const {
        const double finite = value == value ? value : 0.0;
        const double scaled = (finite - offset) * per_scale;
        if (!(scaled > static_cast<double>(raw_min))) return raw_min;
        if (!(scaled < static_cast<double>(raw_max))) return raw_max;
        return static_cast<std::int64_t>(scaled < 0.0 ? scaled - 0.5 : scaled + 0.5);
    }
    [[nodiscard]] constexpr double value(std::int64_t raw_value) const { return static_cast<double>(raw_value) * scale + offset; }
    /// The value as the receiver will decode it.
    [[nodiscard]] constexpr double rounded(double unrounded) const { return value(raw(unrounded)); }
};

/// The payload as one 64-bit word in either byte order: byte 0 is the least significant of `intel`, the most
/// of `motorola`.
class Payload {
  public:
    constexpr Payload() = default;
    constexpr explicit Payload(const std::array<std::uint8_t, 8>& bytes) {
        for (std::size_t i = 0; i < bytes.size(); ++i) intel_ |= std::uint64_t{bytes[i]} << (8U * i);
        motorola_ = reversed(intel_);
    }

    [[nodiscard]] constexpr std::int64_t read(const Signal& signal) const {
        const std::uint64_t field = ((signal.big_endian ? motorola_ : intel_) >> signal.shift) & signal.mask();
        const std::uint64_t sign = signal.is_signed ? std::uint64_t{1} << (signal.bits - 1U) : 0U;
        return static_cast<std::int64_t>((field ^ sign) - sign);
    }
    /// The field must still be zero. Bits of `raw` beyond the field are dropped, so that counters roll over.
    constexpr void write(const Signal& signal, std::int64_t raw) {
        const std::uint64_t field = (static_cast<std::uint64_t>(raw) & signal.mask()) << signal.shift;
        (signal.big_endian ? motorola_ : intel_) |= field;
    }
    /// Call after the last write().
    [[nodiscard]] constexpr std::array<std::uint8_t, 8> bytes() const {
        const std::uint64_t word = intel_ | reversed(motorola_);
        std::array<std::uint8_t, 8> out{};
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<std::uint8_t>(word >> (8U * i));
        return out;
    }

  private:
    [[nodiscard]] static constexpr std::uint64_t reversed(std::uint64_t word) {
        std::uint64_t out = 0;
        for (unsigned i = 0; i < 8; ++i) out |= ((word >> (8U * i)) & 0xFFU) << (56U - 8U * i);
        return out;
    }

    std::uint64_t intel_ = 0;
    std::uint64_t motorola_ = 0;
};

}  // namespace antiskid::can
