#include "rig_bridge/wear/wear_campaign.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "tests/catch.hpp"
#include "tests/wear/physical_campaign.hpp"

namespace {

using wear::parse_campaign;

std::string rejection(const std::string& csv) {
    try {
        (void)parse_campaign("data.csv", csv);
    } catch (const settings::Error& e) {
        return e.what();
    }
    return "accepted";
}

const std::string kHead = "maneuver,cumulative_energy_MJ,mean_friction\n";

}  // namespace

TEST_CASE("columns are found by name, in either unit, among others", "[WEAR-001]") {
    const wear::Campaign in_MJ =
        parse_campaign("a", "\xEF\xBB\xBFmean_friction, note ,cumulative_energy_MJ\r\n0.30,x,1.5\r\n\r\n# said\r\n0.25,,3\r\n");
    const wear::Campaign in_J = parse_campaign("b", "cumulative_energy_J,mean_friction\n1500000,0.3\n3e6,0.25");
    REQUIRE(in_MJ.points.size() == 2);
    CHECK(in_MJ.points == in_J.points);
    CHECK(in_J.points[0] == wear::Point{1.5e6, 0.3});
    CHECK(in_J.points[1] == wear::Point{3e6, 0.25});
    CHECK(wear::data_hash(in_MJ) == wear::data_hash(in_J));
    CHECK(wear::brake_energy_J(in_J, 0) == 1.5e6);
    CHECK(wear::brake_energy_J(in_J, 1) == 1.5e6);
}

TEST_CASE("a table that was written reads back to the last bit, and its hash tells data apart", "[WEAR-001]") {
    for (const physical::BrakeLaw& law : physical::laws()) {
        wear::Campaign campaign = physical::campaign(law, 7);
        const wear::Campaign back = parse_campaign("back", wear::to_csv(campaign));
        CHECK(back.points == campaign.points);
        CHECK(wear::to_csv(back) == wear::to_csv(campaign));
        const std::string hash = wear::data_hash(campaign);
        campaign.points[250].mean_friction = std::nextafter(campaign.points[250].mean_friction, 1.0);
        CHECK(wear::data_hash(campaign) != hash);
    }
}

TEST_CASE("a campaign says where it is from, or it is of unknown origin", "[WEAR-071]") {
    const std::string rows = kHead + "1,1,0.3\n2,2,0.29\n";
    CHECK(parse_campaign("data.csv", rows).origin == wear::kUnknownOrigin);
    const wear::Campaign measured = parse_campaign("data.csv", "# of March\n# origin: measured on rig 7\r\n" + rows);
    CHECK(measured.origin == "measured on rig 7");
    CHECK(parse_campaign("data.csv", wear::to_csv(measured)) == measured);
    CHECK(parse_campaign("data.csv", "\xEF\xBB\xBF" + wear::to_csv(measured)) == measured);
    CHECK(wear::data_hash(measured) == wear::data_hash(parse_campaign("data.csv", rows)));
    CHECK(rejection("# of March\n# origin: a friend\n" + rows) == "data.csv:2: origin: must begin with 'measured' or 'made up'");
}

TEST_CASE("readings of the lining stand where they were made", "[WEAR-074]") {
    const std::string head = "cumulative_energy_MJ,mean_friction,lining_worn\n";
    const wear::Campaign c = parse_campaign("data.csv", head + "1,0.3,\n2,0.29,0.31\n3,0.29,\n4,0.28,-0.02\n");
    CHECK(c.readings == std::vector<wear::LiningReading>{{2e6, 0.31}, {4e6, -0.02}});
    CHECK(parse_campaign("data.csv", wear::to_csv(c)) == c);
    wear::Campaign bare = c;
    bare.readings.clear();
    CHECK(wear::data_hash(bare) != wear::data_hash(c));
    CHECK(wear::to_csv(parse_campaign("data.csv", kHead + "1,1,0.3\n2,2,0.29\n")).find("lining") == std::string::npos);
    CHECK_THAT(rejection(head + "1,0.3,\n2,0.29,31\n"),
               ContainsSubstring("data.csv:3: lining_worn: 31 is no worn share") && ContainsSubstring("percent"));
    CHECK_THAT(rejection(head + "1,0.3,\n2,0.29,thin\n"), ContainsSubstring("data.csv:3: lining_worn: 'thin'"));
}

TEST_CASE("a reading that no maneuver ended with is kept, written, read back and hashed", "[WEAR-074]") {
    wear::Campaign c = parse_campaign("data.csv", "cumulative_energy_MJ,mean_friction,lining_worn\n1,0.3,\n2,0.29,0.31\n3,0.28,\n");
    const std::string before = wear::data_hash(c);
    c.readings.insert(c.readings.begin(), {0.5e6, 0.01});
    c.readings.push_back({2e6, 0.33});
    c.readings.push_back({3.5e6, 0.9});
    const wear::Campaign back = parse_campaign("data.csv", wear::to_csv(c));
    CHECK(back.points == c.points);
    CHECK(back.readings == c.readings);
    CHECK(back.source == "data.csv");
    CHECK(wear::to_csv(back) == wear::to_csv(c));
    CHECK(wear::data_hash(back) == wear::data_hash(c));
    const std::string hash = wear::data_hash(c);
    c.readings.pop_back();
    CHECK(wear::data_hash(c) != hash);
    CHECK(hash != before);
}

TEST_CASE("of a table with outcomes only finished maneuvers are points", "[WEAR-001]") {
    const std::string head = "number,outcome,cumulative_energy_J,mean_friction,brake_on_mps,mean_torque_Nm,mean_load_N,disc_serial,lining_worn\n";
    const wear::Campaign c = parse_campaign("data.csv", head +
                                                            "1,load_lost,0,nan,0,0,0,D7,\n"
                                                            "1,finished,1e6,0.31,54,630,23500,D7,\n"
                                                            "2,load_lost,1.4e6,0.05,54,0,23500,D7,0.1\n"
                                                            "2,finished,1.4e6,0.9,54,630,23500,D7,\n"
                                                            "2,finished,2.4e6,0.30,54,630,23500,D7,0.2\n"
                                                            "3,unfinished,3e6,0.30,54,630,23500,D7,0.3\n");
    CHECK(c.points == std::vector<wear::Point>{{1e6, 0.31}, {2.4e6, 0.30}});
    CHECK(c.brakings.size() == 2);
    CHECK(c.readings == std::vector<wear::LiningReading>{{1.4e6, 0.1}, {2.4e6, 0.2}, {3e6, 0.3}});
    CHECK(c.source == "data.csv (3 not finished left out) (1 that add no energy left out)");
    CHECK_THAT(rejection(head + "1,finished,1e6,0.31,54,630,23500,D7,\n2,aborted,9e5,0.3,0,0,0,D7,\n"),
               ContainsSubstring("data.csv:3: cumulative_energy: 900000 J after 1000000 J: energy cannot decrease"));
    CHECK_THAT(rejection(head + "1,finished,1e6,0.31,54,630,23500,D7,\n2,aborted,2e6,0.3,0,0,0,D8,\n"), ContainsSubstring("'D8' after 'D7'"));
    CHECK_THAT(rejection(head + "1,finished,1e6,0.31,54,630,23500,D7,\n2,aborted,2e12,0.3,0,0,0,D7,\n"), ContainsSubstring("data.csv:3:"));
    CHECK_THAT(rejection(head + "1,aborted,1e6,0.31,54,630,23500,D7,\n2,aborted,2e6,0.3,0,0,0,D7,\n"), ContainsSubstring("no maneuver"));
}

TEST_CASE("a landing has its own energy, whatever was taken between the rows", "[WEAR-001]") {
    const std::string head = "cumulative_energy_MJ,mean_friction,brake_energy_J,outcome\n";
    const wear::Campaign c =
        parse_campaign("c", head + "5,0.3,1e6,finished\n7,0.29,1.1e6,finished\n8,,1e6,out_of_tolerance\n8.5,,,aborted\n9.5,0.28,,finished\n");
    CHECK(c.landings == std::vector<wear::LandingEnergy>{{5e6, 1e6}, {7e6, 1.1e6}, {8e6, 1e6}, {9.5e6, 1e6}});
    CHECK(c.source == "c (1 not finished left out) (1 out of tolerance left out)");
    CHECK(wear::brake_energy_J(c, 1) == 1.1e6);
    CHECK(wear::taken_before_J(c) == 4e6);
    CHECK(wear::taken_now_J(c) == 9.5e6);
    CHECK(parse_campaign("c", wear::to_csv(c)).landings == c.landings);
    const std::string of_two = head + "5,0.3,1e6,finished\n";
    for (const char* const energy : {"1.01e6", "0", "-1", "nan"})
        CHECK_THAT(rejection(of_two + "6,0.29," + energy + ",finished\n"), ContainsSubstring("data.csv:3: brake_energy_J: "));
    CHECK(rejection(of_two + "6,0.29,1000100,finished\n") == "accepted");  // rounded
}

TEST_CASE("energy that was counted before the first maneuver is not that maneuver's", "[WEAR-001]") {
    const wear::Campaign c = parse_campaign("c", "cumulative_energy_MJ,mean_friction\n100,0.3\n101,0.29\n102,0.28\n");
    CHECK(std::isnan(wear::brake_energy_J(c, 0)));
    CHECK(wear::to_csv(c).find("\n1,0.3,,100000000\n") != std::string::npos);
}

TEST_CASE("bad data are refused with file and row", "[WEAR-001]") {
    CHECK(rejection("") == "data.csv: empty: no header and no maneuver");
    CHECK_THAT(rejection(kHead), ContainsSubstring("data.csv: no maneuver"));
    CHECK_THAT(rejection(kHead + "1,1,0.3\n"), ContainsSubstring("data.csv: one maneuver only"));
    CHECK_THAT(rejection(kHead + "1,1,0.3\n2,2,nan\n"), ContainsSubstring("data.csv:3: mean_friction: 'nan' is no finite"));
    CHECK_THAT(rejection(kHead + "1,1,0.3\n2,inf,0.3\n"), ContainsSubstring("data.csv:3: cumulative_energy_MJ: 'inf'"));
    CHECK_THAT(rejection(kHead + "1,1,0.3\n2,,0.3\n"), ContainsSubstring("data.csv:3: cumulative_energy_MJ: no value"));
    CHECK_THAT(rejection(kHead + "1,1,0.3\n2,2 MJ,0.3\n"), ContainsSubstring("data.csv:3: cumulative_energy_MJ: '2 MJ'"));
    CHECK_THAT(rejection(kHead + "1,-1,0.3\n2,2,0.3\n"), ContainsSubstring("data.csv:2: cumulative_energy: -1000000 J"));
    CHECK_THAT(rejection(kHead + "1,1,0.3\n2,2,0.29\n3,2,0.28\n"), ContainsSubstring("data.csv:4: cumulative_energy: 2000000 J after 2000000 J"));
    CHECK_THAT(rejection(kHead + "1,1,0.3\n2,1,0.3\n3,1,0.3\n"), ContainsSubstring("data.csv:3: cumulative_energy: 1000000 J after"));
    CHECK_THAT(rejection(kHead + "1,1,0.3\n2,2,0.3\n3,3,0.3\n"), ContainsSubstring("0.3 in all 3 maneuvers"));
    CHECK_THAT(rejection(kHead + "1,1,0.3\n2,2,30\n"), ContainsSubstring("data.csv:3: mean_friction: 30 is no friction coefficient"));
    CHECK_THAT(rejection(kHead + "1,1,0.3\n2,2,0\n"), ContainsSubstring("data.csv:3: mean_friction: 0 is no"));
    CHECK_THAT(rejection(kHead + "1,1,0.3\n2,2,0.3,4\n"), ContainsSubstring("data.csv:3: 4 fields, but the header names 3"));
}

TEST_CASE("units that are mixed up are refused", "[WEAR-001]") {
    // J under the name of MJ, MJ under the name of J, and one row in the other unit.
    CHECK_THAT(rejection(kHead + "1,975000,0.3\n2,1950000,0.29\n"),
               ContainsSubstring("data.csv:3: cumulative_energy: 975000000000 J in one maneuver"));
    CHECK_THAT(rejection("cumulative_energy_J,mean_friction\n0.975,0.3\n1.95,0.29\n"), ContainsSubstring("0.975 J a maneuver on average"));
    CHECK_THAT(rejection(kHead + "1,1,0.3\n2,2,0.29\n3,3000000,0.28\n"), ContainsSubstring("data.csv:4: cumulative_energy"));
    CHECK_THAT(rejection("cumulative_energy_J,mean_friction\n1e6,0.3\n2e6,0.29\n3,0.28\n"),
               ContainsSubstring("data.csv:4: cumulative_energy: 3 J after"));
    // A unit that is not known, none at all, two at once, a name twice.
    CHECK_THAT(rejection("cumulative_energy_kWh,mean_friction\n1,0.3\n2,0.2\n"),
               ContainsSubstring("data.csv:1: 'cumulative_energy_kWh' is in another unit"));
    CHECK_THAT(rejection("cumulative_energy,mean_friction\n1,0.3\n2,0.2\n"), ContainsSubstring("wanted is cumulative_energy_MJ"));
    CHECK_THAT(rejection("cumulative_energy_MJ,cumulative_energy_J,mean_friction\n1,1e6,0.3\n"), ContainsSubstring("energy stands in two units"));
    CHECK_THAT(rejection("cumulative_energy_MJ,mean_friction,mean_friction\n1,1,0.3\n"), ContainsSubstring("two columns of this name"));
    CHECK_THAT(rejection("cumulative_energy_MJ,mean_fricton\n1,0.3\n"), ContainsSubstring("is 'mean_fricton' meant"));
    CHECK_THAT(rejection("cumulative_energy_MJ;mean_friction\n1;0.3\n"), ContainsSubstring("separated by commas"));
}

TEST_CASE("speed, torque and load of each maneuver are read where all three stand, and written back exactly", "[WEAR-001]") {
    const std::string head = "cumulative_energy_MJ,mean_friction,mean_load_N,brake_on_mps";
    const wear::Campaign c = parse_campaign("a", head + ",mean_torque_Nm\n1,0.3,23500.1,54.9,630.4\n2,0.29,23600,54.7,629\n");
    REQUIRE(c.brakings.size() == 2);
    CHECK(c.brakings[0] == wear::Braking{54.9, 630.4, 23500.1});
    CHECK(c.brakings[1] == wear::Braking{54.7, 629.0, 23600.0});
    const wear::Campaign back = parse_campaign("a", wear::to_csv(c));
    CHECK(back == c);
    // Two of three are no braking; the points, and their hash, are the same.
    const wear::Campaign two = parse_campaign("a", head + "\n1,0.3,23500.1,54.9\n2,0.29,23600,54.7\n");
    CHECK(two.brakings.empty());
    CHECK(wear::data_hash(two) == wear::data_hash(c));
    CHECK_THAT(rejection(head + ",mean_torque_Nm\n1,0.3,23500,54.9,630\n2,0.29,23600,54.7,-629\n"),
               ContainsSubstring("data.csv:3: mean_torque_Nm: -629 must be positive"));
    CHECK_THAT(rejection(head + ",mean_torque_Nm\n1,0.3,,54.9,630\n2,0.29,23600,54.7,629\n"), ContainsSubstring("data.csv:2: mean_load_N: no value"));
}

TEST_CASE("serial numbers are kept, and wear of two discs is no campaign", "[WEAR-001]") {
    const std::string head = "disc_serial,cumulative_energy_J,mean_friction,notes\n";
    const wear::Campaign one = wear::parse_campaign("a.csv", head + "\"D,\"\"7\"\"\",1e6,0.31,\"new, \"\"b\"\"\"\n\"D,\"\"7\"\"\",2e6,0.30,\n");
    CHECK(one.disc == "D,\"7\"");
    CHECK(one.brake.empty());
    CHECK(wear::parse_campaign("a.csv", wear::to_csv(one)) == one);
    CHECK(wear::data_hash(one) == wear::data_hash({one.source, one.points}));
    CHECK_THROWS_WITH(wear::parse_campaign("a.csv", head + "D7,1e6,0.31,\nD8,2e6,0.30,\n"),
                      ContainsSubstring("a.csv:3: disc_serial: 'D8' after 'D7': their wear is not mixed"));
}
