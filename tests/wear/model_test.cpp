#include "rig_bridge/wear/model.hpp"

#include <string>

#include "rig_bridge/wear/model_io.hpp"
#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"
#include "tests/wear/physical_campaign.hpp"

namespace {

wear::Model some_model() {
    static const wear::Model model = [] {
        const wear::Campaign campaign = physical::campaign({}, 11);
        wear::FitSettings settings;
        settings.max_components = 4;
        settings.starts = 5;
        settings.seed = 18446744073709551615ULL;
        return wear::model_of(campaign, wear::fit(campaign, settings), settings);
    }();
    return model;
}

std::string model_rejection(const std::string& json) {
    try {
        (void)wear::from_json("model.json", json);
    } catch (const settings::Error& e) {
        return e.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("a model file gives back the model to the last bit", "[WEAR-011]") {
    const wear::Model model = some_model();
    const std::string json = wear::to_json(model);
    CHECK(wear::from_json("m", json) == model);
    CHECK(wear::to_json(wear::from_json("m", json)) == json);
    CHECK(model.data.hash == wear::data_hash(physical::campaign({}, 11)));
    CHECK(model.data.maneuvers == 500);
    CHECK(model.orders.size() == 4);
}

TEST_CASE("a model says what it was learnt from; one of before that could be said is of unknown origin", "[WEAR-071]") {
    const std::string json = wear::to_json(some_model());
    const std::string says = ",\n    \"origin\": \"made up by the law of tests/wear/physical_campaign.hpp\"";
    CHECK(wear::from_json("m", json).data.origin == physical::campaign({}, 11).origin);
    const std::string old = replaced(replaced(json, says, ""), "\"format_version\": 2", "\"format_version\": 1");
    CHECK(wear::from_json("m", old).data.origin == wear::kUnknownOrigin);
    CHECK_THAT(model_rejection(replaced(json, says, "")), ContainsSubstring("data.origin: is missing"));
    CHECK_THAT(model_rejection(replaced(json, "made up by", "by")), ContainsSubstring("data.origin: must begin with 'measured' or 'made up'"));
    CHECK(wear::Provenance{"measured on rig 7", 12}.sentence() == "measured on rig 7, 12 lives");
    CHECK(wear::Provenance{}.sentence() == "of unknown origin, 1 life");
    CHECK(wear::common_origin({"measured", "measured"}) == "measured");
    CHECK(wear::common_origin({"measured", wear::kUnknownOrigin}) == wear::kUnknownOrigin);
    CHECK(wear::common_origin({"measured", "made up"}) == "made up (1 of 2 lives; others are of other origin)");
}

TEST_CASE("a model file that is none is refused, naming file and key", "[WEAR-011]") {
    const std::string json = wear::to_json(some_model());
    CHECK_THAT(model_rejection(""), ContainsSubstring("model.json: no JSON"));
    CHECK_THAT(model_rejection(json.substr(0, json.size() / 2)), ContainsSubstring("model.json: no JSON"));
    CHECK_THAT(model_rejection("[]"), ContainsSubstring("model.json: must be an object"));
    CHECK_THAT(model_rejection(replaced(json, "antiskid wear model", "other")), ContainsSubstring("model.json: format: must be"));
    CHECK_THAT(model_rejection(replaced(json, "\"format_version\": 2", "\"format_version\": 9")),
               ContainsSubstring("format_version: 9 is not the version"));
    CHECK_THAT(model_rejection(replaced(json, "\"maneuvers\"", "\"landings\"")), ContainsSubstring("model.json: data.maneuvers: is missing"));
    CHECK_THAT(model_rejection(replaced(json, "\"starts\": 5", "\"starts\": \"5\"")), ContainsSubstring("search.starts: must be an integer"));
    CHECK_THAT(model_rejection(replaced(json, "\"tolerance\": 1e-08", "\"tolerance\": -1")),
               ContainsSubstring("search.tolerance: -1 must be positive"));
    CHECK_THAT(model_rejection(replaced(json, "\"seed\"", "\"extra\": 1, \"seed\"")), ContainsSubstring("search.extra: unknown key"));
    CHECK_THAT(model_rejection(replaced(json, "\"weight\": 0.", "\"weight\": 0.9")), ContainsSubstring("components: the weights add up to"));
    CHECK_THAT(model_rejection(replaced(json, "\"weight\": ", "\"weight\": -")), ContainsSubstring("components[0].weight"));
}

TEST_CASE("beyond its data the model says so, and goes on as it says", "[WEAR-009]") {
    const wear::Model model = some_model();
    const double last_J = model.data.last_c_e_J;
    CHECK_FALSE(model.extrapolates(0.0));  // one maneuver before the first point: a new brake
    CHECK_FALSE(model.extrapolates(250e6));
    CHECK_FALSE(model.extrapolates(last_J + 0.9 * model.data.mean_step_J()));
    CHECK(model.extrapolates(last_J + 1.1 * model.data.mean_step_J()));
    for (const wear::Choice choice : {wear::Choice::nearest, wear::Choice::mixture}) {
        const wear::ConditionalRule rule{wear::Variance::exact, choice};
        const wear::Conditional end = wear::friction_given_energy(model, last_J, rule);
        const wear::Conditional beyond = wear::friction_given_energy(model, last_J + 20e6, rule);
        const wear::Conditional further = wear::friction_given_energy(model, last_J + 40e6, rule);
        // Straight lines, with the weights of the end.
        CHECK(further.mean() - beyond.mean() == Approx(beyond.mean() - end.mean()).epsilon(1e-9));
        REQUIRE(beyond.terms.size() == end.terms.size());
        for (std::size_t i = 0; i < end.terms.size(); ++i) {
            CHECK(beyond.terms[i].weight == end.terms[i].weight);
            CHECK(beyond.terms[i].variance == end.terms[i].variance);
        }
    }
}
