#include "plant_sim/wear/brake_state.hpp"

#include <string>

#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"
#include "tests/wear/shipped_wear.hpp"

namespace {

const wear::BrakeState kState{0xFFFF'FFFF'FFFF'FFFFU, 137, 133.123456789012345e6 / 3.0};

std::string rejection_of_brake(const std::string& json, const wear::BrakeWear& wear = shipped_wear()) {
    return rejection_of([&] { return wear::brake_state_from_json("brake.json", json, wear); }).what();
}

}  // namespace

TEST_CASE("a kept brake comes back to the last bit, and there is none where there is no file", "[WEAR-011]") {
    const TemporaryDirectory directory;
    CHECK(wear::find_brake_state(directory / "brake.json", shipped_wear()) == std::nullopt);
    wear::write_brake_state(directory / "brake.json", kState, shipped_wear());
    CHECK(wear::find_brake_state(directory / "brake.json", shipped_wear()) == kState);
    CHECK_THROWS_AS(wear::write_brake_state(directory.path(), kState, shipped_wear()), settings::Error);
    CHECK_THROWS_AS(wear::find_brake_state(directory.path(), shipped_wear()), settings::Error);
}

TEST_CASE("every byte of a kept brake that is damaged is noticed", "[WEAR-011]") {
    const std::string json = wear::to_json(kState, shipped_wear());
    for (std::size_t i = 0; i < json.size(); ++i) {
        CAPTURE(i, json.substr(0, i));
        std::string damaged = json;
        damaged[i] = damaged[i] == '1' ? '2' : '1';
        if (json[i] == ' ' || json[i] == '\n') continue;  // between the values: may be anything blank
        try {
            (void)wear::brake_state_from_json("brake.json", damaged, shipped_wear());
            FAIL_CHECK("not noticed");
        } catch (const settings::Error& error) {
            CHECK(error.file() == "brake.json");
        }
        CHECK_THROWS_AS(wear::brake_state_from_json("brake.json", json.substr(0, i), shipped_wear()), settings::Error);
    }
}

TEST_CASE("a kept brake says what is wrong with it", "[WEAR-011]") {
    const std::string json = wear::to_json(kState, shipped_wear());
    CHECK_THAT(rejection_of_brake(""), ContainsSubstring("brake.json: no JSON"));
    CHECK_THAT(rejection_of_brake("1e999"), ContainsSubstring("brake.json: no JSON") && ContainsSubstring("1e999"));
    CHECK_THAT(rejection_of_brake("[]"), ContainsSubstring("must be an object"));
    CHECK_THAT(rejection_of_brake(replaced(json, "\"format_version\": 1", "\"format_version\": 2")),
               ContainsSubstring("format_version: 2 is not the version"));
    CHECK_THAT(rejection_of_brake(replaced(json, "brake state", "wear model")), ContainsSubstring("format: must be"));
    CHECK_THAT(rejection_of_brake(replaced(json, "\"maneuvers\": 137", "\"maneuvers\": 138")), ContainsSubstring("check_sum: does not fit"));
    CHECK_THAT(rejection_of_brake(replaced(json, "\"maneuvers\": 137", "\"maneuvers\": -1")), ContainsSubstring("maneuvers: must be an integer"));
    CHECK_THAT(rejection_of_brake(replaced(json, "\"seed\"", "\"sead\"")), ContainsSubstring("seed: is missing"));
    CHECK_THAT(rejection_of_brake(json, shipped_wear({.energy = 8.0})),
               ContainsSubstring("wear_hash: this brake was kept with another wear model, law or scale"));
    wear::BrakeWear other = shipped_wear();
    wear::Model model = *other.model;
    model.data.maneuvers = 499;
    other.model = std::make_shared<const wear::Model>(model);
    CHECK_THAT(rejection_of_brake(json, other), ContainsSubstring("another wear model, law or scale"));
}
