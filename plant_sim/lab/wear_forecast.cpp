#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/lab/campaign_options.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/lab/wear_pictures.hpp"
#include "plant_sim/wear/back_test.hpp"
#include "plant_sim/wear/forecast_request.hpp"

namespace plant_sim::lab {

namespace {

using settings::Json;

std::string landings(const std::optional<int>& left) {
    return left ? fmt::format("{}", *left) : std::string("none within the horizon");
}

std::string text_of(const wear::Forecast& f, const wear::ForecastSettings& settings, const wear::LandingMix& mix) {
    double energy_J = 0.0;
    for (const wear::LandingKind& kind : mix) energy_J += kind.share * kind.energy_J;
    std::string text =
        fmt::format("Mean friction after {:.3f} MJ: {:.4f} ({:.4f} to {:.4f}, 10 to 90 %), without the scatter of single maneuvers. Limit {:.4f}.\n",
                    f.c_e_J * 1e-6, f.friction_now[1], f.friction_now[0], f.friction_now[2], settings.limit);
    if (f.already_crossed())
        return text + fmt::format("Already below the limit, with a probability of {:.0f} %: no landing left.\n", 100.0 * f.crossed_now);
    auto table = settings::TextTable::screen(":>8|landings:>24|at MJ:>16");
    constexpr std::array kNames{"10 %", "50 %", "90 %"};
    for (std::size_t q = 0; q < kNames.size(); ++q)
        table.add(kNames.at(q), landings(f.landings_left.at(q)), f.crossing_J.at(q) ? fmt::format("{:.1f}", *f.crossing_J.at(q) * 1e-6) : "-");
    text += fmt::format("Landings left, {:.3f} MJ each on average:\n{}", energy_J * 1e-6, table.text());
    constexpr double kDoubtful = 0.5;
    if (f.population_probability < kDoubtful)
        text += fmt::format(
            "This brake does not go as those did (of their kind with a probability of {:.0f} %): it is given their lives, and little else.\n",
            100.0 * f.population_probability);
    if (f.crossed_ever < 1.0)
        text += fmt::format("{} within the horizon of {} landings with a probability of {:.0f} %.\n", f.never_crosses() ? "Not crossed" : "Crossed",
                            settings.horizon, 100.0 * (f.never_crosses() ? 1.0 - f.crossed_ever : f.crossed_ever));
    if (f.extrapolated > 0.0)
        text += fmt::format("{:.0f} % of the draws go beyond the data that the model was learnt from: {}.\n", std::ceil(100.0 * f.extrapolated),
                            wear::kHowItExtrapolates);
    return text;
}

std::string readings_text(const wear::Campaign& campaign, const wear::Population& population, const std::string& method) {
    if (campaign.readings.empty()) return {};
    if (method == "filter") return fmt::format("{} readings of the lining are not used by this method.\n", campaign.readings.size());
    return fmt::format("{} readings of the lining{}.\n", campaign.readings.size(),
                       population.curves.lining.lives > 0 ? fmt::format(", weighed by those of {} lives", population.curves.lining.lives)
                                                          : std::string(" are not used: these brakes were learnt from with too few"));
}

struct ForecastCommand {
    CampaignOptions from;
    PopulationOptions model;
    wear::ForecastRequest request;
    bool reserve = false;
    std::filesystem::path back_test;
    std::filesystem::path out = "out/wear";
    std::string json_file;  ///< "-": standard output
    bool pictures = true;

    int run() const {
        if (request.limit.has_value() == reserve) throw std::invalid_argument("say which limit: --limit MU or --reserve");
        const wear::PopulationFile file = model.read();
        const wear::ResolvedRequest resolved = wear::resolved(request);
        if (const auto& r = resolved.reserve)
            print_table(json_file,
                        "Torque reserve: below mean friction {:.4f} full pressure does not give the {:.0f} N m that a heavy stop on dry asphalt can "
                        "use at {:.0f} m/s.\n",
                        r->friction, r->torque_Nm, r->speed_mps);
        if (!back_test.empty()) return run_back_test(file, resolved);
        if (from.source.empty()) throw std::invalid_argument("SOURCE is missing: the brake's campaign so far");
        return run_forecast(file, resolved);
    }

  private:
    [[nodiscard]] int run_forecast(const wear::PopulationFile& file, const wear::ResolvedRequest& resolved) const {
        const wear::Campaign recorded = from.load();
        const wear::ForecastAnswer answer = wear::answer(request, resolved, file, recorded);
        print_table(json_file, "By brakes {}.\n{}{}", file.population.provenance.sentence(), text_of(answer.forecast, resolved.settings, answer.mix),
                    readings_text(recorded, file.population, request.method));
        write_json(out / "forecast.json", json_file, settings::json_page(answer.json));
        if (pictures) draw_forecast(recorded, answer.forecast, resolved.settings.limit, out / "forecast.png");
        print_table(json_file, "Written to {}: forecast.json{}\n", out.string(), pictures ? " forecast.png" : "");
        return 0;
    }
    int run_back_test(const wear::PopulationFile& file, const wear::ResolvedRequest& resolved) const {
        const wear::ForecastSettings& settings = resolved.settings;
        const std::vector<wear::Campaign> campaigns = rig::replay::load_campaigns({back_test}, from.off);
        wear::FitSettings fit;
        fit.max_components = 8;
        fit.starts = 10;
        std::vector<wear::HeldOut> brakes;
        brakes.reserve(campaigns.size());
        std::size_t without_end = 0;
        const auto fitted = settings::step_progress("campaigns fitted");
        for (std::size_t i = 0; i < campaigns.size(); ++i) {
            if (const auto life = wear::life_by_fit(campaigns[i], settings.limit, fit))
                brakes.push_back({campaigns[i], *life});
            else
                ++without_end;
            fitted(i + 1, campaigns.size());
        }
        const wear::BackTest t = wear::back_test(file.population, brakes, settings, settings::step_progress("brakes forecast"));
        auto table =
            settings::TextTable::screen("part of life:>14|asked:>8|within:>10.3f|earlier:>12|later:>10|mean width:>14.1f|error of 50 %:>16.1f");
        Json rows = Json::array();
        const auto add = [&](const wear::BackTestRow& r, const std::string& part) {
            table.add(part, r.asked, r.coverage(), r.earlier, r.later, r.mean_width, r.mean_error);
            rows.push_back({{"part_of_life", part},
                            {"asked", r.asked},
                            {"held", r.held},
                            {"earlier", r.earlier},
                            {"later", r.later},
                            {"coverage", r.coverage()},
                            {"mean_width_landings", r.mean_width},
                            {"mean_error_landings", r.mean_error}});
        };
        for (const wear::BackTestRow& r : t.rows) add(r, fmt::format("{:.0f} %", 100.0 * r.share_of_life));
        add(t.pooled, "all");
        print_table(json_file, "By brakes {}.\n{} brakes, how often the 10 to 90 % interval of landings left has the truth:\n{}",
                    file.population.provenance.sentence(), brakes.size(), table.text());
        if (without_end > 0) print_table(json_file, "{} campaigns never come below {:.4f} and are left out.\n", without_end, settings.limit);
        Json json = wear::json_head(resolved, file);
        json["brakes"] = brakes.size();
        json["rows"] = std::move(rows);
        write_json(out / "back_test.json", json_file, settings::json_page(json));
        print_table(json_file, "Written to {}: back_test.json\n", out.string());
        const double pooled = t.pooled.coverage();
        return pooled >= 0.7 && pooled <= 0.9 ? 0 : 1;
    }
};

}  // namespace

LabVerb wear_forecast_verb(CLI::App& wear) {
    const auto f = std::make_shared<ForecastCommand>();
    CLI::App* verb =
        wear.add_subcommand("forecast", "Landings left until the brake's mean friction, without the scatter of single maneuvers, is below a limit.");
    f->from.add_to(*verb, "the brake's campaign so far, as for `wear table`");
    f->model.add_to(*verb);
    auto* const limit = verb->add_option("--limit", f->request.limit, "mean friction")->check(CLI::Range(0.001, 1.5));
    verb->add_flag("--reserve", f->reserve, "the limit is where full pressure no longer gives the torque that a heavy stop on dry asphalt can use")
        ->excludes(limit);
    auto* const mix = verb->add_option("--mix", f->request.mix,
                                       "landings to come, by maneuvers of config/, e.g. light=0.5,medium=0.3,heavy=0.2; their brake energy over "
                                       "[brake.wear] energy_scale (default: as the newest 100 of the campaign)");
    verb->add_option("--slip", f->request.slip, "that those landings are held at: the tyre's share of the energy")
        ->check(CLI::Range(0.0, 0.99))
        ->capture_default_str();
    verb->add_option("--energy", f->request.energy_MJ, "MJ of each landing to come, instead")->check(CLI::Range(1e-4, 1e3))->excludes(mix);
    settings::one_of(verb->add_option("--method", f->request.method,
                                      "shipped: curves over the share of life, and past lives; filter: what the brake's own friction says, alone"),
                     {"shipped", "filter"})
        ->capture_default_str();
    verb->add_option("--last", f->request.last, "learn from the newest N maneuvers only; 0: all")->capture_default_str();
    verb->add_option("--horizon", f->request.horizon, "landings")->check(CLI::Range(1, 1'000'000))->capture_default_str();
    verb->add_option("--draws", f->request.draws, "possible futures")->check(CLI::Range(100, 1'000'000))->capture_default_str();
    settings::add_seed(*verb, f->request.seed);
    settings::add_config_directory(*verb, f->request.config);
    settings::existing_directory(verb->add_option("--back-test", f->back_test,
                                                  "directory of whole campaigns as CSV: forecasts at 20, 40, 60 and 80 % of each brake's life "
                                                  "against its end; status 0 when 70 to 90 % are held"));
    settings::add_json(*verb, f->json_file, "results");
    settings::add_out(*verb, f->out, "directory of forecast.json and forecast.png, or back_test.json");
    settings::add_no_pictures(*verb, f->pictures);
    verb->footer(
        "Examples:\n"
        "  rig-lab wear forecast out/endurance --model mine.json --limit 0.2\n"
        "  rig-lab wear forecast measured.csv --assume-made-up --reserve --mix light=0.5,medium=0.3,heavy=0.2\n"
        "  rig-lab wear forecast --back-test campaigns/ --model mine.json --limit 0.2");
    return {verb, [f] { return f->run(); }};
}

}  // namespace plant_sim::lab
