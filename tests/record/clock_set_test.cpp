// The wall clock is set while a landing without SYNC is recorded: its stamps are all the time that there is. What vcan.energy_clock_timer shows
// with real clocks, where a machine keeps real time; here with clocks that are handed in, in every phase.
#include "firmware/can/wall_clock_offset.hpp"
#include "rig_bridge/record/bus_meter.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/stamp_label.hpp"
#include "tests/catch.hpp"
#include "tests/record/closed_form.hpp"

using namespace record_test;
using namespace std::chrono_literals;

namespace {

/// Both clocks of a machine; the wall clock is set once.
struct Clocks {
    Time set_at{};  ///< by the monotonic clock
    Time by{};
    Time now{};

    [[nodiscard]] Time offset(Time monotonic) const {
        constexpr Time kEpoch{1'436'000'000'000'000'000};
        return kEpoch + (monotonic < set_at ? Time{} : by);
    }
};

/// As the recorder does it: batches of what came in 2 ms, stamped by the kernel's wall clock when it came, mapped and labelled when read.
std::vector<Frame> recorded(const std::vector<Frame>& sent, Time set_at, Time by) {
    constexpr Time kLook = 2ms;
    const Time first = sent.front().received;
    Clocks clocks{.set_at = set_at, .by = by, .now = {}};
    antiskid::can::WallClockOffset stamps([&] { return antiskid::can::ClockReading{clocks.offset(clocks.now), clocks.now}; });
    rig::record::StampLabel label(clocks.offset(Time{}));
    std::vector<Frame> record;
    Time read{};
    for (Frame frame : sent) {
        const Time came = frame.received - first;
        if (came > read) {
            read = (came / kLook + 1) * kLook;
            clocks.now = read;
            stamps.next_batch();
        }
        const Time stamp = came + clocks.offset(came);
        frame.received = label.of(stamp, stamps.monotonic(stamp));
        record.push_back(frame);
    }
    return record;
}

rig::record::Figures figures(const std::vector<Frame>& record) {
    rig::record::BusMeter meter(can_test::ours(), kRig);
    for (const Frame& frame : record) meter.accept(frame);
    CHECK(meter.steps_back() == 0);
    CHECK(meter.warnings().empty());
    return meter.figures();
}

}  // namespace

TEST_CASE("a wall clock that is set, in any phase, forward or back, changes no figure of a landing", "[BRG-200]") {
    const ClosedForm c;
    const std::vector<Frame> sent = Recording(c, false).frames;
    const rig::record::Figures sound = figures(recorded(sent, 1h, Time{}));
    CHECK(sound.length_m == Approx(c.length_m()).margin(0.1));
    CHECK(sound.duration_s == Approx(c.duration_s()).margin(0.02));
    const double rest_s = c.rest_s();
    for (const double at_s : {0.5, 1.9995, 2.0, 2.3, 0.5 * rest_s, rest_s - 0.2, rest_s, rest_s + 0.1}) {
        for (const Time by : {Time{1s}, Time{1h}, Time{-1s}, Time{-1h}}) {
            CAPTURE(at_s, by.count());
            const rig::record::Figures set = figures(recorded(sent, Time{std::llround(at_s * 1e9)}, by));
            for (const rig::record::FigureField& field : rig::record::kFigureFields)
                CHECK(set.*field.value == Approx(sound.*field.value).epsilon(1e-4).margin(1e-9));
        }
    }
}

TEST_CASE("stamps of a record do not go back where the clock was set and set back before anybody looked", "[BRG-200]") {
    constexpr Time kOffset{1'436'000'000'000'000'000};
    rig::record::StampLabel label(kOffset);
    CHECK(label.of(1ms + kOffset, 1ms) == 1ms + kOffset);
    CHECK(label.of(2ms + kOffset + 1h, 100ms) == 100ms + kOffset);  // all that is known: it came before it was read
    CHECK(label.of(3ms + kOffset, 3ms) == 100ms + kOffset);
    CHECK(label.of(101ms + kOffset, 101ms) == 101ms + kOffset);
}
