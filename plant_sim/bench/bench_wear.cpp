/// The whole mixture search (M = 1 to 15, 100 starts each) against scikit-learn's GaussianMixture: same campaign of 500 maneuvers, same
/// standardisation, same number for the regularisation, same tolerance a point, one core for both. Table on standard output, JSON in
/// out/bench/wear.json.
///
/// scikit-learn adds the regularisation to the diagonal, ours bounds the eigenvalues below by it; whatever scikit-learn can reach is within
/// that bound. Log-likelihoods are of the standardised points.

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/bench/measure.hpp"
#include "rig_bridge/wear/fit.hpp"
#include "tests/wear/physical_campaign.hpp"

namespace {

constexpr const char* kPoints = "out/bench/wear_points.csv";
constexpr int kRounds = 3;

double wall_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct Moments {
    double mean = 0.0;
    double deviation = 0.0;
};

template <typename Of>
Moments moments(const std::vector<wear::Point>& points, const Of& of) {
    const auto n = static_cast<double>(points.size());
    Moments m;
    for (const wear::Point& p : points) m.mean += of(p) / n;
    double variance = 0.0;
    for (const wear::Point& p : points) variance += (of(p) - m.mean) * (of(p) - m.mean) / n;
    m.deviation = std::sqrt(variance);
    return m;
}

std::string output_of(const std::string& command) {
    std::FILE* pipe = ::popen(command.c_str(), "r");
    if (pipe == nullptr) throw std::runtime_error("cannot start " + command);
    std::string out;
    std::array<char, 4096> chunk{};
    while (const std::size_t got = std::fread(chunk.data(), 1, chunk.size(), pipe)) out.append(chunk.data(), got);
    const int status = ::pclose(pipe);
    if (WIFSIGNALED(status) || WEXITSTATUS(status) > 128) throw std::runtime_error(command + " was ended by a signal");
    if (status != 0) throw std::runtime_error(command + " failed; is python3-sklearn installed (./rig bench does that)?");
    return out;
}

int run() {
    const wear::Campaign campaign = physical::campaign(physical::laws().front(), 1);
    const auto n = static_cast<double>(campaign.points.size());
    const Moments c = moments(campaign.points, [](const wear::Point& p) { return p.c_e_J; });
    const Moments mu = moments(campaign.points, [](const wear::Point& p) { return p.mean_friction; });
    std::string csv;
    for (const wear::Point& p : campaign.points)
        fmt::format_to(std::back_inserter(csv), "{},{}\n", (p.c_e_J - c.mean) / c.deviation, (p.mean_friction - mu.mean) / mu.deviation);
    settings::write_file(kPoints, csv);

    const wear::FitSettings settings;
    wear::Fit fit;
    std::vector<double> processor;
    std::vector<double> wall;
    for (int round = 0; round < kRounds; ++round) {
        const double start_s = wall_s();
        processor.push_back(bench::processor_s_of([&] { fit = wear::fit(campaign, settings); }));
        wall.push_back(wall_s() - start_s);
    }
    const double per_point = std::log(c.deviation * mu.deviation);
    // Ours is relative to the log-likelihood of all points, scikit-learn's absolute to their mean: the same where it is 1 a point.
    const settings::Json other =
        settings::parse_json(output_of(fmt::format("/usr/bin/python3 plant_sim/bench/sklearn_mixture.py {} {} {} {} {}", kPoints, settings.starts,
                                                   settings.em.covariance_floor, settings.em.tolerance, settings.max_components)));

    settings::Json rows = settings::Json::array();
    double other_processor_s = 0.0;
    double other_wall_s = 0.0;
    double min_lead = 1e300;
    auto table = settings::TextTable::screen("components:>10|ours:>16.4f|scikit-learn:>16.4f|lead:>12.4f|scikit-learn (s):>20.2f");
    for (std::size_t i = 0; i < fit.orders.size(); ++i) {
        const double ours = fit.orders[i].log_likelihood + n * per_point;
        const settings::Json& o = other.at("orders").at(i);
        const auto theirs = o.at("log_likelihood").get<double>();
        other_processor_s += o.at("processor_s").get<double>();
        other_wall_s += o.at("seconds").get<double>();
        min_lead = std::min(min_lead, ours - theirs);
        table.add(fit.orders[i].components, ours, theirs, ours - theirs, o.at("processor_s").get<double>());
        rows.push_back({{"components", fit.orders[i].components},
                        {"ours_log_likelihood", ours},
                        {"sklearn_log_likelihood", theirs},
                        {"sklearn_processor_s", o.at("processor_s")}});
    }
    const double processor_s = bench::median(processor);
    const double ours_wall_s = bench::median(wall);
    fmt::print("{}least lead in log-likelihood {:.4f}\n", table.text(), min_lead);
    fmt::print("processor time: ours {:.2f} s, scikit-learn {} {:.1f} s, ratio {:.1f}\n", processor_s, other.at("version").get<std::string>(),
               other_processor_s, other_processor_s / processor_s);
    fmt::print("wall: ours {:.2f} s, scikit-learn {:.1f} s, ratio {:.1f}\n", ours_wall_s, other_wall_s, other_wall_s / ours_wall_s);
    const settings::Json json{{"orders", rows},
                              {"min_lead", min_lead},
                              {"ours_processor_s", processor_s},
                              {"sklearn_processor_s", other_processor_s},
                              {"processor_ratio", other_processor_s / processor_s},
                              {"ours_wall_s", ours_wall_s},
                              {"sklearn_wall_s", other_wall_s},
                              {"wall_ratio", other_wall_s / ours_wall_s},
                              {"sklearn_version", other.at("version")}};
    settings::write_file("out/bench/wear.json", json.dump(2) + "\n");
    return 0;
}

}  // namespace

int main() {
    return bench::status_of("bench_wear", run);
}
