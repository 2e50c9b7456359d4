#include "firmware/can/candump.hpp"

#include <algorithm>

namespace antiskid::can {

namespace {

constexpr std::int64_t kNanoseconds = 1'000'000'000;
constexpr std::int64_t kMostSeconds = 9'000'000'000;  // int64 nanoseconds hold 9.2e9 s

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
            if (seconds > kMostSeconds) return fail("expected a time below 9e9 s");
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
        if (digits != 3 && digits != 8)
            return fail("expected an identifier of three or eight hexadecimal digits");
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
        if (here() == '#') return fail("CAN FD frames are not used here");
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
        return rest == " R" || rest == " T" || fail("expected the end of the line");
    }

    std::string_view text_;
    std::size_t position_ = 0;
    CandumpLine line_;
    CandumpFailure failure_;
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
    void decimal(std::int64_t value, int least_digits) {
        std::array<char, 20> digits{};
        int count = 0;
        for (; value > 0 || count < least_digits; value /= 10)
            digits[static_cast<std::size_t>(count++)] = static_cast<char>('0' + value % 10);
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
    return LineParser(line).run();
}

std::size_t format_candump(Time time, std::string_view interface, const Frame& frame, std::span<char> out) {
    LineWriter writer(out);
    writer.add('(');
    writer.decimal(time.count() / kNanoseconds, 10);
    writer.add('.');
    writer.decimal(time.count() % kNanoseconds / 1000, 6);
    writer.add(") ");
    writer.add(interface);
    writer.add(' ');
    writer.hex(frame.id, 3);
    writer.add('#');
    for (const std::uint8_t byte : frame.payload()) writer.hex(byte, 2);
    return writer.size();
}

}  // namespace antiskid::can
