// When a maneuver begins, and what of it is recorded.
#include "rig_bridge/bridge/maneuver_run.hpp"

#include <memory>

#include "tests/bridge/fakes.hpp"
#include "tests/catch.hpp"

using namespace bridge_test;
using rig::Phase;
using rig::bridge::ManeuverRun;
using rig::bridge::Moment;

namespace {

/// What one cannot read from SampleLog: its rows, and a disk that is full after some.
class Rows final : public rig::record::LineFile {
  public:
    explicit Rows(std::uint64_t room) : room_(room) {}
    void line(std::string_view) override { ++lines_; }
    void flush() override {}
    bool finish() override { return missing() == 0; }
    [[nodiscard]] std::uint64_t lines() const override { return lines_; }
    [[nodiscard]] std::uint64_t missing() const override { return lines_ > room_ ? lines_ - room_ : 0; }
    [[nodiscard]] std::string error() const override { return missing() == 0 ? "" : "modbus.csv: No space left on device"; }

  private:
    std::uint64_t room_, lines_ = 0;
};

rig::Plan cooling() {
    rig::Plan plan;
    plan.speed_mps = 50.0;
    plan.load_base_N = 40e3;
    plan.demand_Pa = 20e6;
    plan.slip_reference = 0.2;
    plan.cool_to_C = 100.0;
    plan.brake_on_limit_C = 150.0;
    plan.cool_down_limit_s = 60.0;
    return plan;
}

Moment moment_at(double rig_s, bool plc_fresh = true, double brake_C = 20.0) {
    Moment moment;
    moment.rig_s = rig_s;
    moment.inputs.plc_fresh = plc_fresh;
    moment.inputs.brake_temperature_C = brake_C;
    return moment;
}

}  // namespace

TEST_CASE("a maneuver waits for the controller to know the bridge, for a cold brake and for the PLC, none of them for ever", "[BRG-100]") {
    const ManeuverRun run(cooling(), 10.0);
    CHECK_FALSE(run.ready(moment_at(10.49)));
    CHECK(run.ready(moment_at(10.51)));
    CHECK(run.waits_for(moment_at(10.2)).empty());
    CHECK_FALSE(run.ready(moment_at(12.9, false)));
    CHECK(run.waits_for(moment_at(12.9, false)) == "waits for the PLC");
    CHECK(run.ready(moment_at(13.1, false)));
    CHECK_FALSE(run.ready(moment_at(60.0, true, 120.0)));
    CHECK(run.waits_for(moment_at(60.0, true, 120.0)) == "waits for the brake to cool");
    CHECK(run.ready(moment_at(70.1, true, 120.0)));
}

TEST_CASE("a record has each reading of the PLC once, and ends 16 steps after the sequence", "[BRG-100]") {
    ManeuverRun run(cooling(), 0.0);
    CHECK(run.sequencer() == nullptr);
    CHECK_FALSE(run.recording());
    run.begin();
    rig::record::SampleLog samples(std::make_unique<Rows>(1000));
    Moment moment = moment_at(1.0);
    moment.outputs.phase = Phase::braking;
    for (std::uint64_t step = 0; step < 30; ++step) {
        moment.plc.counters.polls = 1 + step / 3;
        CHECK_FALSE(run.follow(moment, 1s, samples));
    }
    CHECK(samples.rows() == 10);
    moment.outputs.phase = Phase::aborted;
    for (int step = 1; step < 16; ++step) CHECK_FALSE(run.follow(moment, 1s, samples));
    CHECK(run.recording());
    CHECK(run.follow(moment, 1s, samples));
    CHECK_FALSE(run.recording());
    moment.plc.counters.polls = 99;
    CHECK_FALSE(run.follow(moment, 1s, samples));
    CHECK(samples.rows() == 10);
    CHECK(run.record_error().empty());
}

TEST_CASE("a record that the disk does not take is named by the first cause", "[BRG-210]") {
    for (const bool of_bus : {true, false}) {
        ManeuverRun run(cooling(), 0.0);
        run.begin();
        rig::record::SampleLog samples(std::make_unique<Rows>(of_bus ? 1000 : 1));
        Moment moment = moment_at(1.0);
        moment.plc.counters.polls = 1;
        if (of_bus) {
            moment.bus.missing = 3;
            moment.bus.recording_error = "bus.log: Input/output error";
        }
        (void)run.follow(moment, 1s, samples);
        CHECK(run.record_error() == (of_bus ? "bus.log: Input/output error" : "modbus.csv: No space left on device"));
    }
}
