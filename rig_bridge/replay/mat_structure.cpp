#include "rig_bridge/replay/mat_structure.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>

// MathWorks, "MAT-File Format", chapter 1 (level 5) and 2 (level 4).

namespace rig::replay {

namespace {

/// Reads the bytes of a MATLAB element in order, plain or inflated.
class MatBytes {
  public:
    virtual ~MatBytes() = default;
    /// False: fewer bytes are left, and `out` is invalid.
    [[nodiscard]] virtual bool take(std::span<unsigned char> out) = 0;
    [[nodiscard]] virtual bool skip(std::uint64_t count) = 0;
};

class PlainBytes final : public MatBytes {
  public:
    explicit PlainBytes(std::span<const unsigned char> bytes) : left_(bytes) {}
    [[nodiscard]] bool take(std::span<unsigned char> out) override {
        if (out.size() > left_.size()) return false;
        std::copy_n(left_.begin(), out.size(), out.begin());
        left_ = left_.subspan(out.size());
        return true;
    }
    [[nodiscard]] bool skip(std::uint64_t count) override {
        if (count > left_.size()) return false;
        left_ = left_.subspan(count);
        return true;
    }

  private:
    std::span<const unsigned char> left_;
};

/// Inflates only what is requested; skipped bytes are not kept, however many.
class InflatedBytes final : public MatBytes {
  public:
    explicit InflatedBytes(std::span<const unsigned char> compressed) {
        stream_.next_in = const_cast<unsigned char*>(compressed.data());  // zlib only reads there
        stream_.avail_in = static_cast<uInt>(compressed.size());
        ready_ = inflateInit(&stream_) == Z_OK;
        more_ = ready_;
    }
    InflatedBytes(const InflatedBytes&) = delete;
    InflatedBytes& operator=(const InflatedBytes&) = delete;
    ~InflatedBytes() override {
        if (ready_) inflateEnd(&stream_);
    }
    [[nodiscard]] bool take(std::span<unsigned char> out) override {
        stream_.next_out = out.data();
        stream_.avail_out = static_cast<uInt>(out.size());
        while (more_ && stream_.avail_out > 0) more_ = inflate(&stream_, Z_SYNC_FLUSH) == Z_OK;
        return stream_.avail_out == 0;
    }
    [[nodiscard]] bool skip(std::uint64_t count) override {
        std::array<unsigned char, 16384> unused{};
        while (count > 0) {
            const std::size_t part = std::min<std::uint64_t>(count, unused.size());
            if (!take(std::span(unused).first(part))) return false;
            count -= part;
        }
        return true;
    }

  private:
    z_stream stream_{};
    bool ready_ = false;
    bool more_ = false;
};

constexpr int kDeepest = 32;
constexpr std::uint32_t kMaxDimensions = 32;
constexpr std::size_t kHeader = 128;

enum Type : std::uint32_t { int8 = 1, int32 = 5, uint32 = 6, matrix = 14, compressed = 15, utf8 = 16 };
enum Class : std::uint32_t {
    cell = 1,
    structure = 2,
    object = 3,
    text = 4,
    sparse = 5,
    first_number = 6,
    last_number = 15,
    function = 16,
    opaque = 17
};

/// Size of one value in bytes; 0: the type has no values.
std::uint32_t value_size(std::uint32_t type) {
    constexpr std::array<std::uint32_t, 19> kSizes{0, 1, 1, 2, 2, 4, 4, 4, 0, 8, 0, 0, 8, 8, 0, 0, 1, 2, 4};
    return type < kSizes.size() ? kSizes[type] : 0;
}

std::uint64_t padded(std::uint64_t size) {
    return (size + 7) / 8 * 8;
}

/// Product, saturated.
std::uint64_t product(std::uint64_t a, std::uint64_t b) {
    std::uint64_t result = 0;
    return __builtin_mul_overflow(a, b, &result) ? UINT64_MAX : result;
}

std::uint32_t number(std::span<const unsigned char> four, bool big_endian) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8U | four[big_endian ? i : 3 - i];
    return value;
}

/// One variable of version 5 with all its contents.
class Variable {
  public:
    /// `place`: position of `bytes`, for messages.
    Variable(MatBytes& bytes, bool inflated, bool big_endian, std::string place)
        : bytes_(bytes), inflated_(inflated), big_endian_(big_endian), place_(std::move(place)) {}

    void check(std::uint64_t size) { check_matrix(size, 1); }

    [[nodiscard]] std::uint32_t next_number() {
        std::array<unsigned char, 4> four{};
        take(four);
        return number(four, big_endian_);
    }

    [[noreturn]] void fail(const std::string& what) const { throw std::runtime_error(fmt::format("{} {}: {}", place_, at_, what)); }

  private:
    struct Tag {
        std::uint32_t type = 0;
        std::uint32_t size = 0;
        std::uint32_t small = 0;  // its first four bytes, if the data are in the tag itself
        bool is_small = false;
    };

    void take(std::span<unsigned char> out) {
        if (!bytes_.take(out)) fail("the file ends there, or cannot be inflated");
        at_ += out.size();
    }

    void spend(std::uint64_t& left, std::uint64_t size, const char* what) const {
        if (size > left) fail(fmt::format("{} of {} bytes; only {} are left of what it is part of", what, size, left));
        left -= size;
    }

    Tag next_tag(std::uint64_t& left) {
        spend(left, 8, "a tag");
        const std::uint32_t first = next_number();
        const std::uint32_t second = next_number();
        if (first <= 0xFFFF) return {.type = first, .size = second};
        const Tag tag{.type = first & 0xFFFFU, .size = first >> 16U, .small = second, .is_small = true};
        if (tag.size > 4) fail(fmt::format("{} bytes in a tag that has room for 4", tag.size));
        return tag;
    }

    void skip_data(const Tag& tag, std::uint64_t& left) {
        if (tag.is_small) return;
        const std::uint64_t size = padded(tag.size);
        spend(left, size, "an element");
        if (!bytes_.skip(size)) fail(fmt::format("an element of {} bytes; the file ends before", size));
        at_ += size;
    }

    void check_matrix(std::uint64_t size, int depth) {
        if (depth > kDeepest) fail(fmt::format("variables within variables, {} deep; at most {}", depth, kDeepest));
        std::uint64_t left = size;
        const Tag flags = next_tag(left);
        if (flags.is_small || flags.type != Type::uint32 || flags.size != 8) fail("expected 8 bytes of array flags");
        spend(left, 8, "array flags");
        const std::uint32_t word = next_number();
        static_cast<void>(next_number());
        const std::uint32_t kind = word & 0xFFU;
        if (kind == Class::opaque) return check_object(left, depth);
        const std::uint64_t count = dimensions(left);
        check_name(left);
        const bool is_complex = (word & 0x0800U) != 0;
        switch (kind) {
            case Class::cell:
            case Class::function:
                check_parts(count, left, depth);
                break;
            case Class::object:
                check_name(left);
                [[fallthrough]];
            case Class::structure:
                check_parts(product(count, fields(left)), left, depth);
                break;
            case Class::sparse:
                check_sparse(left, is_complex);
                break;
            default:
                if (kind < Class::text || kind > Class::last_number) fail(fmt::format("there is no array class {}", kind));
                check_values(count, left);
                if (is_complex) check_values(count, left);
        }
        if (left != 0) fail(fmt::format("{} bytes are left over after the variable", left));
    }

    /// Checks a table, string or datetime, of which only the beginning has a known format. If it is a member of another variable, or is not
    /// compressed, matio mistakes the tag of its name for that of the dimensions, and the following element for the name.
    void check_object(std::uint64_t left, int depth) {
        if (depth > 1 || !inflated_) {
            const Tag name = next_tag(left);
            if (depth > 1 && (name.type != Type::int8 || name.size != 0))
                fail("expected the empty name of an object that is part of another variable");
            if (name.type != Type::int8) fail("expected a name");
            if (!name.is_small && name.size != 0) fail("an object with a name of more than 4 letters, not compressed; expected it saved with -v7");
        }
        check_name(left);
        if (!bytes_.skip(left)) fail(fmt::format("an object of {} bytes; the file ends before", left));
        at_ += left;
    }

    std::uint64_t dimensions(std::uint64_t& left) {
        const Tag tag = next_tag(left);
        const std::uint32_t rank = tag.size / 4;
        if (tag.is_small || tag.type != Type::int32 || tag.size % 4 != 0 || rank < 2 || rank > kMaxDimensions)
            fail(fmt::format("expected 2 to {} dimensions as 32-bit integers", kMaxDimensions));
        spend(left, padded(tag.size), "dimensions");
        std::uint64_t count = 1;
        for (std::uint32_t i = 0; i < rank; ++i) {
            last_dimension_ = next_number();
            if (last_dimension_ > INT32_MAX) fail("a dimension below zero");
            count = product(count, last_dimension_);
        }
        if (rank % 2 != 0) static_cast<void>(next_number());
        return count;
    }

    void check_name(std::uint64_t& left) {
        const Tag tag = next_tag(left);
        if (tag.type != Type::int8 && tag.type != Type::utf8) fail("expected a name");
        skip_data(tag, left);
    }

    std::uint64_t fields(std::uint64_t& left) {
        const Tag length = next_tag(left);
        if (!length.is_small || length.type != Type::int32 || length.size != 4 || length.small == 0 || length.small > INT32_MAX)
            fail("expected the length of the field names");
        const Tag names = next_tag(left);
        if (names.type != Type::int8 || names.size % length.small != 0) fail(fmt::format("expected field names of {} bytes each", length.small));
        skip_data(names, left);
        return names.size / length.small;
    }

    void check_parts(std::uint64_t count, std::uint64_t& left, int depth) {
        if (count > left / 8) fail(fmt::format("{} parts in {} bytes", count, left));
        for (; count > 0; --count) {
            const Tag tag = next_tag(left);
            if (tag.is_small || tag.type != Type::matrix) fail("expected a variable as part of this one");
            spend(left, padded(tag.size), "a part");
            if (tag.size % 8 != 0) fail(fmt::format("a part of {} bytes, which are no whole words of 8", tag.size));
            if (tag.size != 0) check_matrix(tag.size, depth + 1);
        }
    }

    void check_sparse(std::uint64_t& left, bool is_complex) {
        const std::uint64_t columns = last_dimension_;
        const Tag rows = next_tag(left);
        if (rows.type != Type::int32 || rows.size % 4 != 0) fail("expected the rows of a sparse matrix");
        skip_data(rows, left);
        const Tag starts = next_tag(left);
        if (starts.type != Type::int32 || starts.size != 4 * (columns + 1))
            fail(fmt::format("expected {} starts of columns of a sparse matrix", columns + 1));
        skip_data(starts, left);
        for (int i = 0; i < (is_complex ? 2 : 1); ++i) {
            const Tag tag = next_tag(left);
            if (value_size(tag.type) == 0) fail(fmt::format("values of a type {} that there is not", tag.type));
            skip_data(tag, left);
        }
    }

    void check_values(std::uint64_t count, std::uint64_t& left) {
        const Tag tag = next_tag(left);
        const std::uint64_t size = value_size(tag.type);
        if (size == 0) fail(fmt::format("values of a type {} that there is not", tag.type));
        // A character of UTF-8 has one to four bytes.
        const bool fits = tag.type == Type::utf8 ? tag.size >= count && tag.size <= product(count, 4) : tag.size == product(count, size);
        if (!fits) fail(fmt::format("{} bytes of values; its dimensions say {} of {}", tag.size, count, size));
        skip_data(tag, left);
    }

    MatBytes& bytes_;
    bool inflated_;
    bool big_endian_;
    std::string place_;
    std::uint64_t at_ = 0;
    std::uint32_t last_dimension_ = 0;
};

void check_version_5(const std::string& name, std::span<const unsigned char> file, bool big_endian) {
    for (std::size_t at = kHeader; at < file.size();) {
        const std::string byte = fmt::format("{}: byte {}", name, at);
        const auto rest = file.subspan(at);
        if (rest.size() < 8) throw std::runtime_error(byte + ": the file ends within a tag");
        const std::uint32_t type = number(rest, big_endian);
        const std::uint32_t size = number(rest.subspan(4), big_endian);
        if (size > rest.size() - 8) throw std::runtime_error(fmt::format("{}: a variable of {} bytes; only {} follow", byte, size, rest.size() - 8));
        const auto data = rest.subspan(8, size);
        if (type == Type::compressed) {
            InflatedBytes bytes(data);
            Variable variable(bytes, true, big_endian, byte + ", inflated byte");
            if (variable.next_number() != Type::matrix) variable.fail("expected a variable");
            variable.check(variable.next_number());
        } else if (type == Type::matrix) {
            PlainBytes bytes(data);
            Variable(bytes, false, big_endian, byte + ", its byte").check(size);
        } else {
            throw std::runtime_error(fmt::format("{}: an element of type {}; expected a variable", byte, type));
        }
        at += 8 + size;
    }
}

void check_version_4(const std::string& name, std::span<const unsigned char> file) {
    constexpr std::array<std::uint64_t, 6> kSizes{8, 4, 4, 2, 2, 1};
    constexpr std::size_t kHead = 20;
    constexpr std::uint32_t kMaxType = 4052;
    // The type also shows the byte order; matio follows the type.
    const bool big_endian = file.size() >= kHead && number(file, false) > kMaxType;
    for (std::size_t at = 0; at < file.size();) {
        const auto reject = [&](const std::string& what) {
            // A file that begins otherwise is not of version 4.
            if (at == 0) throw std::runtime_error(name + kNoMat);
            throw std::runtime_error(fmt::format("{}: byte {}: {}", name, at, what));
        };
        const auto rest = file.subspan(at);
        if (rest.size() < kHead) reject("the file ends within the head of a variable");
        std::array<std::uint32_t, 5> head{};  // type, rows, columns, complex, length of the name
        for (std::size_t i = 0; i < head.size(); ++i) head[i] = number(rest.subspan(4 * i), big_endian);
        const std::uint32_t precision = head[0] / 10 % 10;
        if (head[0] > kMaxType || head[0] / 1000 != (big_endian ? 1U : 0U) || head[0] / 100 % 10 != 0 || precision >= kSizes.size() ||
            head[0] % 10 > 1)
            reject(fmt::format("a variable of type {}; expected numbers or text", head[0]));
        if (head[1] > INT32_MAX || head[2] > INT32_MAX || head[3] > 1 || head[4] == 0) reject("dimensions or length of the name that cannot be");
        const std::uint64_t values = product(product(head[1], head[2]), kSizes[precision] * (1 + head[3]));
        const std::uint64_t size = rest.size() - kHead;
        if (head[4] > size || values > size - head[4])
            reject(fmt::format("a variable of {} x {} values; only {} bytes follow", head[1], head[2], size));
        at += kHead + head[4] + values;
    }
}

}  // namespace

void check_mat_structure(const std::string& name, std::span<const unsigned char> file) {
    if (file.size() >= kHeader && ((file[126] == 'I' && file[127] == 'M') || (file[126] == 'M' && file[127] == 'I'))) {
        const bool big_endian = file[126] == 'M';
        const unsigned version = unsigned{file[big_endian ? 124 : 125]} << 8U | file[big_endian ? 125 : 124];
        if (version == 0x0200) return;
        if (version == 0x0100) return check_version_5(name, file, big_endian);
    }
    if (file.empty()) throw std::runtime_error(name + kNoMat);
    check_version_4(name, file);
}

}  // namespace rig::replay
