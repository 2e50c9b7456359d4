/// One step of eight wheels at once has the bits of eight single steps, whatever instructions the vector code is made of.
#include "tests/catch.hpp"

#include <array>
#include <cstring>

#include "plant_sim/model/wheel_lanes.hpp"
#include "rig_bridge/rig/random.hpp"

namespace {

constexpr std::size_t kLanes = plant::WheelLanes::kLanes;
constexpr std::size_t kMembers = sizeof(plant::wheel_step::Step) / sizeof(double);

std::array<std::uint64_t, kMembers> bits(const plant::wheel_step::Step& step) {
    std::array<std::uint64_t, kMembers> out{};
    std::memcpy(out.data(), &step, sizeof step);
    return out;
}

}  // namespace

TEST_CASE("wheels in lanes: bits of the single wheel, on any instruction set", "[STUDY-160]") {
    rig::Random random(7);
    const auto between = [&random](double low, double high) { return low + (high - low) * static_cast<double>(random.bits() >> 11U) * 0x1p-53; };
    using Instructions = plant::WheelLanes::Instructions;
    int infinite = 0;
    for (int round = 0; round < 2000; ++round) {
        plant::WheelLanes lanes;
        std::array<plant::wheel_step::Step, kLanes> alone{};
        for (std::size_t i = 0; i < kLanes; ++i) {
            const double mass = between(500.0, 5000.0);
            const double brake_on = between(20.0, 65.0);
            plant::wheel_step::Law law{};
            law.mass_kg = mass;
            law.per_mass = 1.0 / mass;
            law.per_inertia = 1.0 / between(0.5, 2.0);
            law.per_stiffness = 1.0 / between(1e6, 4e6);
            law.free_radius_m = between(0.25, 0.4);
            law.tyre = {between(0.05, 1.4), between(5.0, 310.0), between(0.0, 0.7)};
            law.brake = plant::BrakeTorque({between(4e-4, 1e-3), 6.0, 6.0, 0.12}, {0.3, 0.1, -0.1, 0.02}, between(0.2, 0.4), brake_on);
            // Speeds beyond brake-on, near standstill, overspeeding and almost locked wheels, pressures that dip below zero.
            const double v = round % 4 == 0 ? between(0.0, 0.3) : between(0.0, 1.1 * brake_on);
            plant::WheelLanes::Input in{};
            in.v_mps = v;
            in.omega_radps = round % 3 == 0 ? between(0.0, 1.0) : between(0.0, 1.2) * v / law.free_radius_m;
            in.pressure = plant::PressureArc::hermite(between(-1e5, 2e7), between(-1e9, 1e9), between(-1e5, 2e7), between(-1e9, 1e9), 1e-3);
            in.load = {between(0.0, 5e4), between(-100.0, 100.0), between(0.0, 4.0)};
            in.h = between(2e-4, 1e-3);
            const auto start =
                plant::wheel_step::instant(law, in.v_mps, in.omega_radps, in.load.base_at(0.0), in.load.change_N / in.h, in.load.lift_Ns2pm2);
            alone[i] = plant::wheel_step::turn(law, start, in.pressure, in.load, in.h);
            infinite += alone[i].error > 1e300 ? 1 : 0;
            lanes.laws.set(i, law);
            lanes.inputs.set(i, in);
        }
        for (const auto instructions : {Instructions::baseline, Instructions::avx2, Instructions::avx512}) {
            if (!plant::WheelLanes::has(instructions)) continue;
            lanes.steps = {};
            lanes.turn(instructions);
            for (std::size_t i = 0; i < kLanes; ++i) {
                INFO("round " << round << ", lane " << i << ", instructions " << static_cast<int>(instructions));
                REQUIRE(bits(lanes.steps[i]) == bits(alone[i]));
            }
        }
    }
    CHECK(infinite > 0);  // the rarest branch was among them
}
