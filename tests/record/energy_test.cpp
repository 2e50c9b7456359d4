// What a sensor says that has started anew, a frame that was replayed and a load cell that lies must not become energy.
#include <algorithm>
#include <deque>
#include <iterator>
#include <tuple>

#include "rig_bridge/record/bus_meter.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "tests/catch.hpp"
#include "tests/record/closed_form.hpp"

using namespace record_test;
using antiskid::can::Role;
using antiskid::can::SpeedSample;
using rig::record::BusMeter;
using rig::record::Figures;

namespace {

struct Measured {
    Figures figures;
    std::vector<std::string> warnings;

    [[nodiscard]] bool warns(const std::string& of) const {
        return std::any_of(warnings.begin(), warnings.end(), [&](const std::string& one) { return one.starts_with(of); });
    }
    [[nodiscard]] double counted_J() const {
        rig::record::Summary summary;
        summary.figures = figures;
        summary.warnings = warnings;
        return counted_energy_J(summary);
    }
};

Measured measure(const std::vector<Frame>& frames, const rig::record::MeterParameters& parameters = gated()) {
    BusMeter meter(can_test::ours(), parameters);
    for (const Frame& frame : frames) meter.accept(frame);
    return {.figures = meter.figures(), .warnings = meter.warnings()};
}

double brake_J(const ClosedForm& c) {
    return c.torque_Nm * (1.0 - c.slip) / c.radius_m() * c.length_m();
}

/// A sensor that was started at `at_s`: both its count and its clock begin there.
Recording::Change started_anew(double at_s) {
    struct Origin {
        std::uint32_t count = 0;
        Time time{};
        bool known = false;
    };
    return [at_s, wheel = Origin{}, flywheel = Origin{}](double t, RigSample& sample) mutable {
        if (t < at_s) return;
        for (auto [origin, shaft] : {std::pair{&wheel, &sample.wheel}, std::pair{&flywheel, &sample.flywheel}}) {
            if (!origin->known) *origin = {shaft->edge_count, shaft->edge_time, true};
            shaft->edge_count -= origin->count;
            shaft->edge_time -= origin->time;
        }
    };
}

}  // namespace

TEST_CASE("a sound record has the same figures with the gate, and no warning", "[BRG-200]") {
    for (const bool sync : {true, false}) {
        ClosedForm c;
        c.jitter_s = 2e-6;
        c.before_s = sync ? 40.0 : 2.0;
        const Recording recording(c, sync);
        const Measured believed = measure(recording.frames, kRig);
        const Measured judged = measure(recording.frames);
        for (const rig::record::FigureField& field : rig::record::kFigureFields) CHECK(judged.figures.*field.value == believed.figures.*field.value);
        CHECK(judged.warnings.empty());
    }
    // Nor has one with holes: frames of one encoder that are lost for a while do not make its edges impossible.
    ClosedForm c;
    const Recording recording(c, true);
    const std::uint16_t wheel = can_test::ours()[Role::wheel].id;
    std::size_t n = 0;
    std::vector<Frame> thinned;
    std::copy_if(recording.frames.begin(), recording.frames.end(), std::back_inserter(thinned), [&](const Frame& frame) {
        return frame.id != wheel || ++n % 1000 > 300;  // 0.3 s of each second
    });
    const Measured judged = measure(thinned);
    REQUIRE(judged.warnings.size() == 1);
    CHECK(judged.warns("energy_by_speeds"));
    CHECK(judged.figures.energy_brake_J == Approx(brake_J(c)).epsilon(2e-3));
}

TEST_CASE("a sensor that starts anew in braking is counted, and its edges are none of the brake's", "[BRG-200]") {
    ClosedForm c;
    for (const bool sync : {true, false}) {
        for (const double at_s : {2.5, 5.0, 9.1, 12.345}) {
            CAPTURE(sync, at_s);
            const Recording recording(c, sync, 1, started_anew(at_s));
            const Measured judged = measure(recording.frames);
            CHECK(judged.warnings == std::vector<std::string>{"encoder_restarted: wheel 1", "encoder_restarted: flywheel 1"});
            CHECK(judged.figures.length_m == Approx(c.length_m()).margin(0.3));
            CHECK(judged.figures.energy_brake_J == Approx(brake_J(c)).epsilon(1e-3));
            CHECK(judged.figures.energy_brake_J < 1.001 * brake_J(c));
            CHECK(judged.figures.duration_s == Approx(c.duration_s()).margin(0.02));
            // Believed, any step back of the count is up to 65,535 edges.
            const Measured believed = measure(recording.frames, kRig);
            CHECK((believed.figures.energy_brake_J > 2.0 * brake_J(c) || believed.figures.length_m > 2.0 * c.length_m()));
        }
    }
}

TEST_CASE("of a sensor that is silent before it starts anew the speeds say what the brake took", "[BRG-200]") {
    ClosedForm c;
    const Recording recording(c, true, 1, started_anew(6.5));
    std::vector<Frame> received;
    for (std::size_t i = 0; i < recording.frames.size(); ++i) {
        const Frame& frame = recording.frames[i];
        const double t = c.rest_s() * static_cast<double>(i) / static_cast<double>(recording.frames.size());
        const bool sensor = frame.id == can_test::ours()[Role::wheel].id || frame.id == can_test::ours()[Role::flywheel].id;
        if (!sensor || t < 3.5 || t > 6.5) received.push_back(frame);
    }
    const Measured judged = measure(received);
    CHECK(judged.warns("encoder_restarted: wheel 1"));
    CHECK(judged.warns("encoder_restarted: flywheel 1"));
    CHECK(judged.warns("energy_by_speeds"));
    CHECK(judged.figures.energy_brake_J == Approx(brake_J(c)).epsilon(0.01));
    CHECK(judged.counted_J() == judged.figures.energy_brake_J);
    CHECK(judged.figures.length_m < c.length_m());
}

TEST_CASE("frames that are replayed move nothing", "[BRG-200]") {
    ClosedForm c;
    const Measured sound = measure(Recording(c, true).frames);
    for (const int age : {1, 10, 200, 1500}) {
        CAPTURE(age);
        // Every 97 ms one sample has what the encoders said `age` samples ago.
        std::deque<std::pair<SpeedSample, SpeedSample>> past;
        int n = 0;
        const Recording recording(c, true, 1, [&](double, RigSample& sample) {
            past.emplace_back(sample.wheel, sample.flywheel);
            if (past.size() <= static_cast<std::size_t>(age)) return;
            if (++n % 97 == 0) std::tie(sample.wheel, sample.flywheel) = past.front();
            past.pop_front();
        });
        const Measured judged = measure(recording.frames);
        CHECK(judged.warnings.empty());
        CHECK(judged.figures.length_m == Approx(sound.figures.length_m).margin(0.1));
        CHECK(judged.figures.energy_brake_J == Approx(sound.figures.energy_brake_J).epsilon(1e-4));
    }
}

TEST_CASE("a run of replayed frames without any other between them is no restart, and changes no figure", "[BRG-200]") {
    ClosedForm c;
    for (const double from_s : {2.2, 9.0, 16.0}) {
        for (const bool aborted : {false, true}) {
            CAPTURE(from_s, aborted);
            // For 0.15 s the encoders say what they said 0.3 s ago; where there is an abort, it comes in the midst of it.
            const auto measured = [&](bool replayed) {
                std::deque<std::pair<SpeedSample, SpeedSample>> past;
                return measure(Recording(c, true, 1, [&](double t, RigSample& sample) {
                                   past.emplace_back(sample.wheel, sample.flywheel);
                                   if (past.size() > 300) past.pop_front();
                                   if (replayed && t >= from_s && t < from_s + 0.15) std::tie(sample.wheel, sample.flywheel) = past.front();
                                   if (aborted && t > from_s + 0.075) sample.maneuver_state.phase = 9;
                               }).frames);
            };
            const Measured sound = measured(false);
            const Measured judged = measured(true);
            // The encoders are silent meanwhile.
            REQUIRE(judged.warnings.size() == 1);
            CHECK(judged.warns("energy_by_speeds"));
            const double margin_J = 1.1 * 0.075 * c.torque_Nm * c.v0_mps / c.radius_m();
            CHECK(judged.figures.kinetic_energy_J == Approx(sound.figures.kinetic_energy_J).margin(aborted ? margin_J : 1.0));
            CHECK(judged.figures.energy_brake_J ==
                  Approx(sound.figures.energy_brake_J).margin(aborted ? margin_J : 2e-4 * sound.figures.energy_brake_J));
            CHECK(judged.figures.length_m == Approx(sound.figures.length_m).margin(aborted ? 0.08 * c.v0_mps : 0.1));
        }
    }
}

TEST_CASE("what the brake takes after an abort until it has released counts; way and time end with the abort", "[BRG-200]") {
    ClosedForm c;
    constexpr double kAbort_s = 5.0;
    for (const double release_s : {0.1, 0.3, 2.0}) {
        CAPTURE(release_s);
        const Measured aborted = measure(Recording(c, true, 1, [&](double t, RigSample& sample) {
                                             if (t > kAbort_s) sample.maneuver_state.phase = 9;
                                             if (t < kAbort_s + release_s) return;
                                             sample.pressure_Pa = sample.load_cells.brake_torque_Nm = sample.load_cells.longitudinal_N = 0.0F;
                                         }).frames);
        CHECK(aborted.warnings.empty());
        CHECK(aborted.figures.duration_s == Approx(kAbort_s - c.before_s).margin(0.015));
        CHECK(aborted.figures.length_m == Approx(0.5 * (c.v0_mps + c.speed(kAbort_s)) * (kAbort_s - c.before_s)).epsilon(0.01));
        const double braked_s = kAbort_s - c.before_s + std::min(release_s, 0.5);  // then it is no release
        const double way_m = (c.v0_mps - 0.5 * c.a1_mps2 * braked_s) * braked_s;
        CHECK(aborted.figures.energy_brake_J == Approx(c.torque_Nm * (1.0 - c.slip) / c.radius_m() * way_m).epsilon(0.005));
    }
}

TEST_CASE("a sensor that starts anew where the rig stands is no motion either", "[BRG-200]") {
    ClosedForm c;
    c.standstill_s = 1.0;
    const Recording recording(c, true, 1, started_anew(c.rest_s() + 0.2));
    const Measured judged = measure(recording.frames);
    CHECK(judged.figures.length_m == Approx(c.length_m()).margin(0.1));
    CHECK(judged.figures.energy_brake_J == Approx(brake_J(c)).epsilon(1e-3));
    CHECK(judged.counted_J() == judged.figures.energy_brake_J);
}

TEST_CASE("brake and tyre energy that is not the kinetic energy lost is flagged, and counts for nothing", "[BRG-261]") {
    ClosedForm c;
    const auto with_torque = [&](float factor) {
        return measure(Recording(c, true, 1, [factor](double, RigSample& sample) { sample.load_cells.brake_torque_Nm *= factor; }).frames);
    };
    for (const float sound : {0.95F, 1.0F, 1.05F}) {
        CHECK(with_torque(sound).warnings.empty());
        CHECK(with_torque(sound).counted_J() > 0.9 * brake_J(c));
    }
    for (const float wrong : {0.0F, 0.5F, 0.85F, 1.15F, 10.0F}) {
        CAPTURE(wrong);
        const Measured judged = with_torque(wrong);
        CHECK(judged.warns("energy_unbalanced"));
        CHECK(judged.counted_J() == 0.0);
        CHECK(judged.figures.energy_brake_J == Approx(static_cast<double>(wrong) * brake_J(c)).epsilon(2e-3));
    }
    // A rig without F_x does not know the tyre's part: too much is wrong all the same, too little is not.
    const auto without_force = [&](float factor) {
        return measure(Recording(c, true, 1, [factor](double, RigSample& sample) {
                           sample.load_cells.longitudinal_N = 0.0F;
                           sample.load_cells.brake_torque_Nm *= factor;
                       }).frames);
    };
    CHECK(without_force(0.8F).warnings.empty());
    // Nor does it where the load cells are silent for a while and the speeds tell the tyre's part of that.
    const std::uint16_t load_cells = can_test::ours()[Role::load_cells].id;
    std::vector<Frame> received;
    for (const Frame& frame : Recording(c, true, 1, [](double, RigSample& sample) {
                                  sample.load_cells.longitudinal_N = 0.0F;
                                  sample.load_cells.brake_torque_Nm *= 0.8F;
                              }).frames) {
        const double t = 1e-9 * static_cast<double>((frame.received - Time{1'436'509'053'000'000'000}).count());
        if (frame.id != load_cells || t < 6.0 || t > 7.0) received.push_back(frame);
    }
    CHECK(measure(received).warns("energy_by_speeds"));
    CHECK_FALSE(measure(received).warns("energy_unbalanced"));
    CHECK(without_force(1.3F).warns("energy_unbalanced"));
}

TEST_CASE("torque over pressure that is no brake's friction is named with both numbers", "[BRG-261]") {
    ClosedForm c;
    rig::record::MeterParameters p = gated();
    p.friction = 0.26;  // 630 N m by 2 MPa through this brake
    const auto with_pressure = [&](float factor) {
        return measure(Recording(c, true, 1, [factor](double, RigSample& sample) { sample.pressure_Pa *= factor; }).frames, p);
    };
    for (const float sound : {0.6F, 1.0F, 2.0F}) CHECK(with_pressure(sound).warnings.empty());
    REQUIRE(with_pressure(0.1F).warnings.size() == 1);
    CHECK_THAT(with_pressure(0.1F).warnings[0],
               ContainsSubstring("friction_implausible: mean mu_b 2.62") && ContainsSubstring("by torque over pressure, 0.26 is the brake's"));
    CHECK(with_pressure(14.5F).warns("friction_implausible"));
    // Of a record that ends as the brake comes on: torque comes through the PLC, later than pressure.
    const auto ends_after = [&](double braking_s) {
        Recording recording(c, true, 1, [](double, RigSample& sample) { sample.load_cells.brake_torque_Nm = 20.0F; });
        const double share = (c.before_s + braking_s) / (c.rest_s() + 0.55);
        recording.frames.resize(static_cast<std::size_t>(share * static_cast<double>(recording.frames.size())));
        return measure(recording.frames, p);
    };
    CHECK_FALSE(ends_after(0.15).warns("friction_implausible"));
    CHECK(ends_after(0.5).warns("friction_implausible"));
}
