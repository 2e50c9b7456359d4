// The same bytes in, the same bits out, on every machine and in every build; a controller is a plain value that never allocates.
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <random>
#include <type_traits>

#include "firmware/control/controller.hpp"
#include "tests/catch.hpp"
#include "tests/control/fixed_config.hpp"

using namespace antiskid::control;
using control_test::fixed_config;

namespace {

std::uint64_t& allocations() {
    static std::uint64_t count = 0;
    return count;
}

}  // namespace

// Not inlined: the compiler would see malloc behind one of them and free behind the other, and call it a mismatch.
[[gnu::noinline]] void* operator new(const std::size_t size) {
    ++allocations();
    if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
    throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(const std::size_t size, const std::nothrow_t&) noexcept {
    ++allocations();
    return std::malloc(size == 0 ? 1 : size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, const std::nothrow_t&) noexcept {
    std::free(memory);
}

namespace {

/// A landing written in integers, so that it is the same on every machine: the wheel turns at a speed that follows the commanded
/// current in a crude way, every law gets its turn, sensors fail now and then.
class RecordedLanding {
  public:
    explicit RecordedLanding(const std::uint32_t seed) : random_(seed) {}

    Sensors next(const Command& last) {
        ++k_;
        const Time now = time();
        const std::int64_t t = k_ % 12'000;  // ms
        if (t == 1) v_um_per_ms_ = 60'000;
        if (t > 1'500) v_um_per_ms_ -= v_um_per_ms_ > 6 ? 6 : v_um_per_ms_;
        const auto current_uA = static_cast<std::int64_t>(last.current_mA * 1000.0F);
        pressure_Pa_ += (current_uA * 400 - pressure_Pa_) / 16;
        const bool lock = t > 4'000 && t < 4'100;
        const std::int64_t slip_ppm = t < 520 ? 1'000'000 : lock ? 900'000 : pressure_Pa_ / 40;
        const std::int64_t rim = v_um_per_ms_ * (1'000'000 - (slip_ppm < 1'000'000 ? slip_ppm : 1'000'000)) / 1'000'000;
        roll(wheel_, rim, 33'929, s_.wheel, now);                 // 324 mm, 60 teeth: 33.929 mm an edge
        roll(flywheel_, v_um_per_ms_, 62'832, s_.flywheel, now);  // 600 mm
        s_.pressure.received = now;
        s_.pressure.pressure_Pa = static_cast<float>(pressure_Pa_ - pressure_Pa_ % 500);
        if (k_ % 20 == 1) {
            ManeuverInput& m = s_.maneuver;
            m.received = now;
            m.law = static_cast<Law>((k_ / 12'000) % kLawCount);
            m.arm = t > 260;
            m.weight_on_wheels = t > 500;
            m.demand_Pa = t > 1'500 ? 20'000'000.0F : 0.0F;
            m.slip_reference = t > 6'000 ? 0.125F : 0.25F;
            m.deceleration_mps2 = 3.25F;
            m.current_mA = 12.5F;
        }
        s_.rig_heartbeat_received = now;
        s_.missed_periods = random_() % 200U == 0U ? 1U : 0U;
        if (k_ > 60'000 && random_() % 4'000U == 0U) s_.wheel.edge_count += static_cast<std::uint32_t>(random_() % 1000U);
        return s_;
    }
    [[nodiscard]] Time time() const { return Time{k_ * 1'000'000}; }

  private:
    struct Roll {
        std::int64_t way_um = 0;
        std::int64_t edges = 0;
    };
    static void roll(Roll& roll, const std::int64_t um_per_ms, const std::int64_t um_per_edge, SpeedInput& input, const Time now) {
        roll.way_um += um_per_ms;
        const std::int64_t edges = roll.way_um / um_per_edge;
        input.received = now;
        if (edges == roll.edges) return;
        roll.edges = edges;
        input.edge_count = static_cast<std::uint32_t>(edges);
        input.edge_time = now - Time{(roll.way_um - edges * um_per_edge) * 1'000'000 / um_per_ms};
    }

    std::mt19937 random_;
    std::int64_t k_ = 0;
    std::int64_t v_um_per_ms_ = 0;
    std::int64_t pressure_Pa_ = 0;
    Roll wheel_, flywheel_;
    Sensors s_;
};

/// FNV-1a over the bits of every command.
class Hash {
  public:
    void add(const Command& c) {
        for (const float value : {c.current_mA, c.slip, c.slip_reference, c.speed_mps, c.wheel_speed_radps, c.pressure_request_Pa})
            add(std::bit_cast<std::uint32_t>(value));
        add(static_cast<std::uint32_t>(c.state));
        add(c.faults.bits());
    }
    [[nodiscard]] std::uint64_t value() const { return value_; }

  private:
    void add(const std::uint32_t word) {
        for (unsigned shift = 0; shift < 32; shift += 8) {
            value_ ^= (word >> shift) & 0xFFU;
            value_ *= 0x100000001B3U;
        }
    }
    std::uint64_t value_ = 0xCBF29CE484222325U;
};

bool same_bits(const Command& a, const Command& b) {
    Hash x, y;
    x.add(a);
    y.add(b);
    return x.value() == y.value();
}

}  // namespace

TEST_CASE("two controllers fed the same give the same bits", "[CTL-095]") {
    Controller a(fixed_config());
    Controller b(fixed_config());
    RecordedLanding landing(1);
    Command command;
    for (int k = 0; k < 50'000; ++k) {
        const Sensors seen = landing.next(command);
        command = a.step(seen, landing.time());
        REQUIRE(same_bits(command, b.step(seen, landing.time())));
    }
}

TEST_CASE("a copy forks the state", "[CTL-095]") {
    static_assert(std::is_trivially_copyable_v<Controller>);
    static_assert(std::is_nothrow_copy_constructible_v<Controller>);
    Controller a(fixed_config());
    RecordedLanding landing(2);
    Command command;
    for (int k = 0; k < 3'000; ++k) command = a.step(landing.next(command), landing.time());
    REQUIRE(command.state == State::braking);
    Controller b = a;
    Controller kept = a;
    RecordedLanding same = landing;
    Command on_a = command, on_b = command;
    for (int k = 0; k < 3'000; ++k) {
        on_a = a.step(landing.next(on_a), landing.time());
        on_b = b.step(same.next(on_b), same.time());
        REQUIRE(same_bits(on_a, on_b));
    }
    // What happened to one has not happened to the copy that was kept.
    Sensors stop = landing.next(on_a);
    stop.emergency_stop = true;
    CHECK(a.step(stop, landing.time()).state == State::safe);
    CHECK(b.step(same.next(on_b), same.time()).state == State::braking);
    RecordedLanding again(2);
    Controller c(fixed_config());
    Command on_c;
    for (int k = 0; k < 3'000; ++k) on_c = c.step(again.next(on_c), again.time());
    const Sensors next = again.next(on_c);
    CHECK(same_bits(kept.step(next, again.time()), c.step(next, again.time())));
}

TEST_CASE("the controller never allocates and is of a size that any microcontroller has", "[CTL-095]") {
    const std::uint64_t start = allocations();
    ::operator delete(::operator new(1));
    const std::uint64_t trapped = allocations() - start;
    REQUIRE(trapped == 1);

    RecordedLanding landing(3);
    const std::uint64_t before = allocations();
    Controller controller(fixed_config());
    Command command;
    std::uint64_t in_steps = 0;
    for (int k = 0; k < 100'000; ++k) {
        const Sensors seen = landing.next(command);
        const std::uint64_t now = allocations();
        command = controller.step(seen, landing.time());
        in_steps += allocations() - now;
    }
    const std::uint64_t altogether = allocations() - before;
    CHECK(in_steps == 0);
    CHECK(altogether == 0);
    // docs/engineering/controller.md states this size.
    CHECK(sizeof(Controller) <= 2048);
}

TEST_CASE("the bits are those of every other machine and build", "[CTL-095]") {
    // One word for 96,000 commands through all laws and states. It changes only when the arithmetic of firmware/control does, and then it
    // must be the same again in every preset and on every machine: no fused multiply-add, no libm, no reordering.
    Controller controller(fixed_config());
    RecordedLanding landing(4);
    Hash hash;
    Command command;
    std::array<int, kStateCount> states{};
    for (int k = 0; k < 96'000; ++k) {
        const Sensors seen = landing.next(command);
        command = controller.step(seen, landing.time());
        ++states[static_cast<std::size_t>(command.state)];
        hash.add(command);
    }
    for (std::size_t i = 0; i < kStateCount; ++i) {
        CAPTURE(i);
        CHECK(states[i] > 0);
    }
    CAPTURE(sizeof(Controller));
    CHECK(hash.value() == 0x5EA5259E1BD64662U);
}
