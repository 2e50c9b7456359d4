// MATLAB files whose lengths lie, made from files that Octave and MATLAB's documentation give: refused before the library reserves them.
#include "rig_bridge/replay/mat_structure.hpp"

#include <zlib.h>

#include <array>
#include <cstring>

#include "rig_bridge/replay/recording.hpp"
#include "tests/can/layouts.hpp"
#include "tests/catch.hpp"

namespace {

const std::filesystem::path kSeeds = "tests/fuzz/corpus/mat";
constexpr std::array kGood{"cell", "complex", "compressed", "compressed_struct", "double", "int16", "matrix", "sparse", "struct", "version4"};

std::string with_word(std::string file, std::size_t at, std::uint32_t word) {
    std::memcpy(file.data() + at, &word, sizeof word);
    return file;
}

std::uint32_t word_of(const std::string& file, std::size_t at) {
    std::uint32_t word = 0;
    std::memcpy(&word, file.data() + at, sizeof word);
    return word;
}

void check(const std::string& file) {
    rig::replay::check_mat_structure("r.mat", {reinterpret_cast<const unsigned char*>(file.data()), file.size()});
}

std::string rejection(const std::string& file) {
    try {
        check(file);
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "accepted";
}

std::string seed(const char* name) {
    return can_test::contents(kSeeds / name);
}

/// The file with its only variable, from byte 128, compressed.
std::string compressed(const std::string& file) {
    const std::string variable = file.substr(128);
    std::string packed(compressBound(variable.size()), '\0');
    uLongf size = packed.size();
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(variable.data()), variable.size());
    packed.resize(size);
    const std::string tag = with_word(std::string(8, '\0'), 0, 15);
    return file.substr(0, 128) + with_word(tag, 4, static_cast<std::uint32_t>(size)) + packed;
}

/// A part that holds one number, in as many cells within cells.
std::string nested(int cells) {
    std::string inner = seed("double").substr(128);
    const std::string around = seed("cell").substr(128, 48);  // tag, flags, dimensions 1 x 3, a name
    for (int i = 0; i < cells; ++i) {
        inner = with_word(around, 32, 1) + inner;
        inner = with_word(with_word(inner, 36, 1), 4, static_cast<std::uint32_t>(inner.size() - 8));
    }
    return seed("cell").substr(0, 128) + inner;
}

std::vector<double> read(const std::filesystem::path& file, const std::string& wanted) {
    const auto recording = rig::replay::open_mat(file, {wanted});
    std::vector<double> values;
    for (rig::replay::RecordedRow row; recording->next(row);) values.push_back(row.values[0]);
    return values;
}

}  // namespace

TEST_CASE("what Octave writes is accepted and read", "[BRG-350]") {
    for (const char* const name : kGood) {
        INFO(name);
        CHECK_NOTHROW(check(seed(name)));
    }
    CHECK(read(kSeeds / "compressed", "p") == std::vector<double>{1, 2, 3});
    CHECK(read(kSeeds / "compressed_struct", "bench.p") == std::vector<double>{5, 6});
    CHECK(read(kSeeds / "complex", "p") == std::vector<double>{1, 2, 3});
    CHECK(read(kSeeds / "version4", "p") == std::vector<double>{1, 2});
    CHECK_NOTHROW(check(compressed(seed("struct"))));
    CHECK_NOTHROW(check(nested(31)));
}

TEST_CASE("a length, dimension or type that lies is refused with its byte", "[BRG-350]") {
    // A vector of three: tag at 128, flags 136, dimensions 152, name 168, values 184.
    const std::string vector = seed("double");
    const auto lies = [&](std::size_t at, std::uint32_t word, const std::string& words) {
        INFO("byte " << at << " becomes " << word);
        CHECK_THAT(rejection(with_word(vector, at, word)), ContainsSubstring("r.mat: byte 128"));
        CHECK_THAT(rejection(with_word(vector, at, word)), ContainsSubstring(words));
        CHECK_THAT(rejection(compressed(with_word(vector, at, word))), ContainsSubstring("r.mat: byte 128"));
    };
    lies(132, 0x20000000, "a variable of 536870912 bytes; only 80 follow");
    lies(132, 72, "only 16 are left of what it is part of");
    lies(128, 13, "an element of type 13; expected a variable");
    lies(140, 16, "its byte 8: expected 8 bytes of array flags");
    lies(144, 0x0806, "a tag of 8 bytes; only 0 are left");  // complex, without a second part
    lies(144, 18, "there is no array class 18");
    lies(156, 0x20000000, "its byte 24: expected 2 to 32 dimensions");
    lies(156, 4, "expected 2 to 32 dimensions");
    lies(160, 0x04000000, "24 bytes of values; its dimensions say 67108864 of 8");
    lies(160, 0x80000000, "a dimension below zero");
    lies(164, 0x20000000, "its dimensions say 1610612736 of 8");
    lies(168, 0x00050001, "5 bytes in a tag that has room for 4");
    lies(168, 2, "expected a name");
    lies(184, 8, "values of a type 8 that there is not");
    lies(184, 100, "values of a type 100 that there is not");
    lies(188, 0x20000000, "536870912 bytes of values");
    CHECK_THAT(rejection(vector.substr(0, vector.size() - 1)), ContainsSubstring("only 79 follow"));
    CHECK_THAT(rejection(vector + "1234"), ContainsSubstring("byte 216: the file ends within a tag"));
    CHECK_THAT(rejection(nested(32)), ContainsSubstring("variables within variables, 33 deep"));
}

TEST_CASE("so is one within a struct, a cell, a sparse matrix or what is compressed", "[BRG-350]") {
    const auto lies = [](const char* name, std::size_t at, std::uint32_t word, const std::string& words) {
        INFO(name << ": byte " << at << " becomes " << word);
        CHECK_THAT(rejection(with_word(seed(name), at, word)), ContainsSubstring(words));
    };
    lies("struct", 160, 0x04000000, "67108864 parts in 72 bytes");
    lies("struct", 188, 0, "expected the length of the field names");
    lies("struct", 188, 0x40000000, "expected field names of 1073741824 bytes each");
    lies("struct", 208, 15, "expected a variable as part of this one");
    lies("struct", 212, 0x20000000, "a part of 536870912 bytes; only 64 are left");
    lies("struct", 212, 60, "a part of 60 bytes, which are no whole words of 8");
    lies("struct", 212, 56, "left");
    lies("struct", 240, 0x04000000, "its dimensions say 67108864 of 8");
    // An object, whose insides nobody knows, begins with names: an empty one where it is a part.
    lies("struct", 224, 17, "expected the empty name of an object");
    lies("double", 144, 17, "expected a name");
    lies("cell", 164, 0x04000000, "67108864 parts in 248 bytes");
    lies("cell", 164, 2, "128 bytes are left over after the variable");
    lies("sparse", 180, 0x20000000, "an element of 536870912 bytes; only");
    lies("sparse", 164, 3, "expected 4 starts of columns of a sparse matrix");
    lies("sparse", 196, 16, "expected 3 starts of columns of a sparse matrix");
    const std::string packed = seed("compressed");
    CHECK_THAT(rejection(with_word(packed, 132, word_of(packed, 132) - 8).substr(0, packed.size() - 8)),
               ContainsSubstring("r.mat: byte 128, inflated byte"));
    CHECK_THAT(rejection(with_word(packed, 140, 0)), ContainsSubstring("the file ends there, or cannot be inflated"));
    // Version 4: type, rows, columns, complex, length of the name.
    lies("version4", 4, 0x20000000, "r.mat: cannot be read as a MATLAB file");
    lies("version4", 12, 1, "cannot be read");
    lies("version4", 16, 0x7FFFFFFF, "cannot be read");
    const std::string four = seed("version4");
    CHECK_THAT(rejection(four + with_word(four, 4, 0x20000000)),
               ContainsSubstring("r.mat: byte 38: a variable of 536870912 x 1 values; only 18 bytes follow"));
    CHECK_THAT(rejection(four + with_word(four, 0, 2)), ContainsSubstring("byte 38: a variable of type 2"));
    CHECK_THAT(rejection(four + "123"), ContainsSubstring("byte 38: the file ends within the head"));
    // Found by the fuzzer: lengths in one order of bytes, a type that says the other.
    using std::string_literals::operator""s;
    CHECK_THAT(rejection("\0\0\0\1\0\0\0\0\0\x1e\0\2\0\0\0\0\0\0\0\5\0\0\0\0\0"s), ContainsSubstring("cannot be read as a MATLAB file"));
    CHECK_NOTHROW(check("\0\0\3\xe8\0\0\0\1\0\0\0\1\0\0\0\0\0\0\0\2p\0\0\0\0\0\0\0\0\0"s));
    // An object within a struct, whose name matio reads as dimensions: 8 GB of them.
    const std::string object = with_word(seed("struct"), 224, 17);
    CHECK_THAT(rejection(with_word(object, 236, 0xFFFD0008)),
               ContainsSubstring("r.mat: byte 128, its byte 104: expected the empty name of an object"));
    // One with a name of 8 letters, not compressed, whose letters matio reads as the length of the name: 2.8 GB.
    const std::string opaque = with_word(with_word(with_word(seed("double"), 144, 17), 152, 1), 160, 1);
    CHECK_THAT(rejection(with_word(opaque, 164, 0xA6000003)), ContainsSubstring("an object with a name of more than 4 letters, not compressed"));
    CHECK_THAT(rejection(""), ContainsSubstring("cannot be read as a MATLAB file"));
}

TEST_CASE("whatever one word of a file claims, it is refused by name or holds no more than it did", "[BRG-350]") {
    const can_test::TempDir dir;
    for (const char* const name : kGood) {
        const std::string good = seed(name);
        for (std::size_t at = good.size() > 128 ? 124 : 0; at + 4 <= good.size(); at += 4) {
            for (const std::uint32_t word : {0U, 0xFFFFFFFFU, 0x10000000U, word_of(good, at) ^ 0x0200U}) {
                INFO(name << ": word at " << at << " becomes " << word);
                const auto file = dir.write("r.mat", with_word(good, at, word));
                try {
                    const std::size_t values = read(file, "p").size();
                    CHECK(values <= good.size());
                } catch (const std::runtime_error& error) {
                    CHECK_THAT(error.what(), ContainsSubstring("r.mat"));
                }
            }
        }
    }
}
