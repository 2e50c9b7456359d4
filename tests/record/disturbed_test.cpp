// Landings on a disturbed bus: the length of summary.json is that of somebody who only counts edges in what came through.
#include <algorithm>
#include <numbers>
#include <optional>
#include <random>

#include "rig_bridge/record/bus_meter.hpp"
#include "tests/catch.hpp"
#include "tests/record/closed_form.hpp"

using namespace record_test;
using antiskid::can::Role;

namespace {

constexpr double kPitch_m = 2.0 * std::numbers::pi / 60.0 * kRig.flywheel_radius_m;

/// As netem does, each frame by itself: shares that are lost, said twice, and late by up to `late_ms`, so that others overtake them.
struct Disturbance {
    double lost = 0.0;
    double twice = 0.0;
    double late = 0.0;
    double late_ms = 0.0;
};

std::vector<Frame> through(const std::vector<Frame>& sent, const Disturbance& d, unsigned seed) {
    constexpr std::int64_t kFrom_ns = 500'000'000;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> draw(0.0, 1.0);
    std::vector<Frame> received;
    for (Frame frame : sent) {
        const bool on = (frame.received - sent.front().received).count() > kFrom_ns;
        if (on && draw(random) < d.lost) continue;
        const Time stamp = frame.received;
        for (int copies = on && draw(random) < d.twice ? 2 : 1; copies > 0; --copies) {
            const bool late = on && draw(random) < d.late;
            frame.received = stamp + Time{late ? std::llround(draw(random) * d.late_ms * 1e6) : 0};
            received.push_back(frame);
        }
    }
    std::stable_sort(received.begin(), received.end(), [](const Frame& a, const Frame& b) { return a.received < b.received; });
    return received;
}

/// Counts the rim's edges from a frame on: no clock, no SYNC, no gate.
class Listener {
  public:
    void hear(const Frame& frame) {
        const antiskid::can::Layout& layout = can_test::ours();
        const antiskid::can::Payload payload(frame.data);
        if (frame.id == layout[Role::maneuver_state].id) braking_ = braking_ || payload.read(layout.maneuver_state.phase) == 4;
        if (frame.id != layout[Role::flywheel].id) return;
        const auto edges = static_cast<std::uint16_t>(payload.read(layout.flywheel.edge_count));
        if (edges_ && braking_) length_m_ += kPitch_m * static_cast<std::int16_t>(static_cast<std::uint16_t>(edges - *edges_));
        edges_ = edges;
    }
    [[nodiscard]] double length_m() const { return length_m_; }

  private:
    bool braking_ = false;
    std::optional<std::uint16_t> edges_;
    double length_m_ = 0.0;
};

ClosedForm landing() {
    ClosedForm c;
    c.v0_mps = 25.0;
    c.a1_mps2 = c.a2_mps2 = 8.1;
    c.before_s = 1.0;
    return c;
}

/// The greatest difference of summary and listener over so many landings.
double worst_m(const Disturbance& disturbance) {
    ClosedForm c = landing();
    double worst = 0.0;
    for (unsigned seed = 1; seed <= 20; ++seed) {
        c.tooth = seed / 21.0;
        rig::record::BusMeter meter(can_test::ours(), gated());
        Listener listener;
        for (const Frame& frame : through(Recording(c, true, seed).frames, disturbance, seed)) {
            meter.accept(frame);
            listener.hear(frame);
        }
        CHECK(meter.figures().standstill);
        worst = std::max(worst, std::abs(meter.figures().length_m - listener.length_m()));
    }
    return worst;
}

}  // namespace

TEST_CASE("frames that are lost, doubled or overtaken leave the length within 0.16 m of a listener's", "[BRG-200][figures]") {
    for (const Disturbance& d : {Disturbance{}, Disturbance{.lost = 0.001}, Disturbance{.lost = 0.01}, Disturbance{.lost = 0.05},
                                 Disturbance{.twice = 0.2}, Disturbance{.late = 0.01, .late_ms = 2.0}, Disturbance{.late = 0.1, .late_ms = 2.0},
                                 Disturbance{.lost = 0.005, .twice = 0.005, .late = 1.0, .late_ms = 2.0}}) {
        CAPTURE(d.lost, d.twice, d.late, d.late_ms);
        CHECK(worst_m(d) < 2.5 * kPitch_m);
    }
}

TEST_CASE("frames that come up to 60 ms late and out of order are no restart of an encoder, and no motion twice", "[BRG-200]") {
    constexpr double kLate_ms = 60.0;
    const ClosedForm c;
    const double brake_J = c.torque_Nm * (1.0 - c.slip) / c.radius_m() * c.length_m();
    for (const bool sync : {true, false}) {
        for (unsigned seed = 1; seed <= 3; ++seed) {
            CAPTURE(sync, seed);
            rig::record::BusMeter meter(can_test::ours(), gated());
            for (const Frame& frame : through(Recording(c, sync, seed).frames, {.late = 1.0, .late_ms = kLate_ms}, seed)) meter.accept(frame);
            CHECK_THAT(meter.warnings().at(0), Catch::Matchers::StartsWith("energy_by_speeds"));
            CHECK(meter.warnings().size() == 1);
            CHECK(meter.figures().energy_brake_J == Approx(brake_J).epsilon(sync ? 0.02 : 0.01));
            // Of SYNC numbers in such disorder few go on from the one before: its time comes in leaps.
            if (!sync) CHECK(meter.figures().length_m == Approx(c.length_m()).margin(1e-3 * kLate_ms * c.v0_mps));
        }
    }
}

TEST_CASE("a report that brings its edge late is no slower shaft, reports without one are", "[BRG-200]") {
    constexpr double kEdges_hz = 970.0;
    const double late_s = GENERATE(0.0, 0.0011, 0.005, 0.018);
    CAPTURE(late_s);
    rig::record::EdgeTrack track(1.0, {.edges_per_s = 3000.0, .late_s = 0.02});
    std::uint32_t edges = 0;
    double t = 0.0;
    const auto report = [&](double delay_s) {
        const auto stamp = Time{static_cast<std::int64_t>(edges / kEdges_hz * 1e9)};
        track.update(edges, stamp, t + delay_s);
    };
    for (int i = 0; i < 500; ++i) {
        t += 1e-3;
        edges = static_cast<std::uint32_t>(t * kEdges_hz);
        report(0.0);
    }
    edges += 1;
    t = edges / kEdges_hz + 1e-4;
    report(late_s);
    CHECK(track.speed(0.03) == Approx(kEdges_hz).epsilon(1e-6));
    // Nor is one without an edge, of which there are 30 a second at this speed.
    rig::record::EdgeTrack other = track;
    other.update(edges, Time{static_cast<std::int64_t>(edges / kEdges_hz * 1e9)}, t + late_s + 1.06e-3);
    CHECK(other.speed(0.03) == Approx(kEdges_hz).epsilon(1e-6));
    // No edge for 20 ms: it turns by less than one pitch in that time.
    for (int i = 0; i < 20; ++i) {
        t += 1e-3;
        report(late_s);
    }
    CHECK(track.speed(0.03) == Approx(1.0 / 0.02).epsilon(0.01));
}
