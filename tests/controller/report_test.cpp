#include "firmware/controller/report.hpp"

#include "firmware/host/settings/json.hpp"
#include "tests/catch.hpp"
#include "tests/host/loop_bench.hpp"

using namespace host_test;

namespace {

controller::RunReport report_of(const LoopBench& bench) {
    return {.interface = "vcan0",
            .clock = "timer",
            .config_hash = bench.setup.config_hash,
            .period = bench.setup.period,
            .records_lost = bench.session->ring().dropped(),
            .link = bench.bus.status(),
            .layout = bench.setup.layout,
            .port = bench.session->port(),
            .loop = bench.statistics()};
}

}  // namespace

TEST_CASE("the report says what happened", "[RT-073]") {
    LoopBench bench(controller::ClockSource::timer);
    bench.run_timer(1000, [&](const int period) {
        bench.rig_period(at_rest());
        if (period == 300) bench.rig_end.send({.id = 0x7AB, .length = 1, .data = {}, .received = {}});
        if (period >= 400 && period < 410) {
            can::Frame broken = bench.rig.pressure(0.0F);
            broken.data[0] ^= 0x10U;
            bench.rig_end.send(broken);
        }
        if (period == 500) bench.clock.advance(3500us);
        if (period == 600) bench.rig_end.send(bench.rig.emergency_stop());
    });
    const auto json = settings::parse_json(controller::json(report_of(bench)));
    CHECK(json["version"] == ANTISKID_VERSION);
    CHECK(json["config_hash"].get<std::string>().size() == 32);
    CHECK(json["period_ns"] == 1'000'000);
    CHECK(json["steps"] == 1000);
    CHECK(json["overruns"] == 1);
    CHECK(json["missed_periods"] == 2);
    CHECK(json["safe_commands_sent"] == 3);
    CHECK(json["durations"]["latency"]["max_ns"] == 2'500'000);
    CHECK(json["durations"]["overrun"]["count"] == 1);
    CHECK(json["durations"]["period"]["p50_ns"] >= 1'000'000);
    CHECK(json["durations"]["period"]["p50_ns"] <= 1'016'000);
    CHECK(json["link"]["unknown_ids"] == 1 + 100);  // and the load cells, which are not for the controller
    CHECK(json["link"]["frames_received"] == bench.statistics().frames_received);
    CHECK(json["messages"]["pressure"]["accepted"] == 1000);
    CHECK(json["messages"]["pressure"]["wrong_crc"] == 10);
    CHECK(json["messages"]["emergency_stop"]["accepted"] == 1);
    REQUIRE(json["faults"].size() == 1);
    CHECK(json["faults"][0]["name"] == "emergency_stop");
    CHECK(json["steps_in_state"]["self_test"].get<int>() > 0);

    const std::string table = controller::table(report_of(bench));
    for (const char* part : {"1000 steps of 1000 us on vcan0 by timer", "pressure                1000        10", "overruns: 1 (2 periods missed)",
                             "faults: emergency_stop"})
        CHECK_THAT(table, ContainsSubstring(part));
}

TEST_CASE("a report of nothing is a report", "[RT-073]") {
    LoopBench bench(controller::ClockSource::sync);
    bench.stop = true;
    bench.run();
    const auto json = settings::parse_json(controller::json(report_of(bench)));
    CHECK(json["steps"] == 0);
    CHECK(json["faults"].empty());
    CHECK_THAT(controller::table(report_of(bench)), ContainsSubstring("faults: none"));
}
