/// The meter sees frames; the virtual rig knows the truth. Both of the same maneuver must agree.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rig_bridge/record/bus_meter.hpp"
#include "rig_bridge/rig/meter_parameters.hpp"
#include "tests/catch.hpp"
#include "tests/study/scenarios.hpp"

using antiskid::can::Frame;
using antiskid::can::RigPort;

namespace {

std::uint8_t phase_code(study::StopPhase phase) {
    switch (phase) {
        case study::StopPhase::approach:
            return 2;
        case study::StopPhase::rolling:
            return 3;
        case study::StopPhase::braking:
            return 4;
        case study::StopPhase::standstill:
            return 5;
        default:
            return 6;
    }
}

struct Both {
    study::StopFigures truth;
    rig::record::Figures measured;
    double brake_on_mps = 0.0;
    double kinetic_J = 0.0;
    antiskid::control::FaultSet faults;
    std::vector<std::string> warnings;
};

enum class Silent : std::uint8_t { load_cells, encoders, everything };

/// What does not reach the meter, in s since brake-on.
struct Hole {
    double from_s = 0.0, to_s = 0.0;
    Silent silent = Silent::load_cells;
    int every = 1;  ///< of the load cells' frames only every so many arrive
};

/// Times in ms. Load cells are read in the PLC's scan, each 10; the registers are asked for each 20, and what came goes on the bus in a step of the
/// bridge, each 10.
struct Plc {
    int scan = 0, poll = 0, step = 0;  ///< each begins then
    bool tells_age = true;
};

/// The load cells' frames of a bridge.
class LateCells {
  public:
    LateCells(const antiskid::can::Layout& layout, const Plc& plc) : plc_(plc), port_(layout, antiskid::control::Time{1'000'000}) {}

    std::optional<Frame> after(const antiskid::can::LoadCellSample& now) {
        constexpr int kScan_ms = 10, kPoll_ms = 20, kStep_ms = 10;
        std::optional<Frame> frame;
        ++ms_;
        if (ms_ % kPoll_ms == plc_.poll) {  // the scan of this period comes after it
            polled_ = scanned_;
            polled_ms_ = ms_;
            sent_ = false;
        }
        if (ms_ % kScan_ms == plc_.scan) scanned_ = now;
        if (ms_ % kStep_ms == plc_.step && !std::exchange(sent_, true)) {
            antiskid::can::LoadCellSample sample = polled_;
            constexpr double kInRegisters_ms = 0.5 * (kScan_ms + 1);
            if (plc_.tells_age) sample.age = antiskid::control::Time{std::llround((ms_ - polled_ms_ + kInRegisters_ms) * 1e6)};
            frame = port_.load_cells(sample);
        }
        return frame;
    }

  private:
    Plc plc_;
    RigPort port_;
    antiskid::can::LoadCellSample scanned_, polled_;
    int ms_ = 0, polled_ms_ = 0;
    bool sent_ = true;
};

Both run(const plant_sim::StopOptions& options, const Hole& hole = {}, const std::optional<Plc>& plc = {}, const rig::Clamping& clamping = {}) {
    plant_sim::StopInputs s = plant_sim::load_scenario(options);
    s.plant.rig.clamping = clamping;
    rig::record::MeterParameters parameters = rig::meter_parameters(s.plant, 1e-3);
    parameters.sensor_late_s = 0.02;
    rig::record::BusMeter meter(s.layout, parameters);
    constexpr std::array kState{antiskid::can::Role::maneuver_state};
    RigPort bridge(s.layout, antiskid::control::Time{1'000'000}, kState);
    study::StopPhase phase = study::StopPhase::approach;
    Both both;
    double braking_s = -1.0;
    int load_cells = 0;
    std::optional<LateCells> late;
    if (plc) late.emplace(s.layout, *plc);
    const auto hear = [&](const Frame& frame) {
        const auto is = [&](antiskid::can::Role role) { return frame.id == s.layout[role].id; };
        const bool of_cells = is(antiskid::can::Role::load_cells);
        if (of_cells && (late || ++load_cells % hole.every != 0)) return;
        const bool in_it = hole.silent == Silent::everything || (hole.silent == Silent::load_cells && of_cells) ||
                           (hole.silent == Silent::encoders && (is(antiskid::can::Role::wheel) || is(antiskid::can::Role::flywheel)));
        if (!in_it || braking_s < hole.from_s || braking_s >= hole.to_s) meter.accept(frame);
    };
    const auto on_step = [&](const study::RigSession& session, const antiskid::can::ControllerView& /*view*/, double /*mA*/) {
        if (phase != study::StopPhase::braking && session.pilot().phase() == study::StopPhase::braking) {
            both.brake_on_mps = session.rig().wheel().v_mps;
            both.kinetic_J = session.rig().kinetic_energy_J();
        }
        phase = session.pilot().phase();
        if (phase == study::StopPhase::braking || braking_s >= 0.0) braking_s = std::max(braking_s, 0.0) + 1e-3;
        antiskid::can::RigSample sample;
        sample.maneuver_state = {.phase = phase_code(phase), .number = 1, .brake_temperature_C = 20.0F};
        std::array<Frame, RigPort::kMaxFrames> due;
        for (std::size_t i = 0, count = bridge.due_frames(sample, due); i < count; ++i) hear(due[i]);
        if (!late) return;
        if (const auto frame = late->after(session.load_cells())) meter.accept(*frame);
    };
    both.truth = run_in_process(s.controller, s.layout, s.plant.rig, s.session, study::Link::frames, on_step, hear).figures;
    both.measured = meter.figures();
    both.faults = meter.faults();
    both.warnings = meter.warnings();
    return both;
}

void compare(const Both& b) {
    REQUIRE(b.truth.standstill);
    REQUIRE(b.measured.standstill);
    CHECK(b.faults.empty());
    CHECK(b.measured.brake_on_mps == Approx(b.brake_on_mps).margin(0.01));
    // The plant stops dead at kSlowest_mps; a flywheel would have gone on for this long.
    const double left_s = plant::Wheel::kSlowest_mps * b.truth.duration_s / b.brake_on_mps;
    CHECK(b.measured.duration_s == Approx(b.truth.duration_s + left_s).margin(0.02));
    CHECK(b.measured.length_m == Approx(b.truth.stop_distance_m).margin(0.1));
    CHECK(b.measured.mean_torque_Nm == Approx(b.truth.mean_torque_Nm).epsilon(0.003));
    CHECK(b.measured.mean_load_N == Approx(b.truth.mean_load_N).epsilon(0.003));
    CHECK(b.measured.mean_friction == Approx(b.truth.mean_friction).epsilon(0.005));
    CHECK(b.measured.energy_brake_J == Approx(b.truth.energy_brake_J).epsilon(0.003));
    // A small part of the whole, the difference of two ways.
    CHECK(b.measured.energy_tyre_J == Approx(b.truth.energy_tyre_J).margin(0.003 * b.truth.energy_brake_J));
    CHECK(b.measured.kinetic_energy_J == Approx(b.kinetic_J).epsilon(0.002));
    CHECK(b.measured.j_mu == Approx(b.truth.j_mu).margin(0.005));
}

}  // namespace

TEST_CASE("landings on every kind of surface: the meter's figures are the plant's", "[BRG-200]") {
    for (const char* surface : {"dry_asphalt", "wet_asphalt", "snow"}) {
        for (const char* maneuver : {"light", "heavy"}) {
            INFO(surface << ' ' << maneuver);
            compare(run(scenarios::options({surface, maneuver})));
        }
    }
}

TEST_CASE("friction is counted above the pressure at which the discs touch", "[BRG-200]") {
    // On snow the brake needs 2 to 3 MPa: without the springs' share its friction would be two thirds of what it is.
    for (const char* surface : {"dry_asphalt", "snow"}) {
        CAPTURE(surface);
        const Both both = run(scenarios::options({surface, "heavy"}), {}, {}, {.contact_Pa = 1e6});
        compare(both);
        CHECK(both.measured.mean_friction == Approx(0.30).epsilon(0.1));
    }
}

TEST_CASE("endurance stops: the meter's figures are the plant's", "[BRG-200]") {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        auto options = scenarios::options({"dry_asphalt", "endurance"}, "deceleration");
        options.seed = seed;
        const Both both = run(options);
        compare(both);
        CHECK(both.measured.duration_s == Approx(16.92).margin(1.0));
    }
}

TEST_CASE("where load cells or encoders are silent, the speeds say what the brake took, and that is said", "[BRG-200][figures]") {
    std::vector<plant_sim::StopOptions> stops{scenarios::options({"dry_asphalt", "endurance"}, "deceleration")};
    for (const char* surface : {"dry_asphalt", "wet_asphalt", "snow"})
        for (const char* maneuver : {"light", "heavy"}) stops.push_back(scenarios::options({surface, maneuver}));
    for (const plant_sim::StopOptions& stop : stops) {
        for (const Hole& hole :
             {Hole{0.0, 1e9}, Hole{0.0, 3.0}, Hole{1.0, 3.0}, Hole{2.0, 1e9}, Hole{0.05, 1.0, Silent::everything}, Hole{1.5, 2.5, Silent::everything},
              Hole{0.3, 0.5}, Hole{0.05, 1.0, Silent::encoders}, Hole{1.5, 2.5, Silent::encoders}, Hole{0.3, 0.5, Silent::encoders}}) {
            CAPTURE(stop.choice.surface, stop.choice.maneuver, hole.from_s, hole.to_s, static_cast<int>(hole.silent));
            const Both b = run(stop, hole);
            // Over a hole in the edges slip is that of all of them, from step to step that of two windows.
            const double margin_J = (hole.silent == Silent::load_cells ? 0.01 : 0.002) * b.truth.energy_brake_J;
            CHECK(b.measured.energy_brake_J == Approx(b.truth.energy_brake_J).margin(margin_J));
            CHECK(b.measured.energy_tyre_J == Approx(b.truth.energy_tyre_J).margin(margin_J));
            CHECK(b.measured.mean_torque_Nm == Approx(b.truth.mean_torque_Nm).epsilon(0.02));
            if (hole.silent != Silent::everything)  // else pressure is not known either, and friction is that of the rest
                CHECK(b.measured.mean_friction == Approx(b.truth.mean_friction).epsilon(0.02));
            REQUIRE(b.warnings.size() == 1);
            CHECK_THAT(b.warnings[0], ContainsSubstring("energy_by_speeds: "));
        }
    }
}

TEST_CASE("how often load cells are read costs no energy", "[BRG-200]") {
    for (const char* surface : {"dry_asphalt", "wet_asphalt", "snow"}) {
        for (const int every : {1, 2, 4}) {
            CAPTURE(surface, every);
            const Both b = run(scenarios::options({surface, "light"}), {.every = every});
            CHECK(b.warnings.empty());
            CHECK(b.measured.energy_brake_J == Approx(b.truth.energy_brake_J).epsilon(0.003));
        }
    }
}

TEST_CASE("load cells that are late through a PLC cost no energy in the mean, since each reading tells its age", "[BRG-200]") {
    for (const double speed_mps : {9.0, 15.0, 26.0}) {
        for (const double mass_kg : {2200.0, 3700.0}) {
            CAPTURE(speed_mps, mass_kg);
            auto options = scenarios::options({"dry_asphalt", "light"});
            options.choice.speed_mps = speed_mps;
            options.choice.mass_kg = mass_kg;
            constexpr int kPhases = 10;
            std::array<double, 2> off{};
            for (int i = 0; i < kPhases; ++i) {
                for (const bool tells_age : {false, true}) {
                    const Both b = run(options, {}, Plc{.scan = i, .poll = (3 * i + 1) % 20, .step = 7 * i % 10, .tells_age = tells_age});
                    CHECK(b.warnings.empty());
                    const double one = b.measured.energy_brake_J / b.truth.energy_brake_J - 1.0;
                    off.at(tells_age ? 1 : 0) += one / kPhases;
                    // What is left is where in its scan the PLC was asked: half a scan of the rise of torque.
                    if (tells_age) CHECK(std::abs(one) < 0.2 / speed_mps);
                }
            }
            UNSCOPED_INFO("without age " << off[0] << ", with it " << off[1]);
            CHECK(off[0] < -0.1 / speed_mps);
            CHECK(std::abs(off[1]) < 0.005);
        }
    }
}
