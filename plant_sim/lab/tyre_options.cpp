#include "plant_sim/lab/tyre_options.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace plant_sim {

namespace {

const CLI::Option* list(CLI::App& app, const std::string& name, std::vector<double>& numbers, double least,
                        double most, const std::string& what) {
    return app.add_option(name, numbers, what)
        ->delimiter(',')
        ->check([least, most](const std::string& text) {
            // CLI::Range lets a value pass that is no number.
            double number = 0.0;
            const bool good = CLI::detail::lexical_cast(text, number) && number >= least && number <= most;
            return good ? std::string() : fmt::format("{} is not from {:g} to {:g}", text, least, most);
        })
        ->capture_default_str();
}

void refuse(const std::vector<const CLI::Option*>& options, const std::string& model) {
    for (const CLI::Option* o : options)
        if (o->count() > 0) throw std::invalid_argument(o->get_name() + " needs --tyre " + model);
}

}  // namespace

void TyreOptions::add_to(CLI::App& app) {
    settings::one_of(
        app.add_option("--tyre", model,
                       "static (the paper's), ring or relaxation, in the place of the rig file's [tyre]"),
        {"static", "ring", "relaxation"});
    of_ring_ = {
        list(app, "--belt-share", belt_share, 0.01, 0.9, "ring: of J_w that is belt; a list makes a table"),
        list(app, "--frequency", frequency_Hz, 5.0, 1000.0, "ring: rim against belt, Hz; or a list"),
        list(app, "--damping", damping, 0.0, 1.0, "ring: of that mode, of critical; or a list")};
    of_relaxation_ = {
        list(app, "--length", length_m, 0.001, 2.0, "relaxation: length at no slip, m; or a list"),
        list(app, "--floor", floor_m, 0.001, 2.0, "relaxation: it is nowhere shorter, m; or a list")};
}

std::vector<plant::Compliance> TyreOptions::tyres(const plant::Compliance& own) const {
    if (model != "ring") refuse(of_ring_, "ring");
    if (model != "relaxation") refuse(of_relaxation_, "relaxation");
    plant::Compliance one = own;
    if (model.empty()) return {one};
    one.ring = {};
    one.relaxation = {};
    std::vector<plant::Compliance> all;
    if (model == "static") all.push_back(one);
    if (model == "ring") {
        for (const double frequency : frequency_Hz)
            for (const double zeta : damping)
                for (const double share : belt_share) {
                    one.ring = {.belt_share = share, .frequency_Hz = frequency, .damping = zeta};
                    all.push_back(one);
                }
    }
    if (model == "relaxation") {
        for (const double length : length_m)
            for (const double floor : floor_m) {
                one.relaxation = {.length_m = length, .floor_m = floor};
                all.push_back(one);
            }
    }
    return all;
}

}  // namespace plant_sim
