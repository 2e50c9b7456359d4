#include "rig_bridge/bridge/campaign_rules.hpp"

#include "tests/catch.hpp"

using rig::bridge::CampaignJudge;
using rig::bridge::CampaignState;

namespace {

rig::record::Summary summary(std::int64_t number, const std::string& outcome, double friction = 0.3) {
    rig::record::Summary s;
    s.number = number;
    s.outcome = outcome;
    s.figures.mean_friction = friction;
    return s;
}

}  // namespace

TEST_CASE("A finished maneuver is followed by the next", "[BRG-410]") {
    CampaignJudge judge({.maneuvers = 500});
    for (int i = 1; i <= 500; ++i) CHECK(judge.after(summary(i, "finished", 0.0)).verdict == CampaignState::go_on);
}

TEST_CASE("An aborted maneuver stops the campaign and is named", "[BRG-410]") {
    CampaignJudge judge({.maneuvers = 500});
    const rig::bridge::Decision decision = judge.after(summary(7, "plc_silent"));
    CHECK(decision.verdict == CampaignState::fault);
    CHECK(decision.reason == "maneuver 7 was aborted: plc_silent");
}

TEST_CASE("Retries are counted for one maneuver, in a row", "[BRG-410]") {
    CampaignJudge judge({.maneuvers = 500, .retries = 2});
    CHECK(judge.after(summary(7, "plc_silent")).verdict == CampaignState::go_on);
    CHECK(judge.after(summary(7, "load_lost")).verdict == CampaignState::go_on);
    CHECK(judge.after(summary(7, "finished")).verdict == CampaignState::go_on);
    CHECK(judge.after(summary(8, "plc_silent")).verdict == CampaignState::go_on);
    CHECK(judge.after(summary(8, "plc_silent")).verdict == CampaignState::go_on);
    CHECK(judge.after(summary(9, "plc_silent")).verdict == CampaignState::go_on);
    CHECK(judge.after(summary(9, "plc_silent")).verdict == CampaignState::go_on);
    const rig::bridge::Decision decision = judge.after(summary(9, "plc_silent"));
    CHECK(decision.verdict == CampaignState::fault);
    CHECK_THAT(decision.reason, ContainsSubstring("2 retries did not help"));
}

TEST_CASE("What a person stopped is never started again by itself", "[BRG-410]") {
    for (const char* const outcome : {"emergency_stop", "guard_open", "requested", "foreign_command", "overspeed", "speed_mismatch", "two_senders"}) {
        CampaignJudge judge({.maneuvers = 500, .retries = 100});
        const rig::bridge::Decision decision = judge.after(summary(7, outcome));
        CHECK(decision.verdict == CampaignState::fault);
        CHECK_THAT(decision.reason, ContainsSubstring(outcome));
    }
}

TEST_CASE("The wear limit ends the campaign, also when the limit was reached in an earlier session", "[BRG-410]") {
    CampaignJudge judge({.maneuvers = 500, .retries = 0, .min_friction = 0.15});
    CHECK(judge.after(summary(1, "finished", 0.15)).verdict == CampaignState::go_on);
    const rig::bridge::Decision decision = judge.after(summary(2, "finished", 0.1499));
    CHECK(decision.verdict == CampaignState::worn);
    CHECK(decision.reason == "maneuver 2: mean friction 0.1499 is below the wear limit 0.1500");
    CHECK(judge.before(summary(2, "finished", 0.1499)).verdict == CampaignState::worn);
    CHECK(judge.before(summary(2, "finished", 0.2)).verdict == CampaignState::go_on);
    // One that was not the maneuver asked for says nothing about wear, nor does an aborted one.
    rig::record::Summary off = summary(3, "finished", 0.1);
    off.out_of_tolerance = std::vector<std::string>{"mean_load_N"};
    CHECK(judge.after(off).verdict == CampaignState::go_on);
    CHECK(judge.after(summary(3, "plc_silent", 0.0)).verdict == CampaignState::fault);
}

TEST_CASE("Time left follows the newest maneuvers", "[BRG-420]") {
    rig::bridge::Pace pace;
    CHECK_FALSE(pace.left_s(10).has_value());
    pace.add(10.0);
    pace.add(20.0);
    CHECK(pace.left_s(10).value() == Approx(150.0));
    for (int i = 0; i < 20; ++i) pace.add(5.0);
    CHECK(pace.left_s(10).value() == Approx(50.0));
    CHECK(pace.left_s(0).value() == 0.0);
}

TEST_CASE("An abnormal brake stops the campaign where that is asked for, also when it was found before a resume", "[BRG-500]") {
    const rig::record::Health abnormal{rig::record::HealthState::abnormal, 1.2, "friction has dropped", "f00d"};
    const rig::record::Health suspect{rig::record::HealthState::suspect, 0.8, "friction has dropped", "f00d"};
    CampaignJudge judge({.maneuvers = 500, .stop_on_abnormal = true});
    CHECK(judge.after(summary(6, "finished"), suspect).verdict == CampaignState::go_on);
    const rig::bridge::Decision decision = judge.after(summary(7, "finished"), abnormal);
    CHECK(decision.verdict == CampaignState::abnormal);
    CHECK(decision.reason == "maneuver 7: the brake is abnormal: friction has dropped");
    CHECK(judge.before(summary(7, "finished"), abnormal).verdict == CampaignState::abnormal);
    CampaignJudge lenient({.maneuvers = 500});
    CHECK(lenient.after(summary(7, "finished"), abnormal).verdict == CampaignState::go_on);
}
