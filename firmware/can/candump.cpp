#include "firmware/can/candump.hpp"

#include <array>

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

/// The form of nearly every line, `(ssssssssss.uuuuuu) interface 1A0#0011`, several times faster than LineParser, which
/// judges everything else. False: not this form; `line` is then not to be used.
class FixedForm {
  public:
    explicit FixedForm(std::string_view text) : text_(text) {}

    bool read(CandumpLine& line) {
        constexpr std::size_t kTime = 20;  // (1436509053.650713) and a space
        constexpr std::size_t kMin = kTime + 6;
        if (text_.size() < kMin || text_[0] != '(' || text_[11] != '.' || text_[18] != ')' || text_[19] != ' ') return false;
        const std::int64_t seconds = decimal(1, 11);
        const std::int64_t microseconds = decimal(12, 18);
        const std::size_t space = text_.find(' ', kTime);
        if (not_decimal_ || seconds > kMaxSeconds || space == std::string_view::npos || space == kTime) return false;
        const std::size_t data = space + 5;
        if (data > text_.size() || text_[data - 1] != '#') return false;
        const unsigned digits = static_cast<unsigned>(text_.size() - data);
        if (digits > 16 || digits % 2 != 0) return false;
        line.frame.id = hex(space + 1) << 8U | hex(space + 2) << 4U | hex(space + 3);
        line.frame.length = static_cast<std::uint8_t>(digits / 2);
        for (std::size_t i = 0; i < line.frame.length; ++i)
            line.frame.data[i] = static_cast<std::uint8_t>(hex(data + 2 * i) << 4U | hex(data + 2 * i + 1));
        if ((any_hex_ & kNoHex) != 0 || line.frame.id > 0x7FF) return false;
        line.interface = text_.substr(kTime, space - kTime);
        line.time = Time{seconds * kNanoseconds + microseconds * 1000};
        line.frame.received = line.time;
        return true;
    }

  private:
    std::int64_t decimal(std::size_t from, std::size_t to) {
        std::int64_t value = 0;
        for (std::size_t i = from; i < to; ++i) {
            const auto digit = static_cast<unsigned>(text_[i]) - unsigned{'0'};
            not_decimal_ |= digit > 9;
            value = value * 10 + digit;
        }
        return value;
    }
    std::uint32_t hex(std::size_t at) {
        const std::uint8_t value = kHex[static_cast<std::uint8_t>(text_[at])];
        any_hex_ |= value;
        return value;
    }

    std::string_view text_;
    bool not_decimal_ = false;
    std::uint8_t any_hex_ = 0;
};

class LineWriter {
  public:
    explicit LineWriter(std::span<char> out) : out_(out) {}
    void add(char c) {
        if (size_ < out_.size()) out_[size_] = c;
        ++size_;
    }
    void add(std::string_view text) {
        for (const char c : text) add(c);
    }
    /// `value` >= 0.
    void decimal(std::int64_t value, int min_digits) {
        std::array<char, 20> digits{};
        int count = 0;
        for (; value > 0 || count < min_digits; value /= 10) digits[static_cast<std::size_t>(count++)] = static_cast<char>('0' + value % 10);
        while (count > 0) add(digits[static_cast<std::size_t>(--count)]);
    }
    void hex(std::uint32_t value, unsigned digits) {
        for (unsigned i = digits; i-- > 0;) add("0123456789ABCDEF"[(value >> (4U * i)) & 0xFU]);
    }
    [[nodiscard]] std::size_t size() const { return size_ <= out_.size() ? size_ : 0; }

  private:
    std::span<char> out_;
    std::size_t size_ = 0;
};

}  // namespace

std::variant<CandumpLine, CandumpFailure> parse_candump(std::string_view line) {
    std::variant<CandumpLine, CandumpFailure> result;
    std::string_view text = line;
    if (!text.empty() && text.back() == '\n') text.remove_suffix(1);
    if (!FixedForm(text).read(std::get<CandumpLine>(result))) result = LineParser(line).run();
    return result;
}

std::size_t format_candump(const CandumpLine& line, std::span<char> out) {
    const std::int64_t seconds = line.time.count() / kNanoseconds;
    if (line.time < Time{} || seconds > kMaxSeconds) return 0;
    LineWriter writer(out);
    writer.add('(');
    writer.decimal(seconds, 10);
    writer.add('.');
    writer.decimal(line.time.count() % kNanoseconds / 1000, 6);
    writer.add(") ");
    writer.add(line.interface);
    writer.add(' ');
    if (line.extended || line.error) {
        writer.hex(line.frame.id | (line.error ? kErrorFlag : 0U), 8);
    } else {
        writer.hex(line.frame.id, 3);
    }
    writer.add('#');
    if (line.remote) {
        writer.add('R');
        if (line.frame.length > 0) writer.decimal(line.frame.length, 1);
        return writer.size();
    }
    for (const std::uint8_t byte : line.frame.payload()) writer.hex(byte, 2);
    return writer.size();
}

std::size_t format_candump(Time time, std::string_view interface, const Frame& frame, std::span<char> out) {
    return format_candump({.time = time, .interface = interface, .frame = frame}, out);
}

}  // namespace antiskid::can
