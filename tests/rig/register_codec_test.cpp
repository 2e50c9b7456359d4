// Between SI values and registers. Vectors by hand or by Python's struct: struct.pack('>f', x).hex().
#include "rig_bridge/rig/register_codec.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "rig_bridge/rig/register_blocks.hpp"
#include "tests/catch.hpp"

using rig::decode;
using rig::encode;
using rig::Field;
using rig::RegisterType;
using rig::ValueQuality;
using rig::WordOrder;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Field field(RegisterType type, double min, double max, double scale = 1.0, double offset = 0.0) {
    return {"x", 0, type, scale, offset, min, max, ""};
}

struct Vector {
    Field field;
    double value;
    std::vector<std::uint16_t> abcd;
};

std::vector<Vector> vectors() {
    const Field torque = field(RegisterType::float32, -1e6, 1e6);
    const Field big = field(RegisterType::u32, 0, 4294967295.0);
    return {
        {field(RegisterType::u16, 0, 65535), 0.0, {0x0000}},
        {field(RegisterType::u16, 0, 65535), 65535.0, {0xFFFF}},
        {field(RegisterType::u16, 0, 35e6, 1e4), 21e6, {0x0834}},           // 2100
        {field(RegisterType::u16, -40, 215, 0.5, -40.0), 20.5, {0x0079}},   // (20.5 + 40) / 0.5 = 121
        {field(RegisterType::u16, -100, 0, -0.01, 0.0), -12.34, {0x04D2}},  // 1234: counts downwards
        {field(RegisterType::i16, -40, 1500, 0.1), -12.3, {0xFF85}},        // -123
        {field(RegisterType::i16, -32768, 32767), -32768.0, {0x8000}},
        {field(RegisterType::i16, -32768, 32767), -1.0, {0xFFFF}},
        {big, 305419896.0, {0x1234, 0x5678}},
        {big, 4294967295.0, {0xFFFF, 0xFFFF}},
        {big, 65536.0, {0x0001, 0x0000}},
        {field(RegisterType::u32, 0, 4e6, 0.001), 1234.567, {0x0012, 0xD687}},  // 1234567
        {torque, 1.0, {0x3F80, 0x0000}},
        {torque, -2.0, {0xC000, 0x0000}},
        {torque, 1019.7, {0x447E, 0xECCD}},
        {torque, -23541.25, {0xC6B7, 0xEA80}},
        {torque, 0.1, {0x3DCC, 0xCCCD}},
        {field(RegisterType::float32, 0, 400e5, 1e5), 210e5, {0x4352, 0x0000}},  // bar: 210.0
    };
}

std::vector<std::uint16_t> swapped(std::vector<std::uint16_t> words) {
    return {words.rbegin(), words.rend()};
}

}  // namespace

TEST_CASE("Every type and word order is coded as written down", "[BRG-001]") {
    for (const auto& [f, value, abcd] : vectors()) {
        CAPTURE(value, static_cast<int>(f.type));
        std::vector<std::uint16_t> words(abcd.size());
        REQUIRE(encode(f, WordOrder::big, value, words));
        CHECK(words == abcd);
        REQUIRE(encode(f, WordOrder::little, value, words));
        CHECK(words == swapped(abcd));

        const double tolerance = f.type == RegisterType::float32 ? 1e-7 * std::abs(value) : 1e-9 * std::abs(value);
        CHECK(decode(f, WordOrder::big, abcd).value == Approx(value).margin(tolerance).epsilon(0.0));
        CHECK(decode(f, WordOrder::little, swapped(abcd)).value == Approx(value).margin(tolerance).epsilon(0.0));
        CHECK(decode(f, WordOrder::big, abcd).quality == ValueQuality::good);
    }
}

TEST_CASE("Integers are rounded to the nearest, halves away from zero", "[BRG-001]") {
    std::vector<std::uint16_t> word(1);
    const Field f = field(RegisterType::i16, -100, 100);
    const auto coded = [&](double value) {
        REQUIRE(encode(f, WordOrder::big, value, word));
        return static_cast<std::int16_t>(word[0]);
    };
    CHECK(coded(2.4999) == 2);
    CHECK(coded(2.5) == 3);
    CHECK(coded(-2.5) == -3);
    CHECK(coded(3.5) == 4);
    CHECK(coded(-0.4) == 0);
}

TEST_CASE("Writing saturates at the declared range and refuses NaN", "[BRG-001]") {
    std::vector<std::uint16_t> word(1);
    const Field f = field(RegisterType::i16, -40, 1500, 0.1);
    REQUIRE(encode(f, WordOrder::big, 1e9, word));
    CHECK(word[0] == 15000);
    REQUIRE(encode(f, WordOrder::big, -kInfinity, word));
    CHECK(static_cast<std::int16_t>(word[0]) == -400);
    word[0] = 77;
    CHECK(!encode(f, WordOrder::big, kNaN, word));
    CHECK(word[0] == 77);

    std::vector<std::uint16_t> pair{1, 2};
    const Field force = field(RegisterType::float32, -5e3, 100e3);
    CHECK(!encode(force, WordOrder::big, kNaN, pair));
    CHECK(pair == std::vector<std::uint16_t>{1, 2});
    REQUIRE(encode(force, WordOrder::big, kInfinity, pair));
    CHECK(decode(force, WordOrder::big, pair).value == 100e3);
    // What saturation writes is believed on reading, also where the range's end is no float.
    const Field odd = field(RegisterType::float32, 0.0, 0.1);
    REQUIRE(encode(odd, WordOrder::big, 1.0, pair));
    CHECK(decode(odd, WordOrder::big, pair).quality == ValueQuality::good);
}

TEST_CASE("Reading reports what cannot be", "[BRG-001]") {
    const Field force = field(RegisterType::float32, -5e3, 100e3);
    const auto quality = [&](std::uint16_t high, std::uint16_t low) {
        return decode(force, WordOrder::big, std::vector<std::uint16_t>{high, low}).quality;
    };
    CHECK(quality(0x7FC0, 0x0000) == ValueQuality::not_a_number);
    CHECK(quality(0xFFFF, 0xFFFF) == ValueQuality::not_a_number);
    CHECK(quality(0x7F80, 0x0001) == ValueQuality::not_a_number);  // signalling
    CHECK(quality(0x7F80, 0x0000) == ValueQuality::implausible);   // infinity
    CHECK(quality(0xFF80, 0x0000) == ValueQuality::implausible);
    CHECK(quality(0x47C3, 0x5000) == ValueQuality::good);         // 100,000
    CHECK(quality(0x47C3, 0x5100) == ValueQuality::implausible);  // 100,002
    CHECK(quality(0xC59C, 0x4000) == ValueQuality::good);         // -5000
    CHECK(quality(0xC59C, 0x6000) == ValueQuality::implausible);  // -5004

    const Field state = field(RegisterType::u16, 0, 1);
    CHECK(decode(state, WordOrder::big, std::vector<std::uint16_t>{1}).quality == ValueQuality::good);
    const auto two = decode(state, WordOrder::big, std::vector<std::uint16_t>{2});
    CHECK(two.quality == ValueQuality::implausible);
    CHECK(two.value == 2.0);
}

TEST_CASE("Any value comes back within half a step", "[BRG-001]") {
    std::mt19937_64 random(20261121);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    constexpr std::array kTypes{RegisterType::u16, RegisterType::i16, RegisterType::u32, RegisterType::float32};
    for (int i = 0; i < 100'000; ++i) {
        const auto type = kTypes[static_cast<std::size_t>(i) % 4];
        const double scale = std::pow(10.0, -4.0 + 8.0 * share(random)) * (share(random) < 0.2 ? -1.0 : 1.0);
        const double offset = type == RegisterType::float32 ? 0.0 : 1000.0 * (share(random) - 0.5);
        const double min = type == RegisterType::i16 ? -30000.0 : type == RegisterType::float32 ? -1e6 : 0.0;
        const double greatest = type == RegisterType::u32 ? 4e9 : type == RegisterType::float32 ? 1e6 : 30000.0;
        const double ends[] = {min * scale + offset, greatest * scale + offset};
        const Field f = field(type, std::min(ends[0], ends[1]), std::max(ends[0], ends[1]), scale, offset);
        const double value = f.min + (f.max - f.min) * share(random);
        const auto order = share(random) < 0.5 ? WordOrder::big : WordOrder::little;
        std::vector<std::uint16_t> words(rig::width(type));
        REQUIRE(encode(f, order, value, words));
        const auto reading = decode(f, order, words);
        REQUIRE(reading.quality == ValueQuality::good);
        const double step = type == RegisterType::float32 ? 0x1p-23 * std::abs(value) : std::abs(scale);
        REQUIRE(std::abs(reading.value - value) <= 0.5 * step * (1.0 + 1e-6) + 1e-9 * std::abs(offset));
        std::vector<std::uint16_t> again(words.size());
        REQUIRE(encode(f, order, reading.value, again));
        REQUIRE(again == words);
    }
}

TEST_CASE("Interlock bits stand where the map says", "[BRG-001]") {
    rig::RegisterMap map = rig::load_register_map("config/registers.toml");
    map.interlock_bit = {7, 15, 0, 3};  // emergency stop, guard, hydraulics, drive
    CHECK(rig::interlocks_from_register(map, 0x0080) == 0b0001);
    CHECK(rig::interlocks_from_register(map, 0x8001) == 0b0110);
    CHECK(rig::interlocks_from_register(map, 0x7F76) == 0);  // only bits that mean nothing
    CHECK(rig::interlocks_to_register(map, 0b1111) == 0x8089);
    for (unsigned bits = 0; bits < 16; ++bits) CHECK(rig::interlocks_from_register(map, rig::interlocks_to_register(map, bits)) == bits);

    rig::RegisterImage inputs(map.measured, map.word_order);
    rig::MeasuredValues values{};
    rig::at(values, rig::Measured::interlocks) = 0b1011;
    rig::write(map, inputs, values);
    CHECK(inputs.words(5, 1)[0] == 0x8088);
    CHECK(rig::read(map, inputs, rig::Measured::interlocks).value == 0b1011);
}

TEST_CASE("Blocks cover all registers, none beside them, in the fewest requests", "[BRG-001]") {
    const auto at = [](std::uint16_t address, RegisterType type) { return Field{"x", address, type, 1.0, 0.0, 0.0, 1.0, ""}; };
    using Blocks = std::vector<rig::Block>;
    const auto u16 = RegisterType::u16;
    const auto f32 = RegisterType::float32;
    CHECK(rig::blocks_of(std::vector<Field>{}, 125).empty());
    CHECK(rig::blocks_of(std::vector{at(5, u16), at(3, f32), at(2, u16)}, 125) == Blocks{{2, 4}});
    CHECK(rig::blocks_of(std::vector{at(2, u16), at(4, f32)}, 125) == Blocks{{2, 1}, {4, 2}});
    CHECK(rig::blocks_of(std::vector{at(65534, f32)}, 125) == Blocks{{65534, 2}});

    std::vector<Field> many;
    for (std::uint16_t i = 0; i < 100; ++i) many.push_back(at(static_cast<std::uint16_t>(2 * i), f32));
    CHECK(rig::blocks_of(many, rig::kMaxRead) == Blocks{{0, 124}, {124, 76}});  // 125 would split a field
    CHECK(rig::blocks_of(many, rig::kMaxWrite) == Blocks{{0, 122}, {122, 78}});

    const auto map = rig::load_register_map("config/registers.toml");
    CHECK(rig::blocks_of(map.measured, rig::kMaxRead) == Blocks{{0, 20}});
    CHECK(rig::blocks_of(map.commanded, rig::kMaxWrite) == Blocks{{0, 12}});
}
