#include "firmware/can/candump.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>

namespace antiskid::can {

namespace {

constexpr std::int64_t kNanoseconds = 1'000'000'000;
constexpr std::uint32_t kErrorFlag = 0x20000000;
constexpr std::int64_t kMaxSeconds = 9'000'000'000;  // int64 nanoseconds hold 9.2e9 s

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return -1;
}

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

class LineParser {
  public:
    explicit LineParser(std::string_view text) : text_(text) {
        while (!text_.empty() && (text_.back() == '\n' || text_.back() == '\r')) text_.remove_suffix(1);
    }

    std::variant<CandumpLine, CandumpFailure> run() {
        if (!time() || !interface() || !identifier() || !content() || !trailer()) return failure_;
        line_.frame.received = line_.time;
        return line_;
    }

  private:
    bool fail(const char* what) {
        failure_ = {.column = position_ + 1, .what = what};
        return false;
    }
    [[nodiscard]] char here() const { return position_ < text_.size() ? text_[position_] : '\0'; }
    bool take(char c) {
        if (here() != c) return false;
        ++position_;
        return true;
    }

    bool time() {
        constexpr const char* kWanted = "expected the time, like (1436509053.650713)";
        if (!take('(') || !is_digit(here())) return fail(kWanted);
        std::int64_t seconds = 0;
        for (; is_digit(here()); ++position_) {
            seconds = seconds * 10 + (here() - '0');
            if (seconds > kMaxSeconds) return fail("expected a time below 9e9 s");
        }
        if (!take('.') || !is_digit(here())) return fail(kWanted);
        std::int64_t fraction = 0;
        std::int64_t unit = kNanoseconds;
        for (; is_digit(here()); ++position_) {
            if (unit == 1) return fail("expected at most nine decimals");
            unit /= 10;
            fraction += (here() - '0') * unit;
        }
        if (!take(')')) return fail(kWanted);
        line_.time = Time{seconds * kNanoseconds + fraction};
        return true;
    }

    bool interface() {
        if (!take(' ')) return fail("expected a space and the interface");
        while (here() == ' ') ++position_;
        const std::size_t start = position_;
        while (here() != ' ' && here() != '\0') ++position_;
        if (position_ == start) return fail("expected the interface, like vcan0");
        line_.interface = text_.substr(start, position_ - start);
        return true;
    }

    bool identifier() {
        if (!take(' ')) return fail("expected a space and the frame, like 123#DEADBEEF");
        while (here() == ' ') ++position_;
        std::uint32_t id = 0;
        int digits = 0;
        for (; hex_digit(here()) >= 0; ++position_, ++digits) {
            if (digits == 8) return fail("expected an identifier of three or eight hexadecimal digits");
            id = id << 4U | static_cast<std::uint32_t>(hex_digit(here()));
        }
        if (digits != 3 && digits != 8) return fail("expected an identifier of three or eight hexadecimal digits");
        if (id > 0x3FFFFFFFU) return fail("expected an identifier below 40000000");
        line_.extended = digits == 8;
        line_.error = line_.extended && (id & 0x20000000U) != 0;
        if (line_.error) line_.extended = false;
        id &= 0x1FFFFFFFU;
        if (digits == 3 && id > 0x7FF) return fail("expected an 11-bit identifier, 000 to 7FF");
        line_.frame.id = id;
        return true;
    }

    bool content() {
        if (!take('#')) return fail("expected # after the identifier");
        if (here() == '#') {
            fail("CAN FD frames are not used here");
            failure_.fd = true;
            return false;
        }
        if (take('R')) {
            line_.remote = true;
            if (is_digit(here()) && here() <= '8') {
                line_.frame.length = static_cast<std::uint8_t>(here() - '0');
                ++position_;
            }
            return true;
        }
        while (hex_digit(here()) >= 0) {
            if (line_.frame.length == 8) return fail("expected at most eight bytes");
            const int high = hex_digit(here());
            ++position_;
            const int low = hex_digit(here());
            if (low < 0) return fail("expected two hexadecimal digits for each byte");
            line_.frame.data[line_.frame.length++] = static_cast<std::uint8_t>(high * 16 + low);
            ++position_;
        }
        return true;
    }

    bool trailer() {
        if (position_ == text_.size()) return true;
        const std::string_view rest = text_.substr(position_);
        if (rest == " R" || rest == " T") return true;
        return fail("expected the end of the line");
    }

    std::string_view text_;
    std::size_t position_ = 0;
    CandumpLine line_;
    CandumpFailure failure_;
};

constexpr std::uint8_t kNoHex = 0x80;

constexpr std::array<std::uint8_t, 256> hex_values() {
    std::array<std::uint8_t, 256> values{};
    values.fill(kNoHex);
    for (std::uint8_t i = 0; i < 10; ++i) values[std::size_t{'0'} + i] = i;
    for (std::uint8_t i = 0; i < 6; ++i) {
        values[std::size_t{'A'} + i] = static_cast<std::uint8_t>(10 + i);
        values[std::size_t{'a'} + i] = static_cast<std::uint8_t>(10 + i);
    }
    return values;
}
constexpr std::array<std::uint8_t, 256> kHex = hex_values();

/// The number in eight characters, the first in the lowest byte; none: one is no digit. Four steps instead of eight (Lemire, "Quickly parsing eight
/// digits", 2018).
std::optional<std::uint32_t> eight_digits(std::uint64_t text) {
    constexpr std::uint64_t kHigh = 0xF0F0F0F0F0F0F0F0, kZeros = 0x3030303030303030, kSixes = 0x0606060606060606;
    if ((text & kHigh) != kZeros || ((text + kSixes) & kHigh) != kZeros) return std::nullopt;
    const std::uint64_t digits = text - kZeros;
    const std::uint64_t pairs = digits * 10U + (digits >> 8U);  // in every other byte
    constexpr std::uint64_t kPair = 0x000000FF000000FF;
    return static_cast<std::uint32_t>(((pairs & kPair) * 0x000F424000000064 + (pairs >> 16U & kPair) * 0x0000271000000001) >> 32U);
}

/// Reads the form of nearly every line, `(ssssssssss.uuuuuu) interface 1A0#0011`, several times faster than LineParser, which judges everything
/// else. False: not this form.
bool read_fixed_form(std::string_view text, CandumpLine& line) {
    constexpr std::size_t kTime = 20;  // (1436509053.650713) and a space
    constexpr std::size_t kMin = kTime + 6;
    if (text.size() < kMin || text[0] != '(' || text[11] != '.' || text[18] != ')' || text[19] != ' ') return false;
    const auto eight = [&](std::size_t at) {
        std::uint64_t word = 0;
        std::memcpy(&word, text.data() + at, sizeof word);
        return word;
    };
    constexpr std::uint64_t kTwo = 0xFFFF;
    const auto front = eight_digits(eight(1));
    const auto back = eight_digits((eight(9) & kTwo) | (eight(10) & ~kTwo));  // without the point
    const std::size_t space = text.find(' ', kTime);
    if (!front || !back || space == std::string_view::npos || space == kTime) return false;
    const std::int64_t us = std::int64_t{*front} * 100'000'000 + *back;
    if (us >= (kMaxSeconds + 1) * 1'000'000) return false;
    const std::size_t data = space + 5;
    if (data > text.size() || text[data - 1] != '#') return false;
    const std::size_t digits = text.size() - data;
    if (digits > 16 || digits % 2 != 0) return false;
    unsigned any_hex = 0;
    const auto hex = [&](std::size_t at) {
        const unsigned value = kHex[static_cast<std::uint8_t>(text[at])];
        any_hex |= value;
        return value;
    };
    const std::uint32_t id = hex(space + 1) << 8U | hex(space + 2) << 4U | hex(space + 3);
    std::uint64_t bytes = 0;  // at once: a frame whose bytes were stored one by one is slow to copy
    for (std::size_t i = 0; i < digits; i += 2) bytes |= std::uint64_t{hex(data + i) << 4U | hex(data + i + 1)} << (4U * i);
    if ((any_hex & kNoHex) != 0 || id > 0x7FF) return false;
    const Time time{us * 1000};
    line.time = time;
    line.interface = text.substr(kTime, space - kTime);
    line.frame = {
        .id = id, .length = static_cast<std::uint8_t>(digits / 2), .data = std::bit_cast<std::array<std::uint8_t, 8>>(bytes), .received = time};
    return true;
}

using Pair = std::array<char, 2>;

/// Every pair of digits to this base.
template <std::size_t Base>
constexpr std::array<Pair, Base * Base> digit_pairs() {
    std::array<Pair, Base * Base> pairs{};
    for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = {"0123456789ABCDEF"[i / Base], "0123456789ABCDEF"[i % Base]};
    return pairs;
}
constexpr auto kDecimalPairs = digit_pairs<10>();
constexpr auto kHexPairs = digit_pairs<16>();

/// What a line has before or after the interface's name.
class LinePart {
  public:
    void add(char c) { text_[size_++] = c; }
    /// The last digits of `value`.
    template <std::size_t Pairs>
    void decimal(std::uint32_t value) {
        const std::size_t at = size_;
        for (std::size_t i = Pairs; i-- > 0; value /= 100) put(kDecimalPairs[value % 100], at + 2 * i);
        size_ = at + 2 * Pairs;
    }
    void hex(std::span<const std::uint8_t> bytes) {
        const std::size_t at = size_;
        for (std::size_t i = 0; i < bytes.size(); ++i) put(kHexPairs[bytes[i]], at + 2 * i);
        size_ = at + 2 * bytes.size();
    }
    [[nodiscard]] std::string_view text() const { return {text_.data(), size_}; }

  private:
    void put(const Pair& pair, std::size_t at) { std::copy(pair.begin(), pair.end(), text_.begin() + at); }
    std::array<char, 32> text_{};
    std::size_t size_ = 0;
};

}  // namespace

std::variant<CandumpLine, CandumpFailure> parse_candump(std::string_view line) {
    std::variant<CandumpLine, CandumpFailure> result;
    std::string_view text = line;
    if (!text.empty() && text.back() == '\n') text.remove_suffix(1);
    if (!read_fixed_form(text, std::get<CandumpLine>(result))) result = LineParser(line).run();
    return result;
}

std::size_t format_candump(const CandumpLine& line, std::span<char> out) {
    const std::int64_t seconds = line.time.count() / kNanoseconds;
    if (line.time < Time{} || seconds > kMaxSeconds) return 0;
    constexpr std::int64_t kPairsBelow = 100'000'000;
    LinePart before, after;
    before.add('(');
    before.decimal<1>(static_cast<std::uint32_t>(seconds / kPairsBelow));
    before.decimal<4>(static_cast<std::uint32_t>(seconds % kPairsBelow));
    before.add('.');
    before.decimal<3>(static_cast<std::uint32_t>(line.time.count() % kNanoseconds / 1000));
    before.add(')');
    before.add(' ');
    after.add(' ');
    if (line.extended || line.error) {
        const std::uint32_t id = line.frame.id | (line.error ? kErrorFlag : 0U);
        after.hex(std::bit_cast<std::array<std::uint8_t, 4>>(__builtin_bswap32(id)));
    } else {
        after.add(kHexPairs[line.frame.id >> 8U & 0xFU][1]);
        after.hex(std::array{static_cast<std::uint8_t>(line.frame.id & 0xFFU)});
    }
    after.add('#');
    if (line.remote) {
        after.add('R');
        if (line.frame.length > 0) after.add(static_cast<char>('0' + line.frame.length));
    } else {
        after.hex(line.frame.payload());
    }
    std::size_t size = 0;
    for (const std::string_view part : {before.text(), line.interface, after.text()}) {
        const std::size_t at = std::min(size, out.size());
        std::copy_n(part.data(), std::min(part.size(), out.size() - at), out.data() + at);
        size += part.size();
    }
    return size <= out.size() ? size : 0;
}

std::size_t format_candump(Time time, std::string_view interface, const Frame& frame, std::span<char> out) {
    return format_candump({.time = time, .interface = interface, .frame = frame}, out);
}

}  // namespace antiskid::can
