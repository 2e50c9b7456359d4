#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "firmware/host/settings/progress.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/lab/campaign_options.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/lab/wear_pictures.hpp"
#include "rig_bridge/wear/model_io.hpp"
#include "rig_bridge/wear/on_threads.hpp"
#include "rig_bridge/wear/order_score.hpp"

namespace plant_sim::lab {

namespace {

std::string table_of(const wear::Fit& fit, const wear::Model& model) {
    auto orders = settings::TextTable::screen("components:>10|log_likelihood:>20.4f|BIC:>16.2f|score:>10.4f|runs:>8|");
    for (std::size_t i = 0; i < fit.orders.size(); ++i) {
        const wear::OrderFit& o = fit.orders[i];
        const std::string not_converged = o.not_converged > 0 ? fmt::format("  {} runs did not converge", o.not_converged) : "";
        orders.add(o.components, o.log_likelihood, o.bic, o.score, o.runs, (i == fit.chosen ? "  chosen" : "") + not_converged);
    }
    auto table = settings::TextTable::screen(
        "component:>10|weight:>10.4f|energy_MJ:>16.3f|deviation_MJ:>16.3f|mean_friction:>16.5f|deviation:>18.5f|correlation:>14.4f");
    const std::vector<wear::Component>& components = model.mixture.components();
    for (std::size_t j = 0; j < components.size(); ++j) {
        const wear::Component& c = components[j];
        table.add(j + 1, c.weight, c.mean_c_e_J * 1e-6, std::sqrt(c.variance_c_e_J2) * 1e-6, c.mean_friction, std::sqrt(c.variance_friction),
                  c.correlation());
    }
    return orders.text() + "\n" + table.text();
}

enum class Choose : std::uint8_t { bic, score };

struct FitCommand {
    CampaignOptions from;
    std::string origin;
    wear::FitSettings settings;
    Choose choose = Choose::bic;
    unsigned threads = wear::all_cores();
    std::filesystem::path out = "out/wear";
    std::string json_file;  ///< "-": standard output
    bool pictures = true;

    int run() const {
        wear::Campaign data = from.load();
        if (!origin.empty()) data.origin = origin;
        wear::Fit fit = wear::fit(data, settings, {threads, {}, settings::step_progress("steps")});
        const std::vector<double> scores = wear::blocked_scores(data, fit.orders, settings.em, threads);
        for (std::size_t i = 0; i < scores.size(); ++i) fit.orders[i].score = scores[i];
        if (choose == Choose::score) fit.chosen = wear::greatest_score(fit.orders);
        const wear::Model model = wear::model_of(data, fit, settings);
        print_table(json_file, "{}\nLearnt from a brake {}. Between {:.3f} and {:.3f} MJ the model has seen data; {}.\n", table_of(fit, model),
                    wear::origin_phrase(model.data.origin), model.data.first_c_e_J * 1e-6, model.data.last_c_e_J * 1e-6, wear::kHowItExtrapolates);
        if (fit.best().components == settings.max_components && settings.max_components > 1)
            print_table(json_file, "The best order is the most components allowed: a better one may lie beyond.\n");
        write_json(out / "model.json", json_file, wear::to_json(model));
        settings::deliver((out / "campaign.csv").string(), wear::to_csv(data));
        if (pictures) {
            draw_campaign(data, model, out / "campaign.png");
            draw_density(data, model, out / "density.png");
            draw_orders(model, out / "orders.png");
        }
        print_table(json_file, "Written to {}: model.json campaign.csv{}\n", out.string(), pictures ? " campaign.png density.png orders.png" : "");
        return 0;
    }
};

}  // namespace

LabVerb wear_fit_verb(CLI::App& wear) {
    const auto fit = std::make_shared<FitCommand>();
    CLI::App* verb = wear.add_subcommand("fit",
                                         "Gaussian mixtures of eq. (10) to (13) on a campaign; BIC chooses the number of components, or the score: "
                                         "the mean of log p(mean mu_b | energy) of blocks of maneuvers left out of the fit.");
    fit->from.add_to(*verb, "as for `wear table`")->required();
    add_origin(*verb, fit->origin);
    verb->add_option("--components", fit->settings.max_components, "the most that are tried")
        ->check(CLI::Range(std::size_t{1}, wear::kMaxComponents))
        ->capture_default_str();
    settings::add_choice(*verb, "--choose", fit->choose, {{"bic", Choose::bic}, {"score", Choose::score}}, "what chooses the number of components");
    verb->add_option("--starts", fit->settings.starts, "random starts for each number of components")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    settings::add_seed(*verb, fit->settings.seed);
    verb->add_option("--floor", fit->settings.em.covariance_floor, "least eigenvalue of a covariance matrix on standardised data")
        ->check(CLI::Range(1e-9, 1.0))
        ->capture_default_str();
    settings::add_threads(*verb, fit->threads);
    settings::add_json(*verb, fit->json_file, "results");
    settings::add_out(*verb, fit->out, "directory of model.json, campaign.csv and the pictures");
    settings::add_no_pictures(*verb, fit->pictures);
    verb->footer("Examples:\n  rig-lab wear fit out/endurance\n  rig-lab wear fit measured.csv --components 6 --out out/mine");
    return {verb, [fit] { return fit->run(); }};
}

}  // namespace plant_sim::lab
