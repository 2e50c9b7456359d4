#include <bit>
#include <chrono>
#include <optional>

#include "firmware/can/value_names.hpp"
#include "rig_bridge/record/bus_meter.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/rig/sequencer.hpp"
#include "tests/catch.hpp"
#include "tests/record/closed_form.hpp"

using namespace record_test;
using rig::record::BusMeter;
using rig::record::Figures;

namespace {

Figures measure(const Recording& recording) {
    BusMeter meter(can_test::ours(), kRig);
    for (const Frame& frame : recording.frames) meter.accept(frame);
    return meter.figures();
}

/// `late_s`: how late a change of phase may count.
void check(const ClosedForm& c, const Figures& f, double late_s) {
    CHECK(f.standstill);
    CHECK(f.brake_on_mps == Approx(c.v0_mps).epsilon(2e-4));
    CHECK(f.duration_s == Approx(c.duration_s()).margin(0.002 + late_s));
    CHECK(f.length_m == Approx(c.length_m()).margin(0.01 + late_s * c.v0_mps));
    CHECK(f.mean_torque_Nm == Approx(c.torque_Nm).epsilon(1e-3));
    CHECK(f.mean_load_N == Approx(c.load_N).epsilon(1e-6));
    CHECK(f.mean_pressure_Pa == Approx(c.pressure_Pa).epsilon(1e-3));
    CHECK(f.mean_friction == Approx(c.torque_Nm / c.pressure_Pa / kRig.brake_gain_m3).epsilon(1e-3));
    const double omega = (1.0 - c.slip) * c.v0_mps / c.radius_m();
    CHECK(f.energy_brake_J == Approx(c.torque_Nm * (1.0 - c.slip) / c.radius_m() * c.length_m()).epsilon(1e-3));
    // The way of slip is 3 % of the length; an edge at either end is an error of 0.3 % of that.
    CHECK(f.energy_tyre_J == Approx(c.force_N * c.slip * c.length_m()).epsilon(0.005));
    CHECK(f.kinetic_energy_J ==
          Approx(0.5 * kRig.flywheel_mass_kg * c.v0_mps * c.v0_mps + 0.5 * kRig.wheel_inertia_kgm2 * omega * omega).epsilon(5e-4));
    CHECK(f.j_mu == Approx(c.force_N / c.load_N / kRig.peak_friction).epsilon(1e-3));
}

bool same_bits(const Figures& a, const Figures& b) {
    for (const rig::record::FigureField& field : rig::record::kFigureFields) {
        if (std::bit_cast<std::uint64_t>(a.*field.value) != std::bit_cast<std::uint64_t>(b.*field.value)) return false;
    }
    return a.standstill == b.standstill;
}

}  // namespace

TEST_CASE("a maneuver in closed form: every figure, by SYNC and by stamps", "[BRG-200]") {
    for (const bool sync : {true, false}) {
        ClosedForm c;
        const Recording recording(c, sync);
        const Figures f = measure(recording);
        INFO((sync ? "SYNC" : "stamps"));
        check(c, f, sync ? 0.0 : 0.001);
        CHECK(f.peak_temperature_C == Approx(20.0 + 10.0 * std::floor(c.rest_s() + c.standstill_s + 0.4)));
        CHECK(recording.naive_rest_s < c.duration_s() - 0.15);  // what the last edge alone would say
    }
    ClosedForm hard;
    hard.a1_mps2 = hard.a2_mps2 = 9.0;
    hard.force_N = 6400.0;
    check(hard, measure(Recording(hard, true)), 0.0);
}

TEST_CASE("standstill is found within 20 ms, without bias, wherever the teeth stand", "[BRG-200][figures]") {
    struct Case {
        const char* what;
        double a1, a2, standstill_s, jitter_s, slowest_edges_hz, pitch_error;
    };
    // Table III; a hard stop; the brake let go of at drop-out, either way; the phase before rest and long after it; an encoder that
    // sees every edge; stamps and teeth as of a real one.
    for (const Case& one :
         {Case{"Table III", 3.242, 3.242, 0.05, 1e-6, 10.0, 0.0}, Case{"hard", 9.0, 9.0, 0.05, 1e-6, 10.0, 0.0},
          Case{"soft", 1.5, 1.5, 0.05, 1e-6, 10.0, 0.0}, Case{"harder below drop-out", 3.242, 9.0, 0.05, 1e-6, 10.0, 0.0},
          Case{"softer below drop-out", 9.0, 3.242, 0.05, 1e-6, 10.0, 0.0}, Case{"phase early", 3.242, 3.242, -0.03, 1e-6, 10.0, 0.0},
          Case{"phase late", 3.242, 3.242, 0.7, 1e-6, 10.0, 0.0}, Case{"every edge seen", 3.242, 3.242, 0.05, 1e-6, 0.01, 0.0},
          Case{"coarse stamps", 3.242, 3.242, 0.05, 20e-6, 10.0, 0.0}, Case{"teeth off by 0.3 %", 3.242, 3.242, 0.05, 1e-6, 10.0, 0.003}}) {
        INFO(one.what);
        double bias = 0.0;
        double bias_m = 0.0;
        constexpr int kTeeth = 20;
        for (int i = 0; i < kTeeth; ++i) {
            ClosedForm c;
            c.v0_mps = 20.0;
            c.a1_mps2 = one.a1;
            c.a2_mps2 = one.a2;
            c.standstill_s = one.standstill_s;
            c.jitter_s = one.jitter_s;
            c.slowest_edges_hz = one.slowest_edges_hz;
            c.pitch_error = one.pitch_error;
            c.tooth = (i + 0.5) / kTeeth;
            const Figures f = measure(Recording(c, true, static_cast<unsigned>(i + 1)));
            REQUIRE(f.standstill);
            CHECK(std::abs(f.duration_s - c.duration_s()) < 0.02);
            bias += (f.duration_s - c.duration_s()) / kTeeth;
            bias_m += (f.length_m - c.length_m()) / kTeeth;
        }
        CHECK(std::abs(bias) < 0.005);
        CHECK(std::abs(bias_m) < 0.01);
    }
}

TEST_CASE("by SYNC number the kernel's stamps do not matter, and a number said twice or left out neither", "[BRG-200]") {
    ClosedForm c;
    c.v0_mps = 20.0;
    const Recording recording(c, true);
    const Figures expected = measure(recording);
    const std::uint16_t sync = can_test::ours()[antiskid::can::Role::sync].id;
    BusMeter shifted(can_test::ours(), kRig);
    BusMeter repeated(can_test::ours(), kRig);
    BusMeter thinned(can_test::ours(), kRig);
    std::mt19937 random(203);
    std::size_t n = 0;
    for (Frame frame : recording.frames) {
        repeated.accept(frame);
        if (frame.id == sync) repeated.accept(frame);
        if (frame.id != sync || ++n % 5 != 0) thinned.accept(frame);
        frame.received = Time{static_cast<std::int64_t>(random())};
        shifted.accept(frame);
    }
    CHECK(same_bits(shifted.figures(), expected));
    CHECK(same_bits(repeated.figures(), expected));
    CHECK(thinned.figures().duration_s == Approx(expected.duration_s).margin(0.002));
}

TEST_CASE("SYNC numbers that are corrupted, overtaken, missing for long or begun anew cost their own time", "[BRG-200]") {
    ClosedForm c;
    c.v0_mps = 20.0;
    const Recording recording(c, true);
    const Figures expected = measure(recording);
    const auto& layout = can_test::ours();
    const std::uint16_t sync = layout[antiskid::can::Role::sync].id;
    const auto numbered = [&](Frame frame, const std::uint64_t number) {
        antiskid::can::Payload payload;  // it carries nothing else
        payload.write(layout.sync_counter, static_cast<std::int64_t>(number));
        frame.data = payload.bytes();
        return frame;
    };
    BusMeter corrupted(layout, kRig), overtaken(layout, kRig), silent(layout, kRig), anew(layout, kRig);
    std::mt19937 random(204);
    std::uint64_t n = 0;
    std::optional<Frame> kept;
    for (const Frame& frame : recording.frames) {
        const bool is_sync = frame.id == sync;
        if (is_sync) ++n;
        const auto number = static_cast<std::uint64_t>(antiskid::can::Payload(frame.data).read(layout.sync_counter));
        const std::uint64_t bit = std::uint64_t{1} << (random() % 16U);
        corrupted.accept(is_sync && n % 50 == 0 ? numbered(frame, number ^ bit) : frame);
        if (!(is_sync && n > 1000 && n <= 1200)) silent.accept(frame);
        anew.accept(is_sync && n > 1000 ? numbered(frame, n - 1000) : frame);
        if (is_sync && n % 50 == 0) {
            kept = frame;
        } else {
            overtaken.accept(frame);
            if (is_sync && kept) overtaken.accept(*kept);
            if (is_sync) kept.reset();
        }
    }
    CHECK(corrupted.figures().duration_s == Approx(expected.duration_s).margin(0.01));
    CHECK(overtaken.figures().duration_s == Approx(expected.duration_s).margin(0.003));
    CHECK(silent.figures().duration_s == Approx(expected.duration_s).margin(0.003));
    CHECK(anew.figures().duration_s == Approx(expected.duration_s).margin(0.003));
    for (const BusMeter* meter : {&corrupted, &overtaken, &silent, &anew}) CHECK(meter->figures().length_m == Approx(expected.length_m).margin(0.05));
}

TEST_CASE("SYNC numbers go on across the roll-over of their field", "[BRG-200]") {
    ClosedForm c;
    c.before_s = 60.0;  // 2^16 ms later the brake is on
    const Figures f = measure(Recording(c, true));
    check(c, f, 0.0);
}

TEST_CASE("a wall clock that is set back costs the time of one sample", "[BRG-200]") {
    ClosedForm c;
    const Recording recording(c, false);
    BusMeter meter(can_test::ours(), kRig);
    std::size_t n = 0;
    for (Frame frame : recording.frames) {
        if (++n > recording.frames.size() / 2) frame.received -= std::chrono::hours(1);
        meter.accept(frame);
    }
    CHECK(meter.steps_back() == 1);
    // From there on the sensors' clocks lie later by that sample.
    CHECK(meter.figures().duration_s == Approx(c.duration_s()).margin(0.005));
}

TEST_CASE("frames that are missing are told, and cost little", "[BRG-200]") {
    ClosedForm c;
    const Recording recording(c, true);
    BusMeter meter(can_test::ours(), kRig);
    std::mt19937 random(204);
    std::uint64_t gone = 0;
    const std::uint16_t wheel = can_test::ours()[antiskid::can::Role::wheel].id;
    const std::uint16_t state = can_test::ours()[antiskid::can::Role::maneuver_state].id;
    for (const Frame& frame : recording.frames) {
        if (frame.id != state && random() % 100 == 0) {
            if (frame.id == wheel) ++gone;
            continue;
        }
        meter.accept(frame);
    }
    CHECK(gone > 100);
    CHECK(meter.observer().stats(antiskid::can::Role::wheel).lost == gone);
    CHECK(meter.frames_lost() > gone);
    check(c, meter.figures(), 0.002);
}

TEST_CASE("an aborted maneuver has its figures to the abort, a maneuver without a brake has none", "[BRG-200]") {
    rig::record::Meter meter(kRig);
    rig::record::MeterSample sample;
    sample.vertical_N = 20'000.0;
    double way = 0.0;
    const auto run = [&](std::uint8_t phase, int steps, double deceleration, double torque) {
        static double speed = 30.0;
        for (int i = 0; i < steps; ++i) {
            speed -= deceleration * 1e-3;
            way += speed * 1e-3;
            const double pitch = 2.0 * std::numbers::pi / 60.0 * kRig.flywheel_radius_m;
            sample.time_s += 1e-3;
            sample.phase = phase;
            sample.brake_torque_Nm = torque + 1e-6 * i;  // no load cell says the same twice
            const double edges = std::floor(way / pitch);
            const double since = (way - edges * pitch) / speed;
            sample.flywheel = {.edges = true,
                               .edge_count = static_cast<std::uint32_t>(edges),
                               .edge_time = Time{std::llround((sample.time_s - since) * 1e9)},
                               .speed_radps = 0.0};
            meter.feed(sample);
        }
    };
    run(3, 1000, 0.0, 0.0);
    CHECK_FALSE(meter.started());
    CHECK(same_bits(meter.figures(), {}));
    run(4, 2000, 3.0, 600.0);
    CHECK(meter.started());
    run(9, 500, 0.0, 0.0);
    CHECK_FALSE(meter.open());
    const Figures f = meter.figures();
    CHECK_FALSE(f.standstill);
    CHECK(f.duration_s == Approx(2.0).margin(1e-9));
    CHECK(f.length_m == Approx(30.0 * 2.0 - 0.5 * 3.0 * 4.0).margin(0.1));
    CHECK(f.mean_torque_Nm == Approx(600.0).epsilon(1e-3));
    CHECK(f.mean_friction == 0.0);  // no pressure was measured
    CHECK(f.kinetic_energy_J == Approx(0.5 * kRig.flywheel_mass_kg * (900.0 - 24.0 * 24.0)).epsilon(2e-3));
    // What follows, the next spin-up too, changes nothing.
    run(1, 1000, -5.0, 0.0);
    CHECK(same_bits(meter.figures(), f));
}

TEST_CASE("sensors that report speed are measured, too", "[BRG-200]") {
    ClosedForm c;
    rig::record::Meter meter(kRig);
    for (double t = 0.0; t < c.rest_s() + 0.5; t += 1e-3) {
        const double v = c.speed(t);
        const bool braking = Recording::begun(c, t) && v > 0.0;
        meter.feed({.time_s = t,
                    .phase = Recording::phase(c, t),
                    .wheel = {.edges = false, .edge_count = 0, .edge_time = {}, .speed_radps = (1.0 - c.slip) * v / c.radius_m()},
                    .flywheel = {.edges = false, .edge_count = 0, .edge_time = {}, .speed_radps = v / kRig.flywheel_radius_m},
                    .pressure_Pa = braking ? c.pressure_Pa : 0.0,
                    .vertical_N = c.load_N,
                    .longitudinal_N = braking ? c.force_N : 0.0,
                    .brake_torque_Nm = braking ? c.torque_Nm : 0.0,
                    .brake_temperature_C = 20.0});
    }
    const Figures f = meter.figures();
    CHECK(f.duration_s == Approx(c.duration_s()).margin(0.02));
    CHECK(f.length_m == Approx(c.length_m()).epsilon(1e-3));
    CHECK(f.energy_tyre_J == Approx(c.force_N * c.slip * c.length_m()).epsilon(2e-3));
    CHECK(f.mean_torque_Nm == Approx(c.torque_Nm).epsilon(2e-3));
}

TEST_CASE("samples rounded as on the bus give what the frames give", "[BRG-200]") {
    ClosedForm c;
    c.v0_mps = 20.0;
    c.jitter_s = 1e-6;
    const Recording recording(c, true);
    BusMeter from_frames(can_test::ours(), kRig);
    for (const Frame& frame : recording.frames) from_frames.accept(frame);

    const double pitch = 2.0 * std::numbers::pi / 60.0;
    Edges flywheel(c, pitch * kRig.flywheel_radius_m, 1);
    Edges wheel(c, pitch * c.radius_m() / (1.0 - c.slip), 2);
    rig::record::Meter meter(kRig);
    rig::record::MeterSample sample;
    const auto shaft = [](const antiskid::can::SpeedSample& s) {
        return rig::record::ShaftSample{.edges = true, .edge_count = s.edge_count, .edge_time = s.edge_time, .speed_radps = 0.0};
    };
    const auto steps = static_cast<std::uint32_t>((c.rest_s() + c.standstill_s + 0.5) * 1000.0);
    for (std::uint32_t n = 1; n <= steps; ++n) {
        const double t = 1e-3 * n;
        sample.time_s = t;
        sample.phase = Recording::phase(c, t);
        sample.flywheel = shaft(flywheel.at(t, 1234.5));
        sample.wheel = shaft(wheel.at(t, 77.25));
        sample.pressure_Pa = Recording::begun(c, t) ? c.pressure_Pa : 0.0;
        if (n % 10 == 3) {  // as the load cells' schedule has it
            const bool braking = Recording::begun(c, t) && t <= c.rest_s();
            sample.vertical_N = c.load_N;
            sample.longitudinal_N = braking ? c.force_N : 0.0;
            sample.brake_torque_Nm = braking ? c.torque_Nm : 0.0;
        }
        meter.feed(as_on_bus(can_test::ours(), sample));
    }
    const Figures a = from_frames.figures();
    const Figures b = meter.figures();
    for (const rig::record::FigureField& field : rig::record::kFigureFields) {
        if (std::string_view(field.key) == "peak_temperature_C") continue;
        INFO(field.key);
        CHECK(b.*field.value == Approx(a.*field.value).epsilon(1e-9));
    }
}

TEST_CASE("phases have the same codes and names on the bus and in the sequencer", "[CAN-100]") {
    REQUIRE(antiskid::can::kPhaseNames.size() == rig::kPhaseCount);
    for (std::uint8_t i = 0; i < rig::kPhaseCount; ++i) CHECK(antiskid::can::kPhaseNames[i] == name(static_cast<rig::Phase>(i)));
}
