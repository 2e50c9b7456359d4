#include "plant_sim/study/sweep/trade.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "rig_bridge/wear/draw.hpp"

namespace sweep {

namespace {

constexpr double kPerMJ = 1e-6;
constexpr double kSame = 1e-12;  // a smaller difference of costs is rounding

double cost_of(const Tariff& tariff, const ReferenceMeans& o) {
    if (const auto* price = std::get_if<Prices>(&tariff))
        return (price->brake_per_MJ * o.energy_brake_J + price->tyre_per_MJ * o.energy_tyre_J) * kPerMJ;
    const Lives& life = std::get<Lives>(tariff);
    return std::max(o.energy_brake_J / life.brake_MJ, o.energy_tyre_J / life.tyre_MJ) * kPerMJ;
}

void check(const StopsTable& sweep, const TradeOptions& options) {
    const auto reject = [](const std::string& what) { throw std::invalid_argument(what); };
    if (const auto* price = std::get_if<Prices>(&options.tariff)) {
        if (!(price->brake_per_MJ >= 0.0 && price->tyre_per_MJ >= 0.0 && std::isfinite(price->brake_per_MJ) && std::isfinite(price->tyre_per_MJ)))
            reject("the prices of a megajoule must be finite and not negative");
    } else {
        const Lives& life = std::get<Lives>(options.tariff);
        if (!(life.brake_MJ > 0.0 && life.tyre_MJ > 0.0 && std::isfinite(life.brake_MJ) && std::isfinite(life.tyre_MJ)))
            reject("the lives of brake and tyre must be finite and above 0 MJ");
    }
    if (options.resamples < 1 || options.resamples > 1'000'000) reject("resamples must be from 1 to 1000000");
    if (sweep.identity.references.size() < 2) reject(fmt::format("{}: a trade needs a sweep of at least two slip references", sweep.name));
    if (sweep.rows.size() != sweep.identity.stops())
        reject(fmt::format("{} has {} of {} stops; the command that made it goes on where it ended", sweep.name, sweep.rows.size(),
                           sweep.identity.stops()));
}

/// The landings of a sweep with weights.
class WeighedLandings {
  public:
    WeighedLandings(const StopsTable& sweep, const Tariff& tariff) : sweep_(sweep), tariff_(tariff) {}

    /// Row `i` of the sweep: a reference, or the threshold law after them.
    [[nodiscard]] ReferenceMeans mean(std::size_t i, const std::vector<double>& weights) const {
        const std::size_t n = weights.size();
        ReferenceMeans o;
        for (std::size_t j = 0; j < n; ++j) {
            const study::StopFigures& f = sweep_.rows[i * n + j].figures;
            o.j_mu += weights[j] * f.j_mu;
            o.stop_distance_m += weights[j] * f.stop_distance_m;
            o.energy_brake_J += weights[j] * f.energy_brake_J;
            o.energy_tyre_J += weights[j] * f.energy_tyre_J;
        }
        const auto& references = sweep_.identity.references;
        o.slip_reference = i < references.size() ? references[i] : 0.0;
        o.cost = cost_of(tariff_, o);
        return o;
    }

    [[nodiscard]] std::vector<ReferenceMeans> offers(const std::vector<double>& weights) const {
        const auto& references = sweep_.identity.references;
        std::vector<ReferenceMeans> means;
        means.reserve(references.size());
        for (std::size_t i = 0; i < references.size(); ++i) means.push_back(mean(i, weights));
        std::vector<ReferenceMeans> all;
        for (std::size_t i = 0; i + 1 < means.size(); ++i) {
            const auto steps = static_cast<int>(std::ceil((references[i + 1] - references[i]) / Trade::kStep - 1e-6));
            for (int k = 0; k < steps; ++k) all.push_back(between(means[i], means[i + 1], k, steps));
        }
        all.push_back(means.back());
        return all;
    }

  private:
    [[nodiscard]] ReferenceMeans between(const ReferenceMeans& a, const ReferenceMeans& b, int step, int steps) const {
        if (step == 0) return a;
        const double x = static_cast<double>(step) / steps;
        ReferenceMeans o{.slip_reference = std::lerp(a.slip_reference, b.slip_reference, x),
                         .j_mu = std::lerp(a.j_mu, b.j_mu, x),
                         .stop_distance_m = std::lerp(a.stop_distance_m, b.stop_distance_m, x),
                         .energy_brake_J = std::lerp(a.energy_brake_J, b.energy_brake_J, x),
                         .energy_tyre_J = std::lerp(a.energy_tyre_J, b.energy_tyre_J, x)};
        o.cost = cost_of(tariff_, o);
        return o;
    }

    const StopsTable& sweep_;
    const Tariff& tariff_;
};

/// Index of the cheapest within the bounds, among equally cheap ones that with the greatest J_mu; the size if there is none.
std::size_t best_of(const std::vector<ReferenceMeans>& offers, const Bounds& bounds) {
    std::size_t best = offers.size();
    for (std::size_t i = 0; i < offers.size(); ++i) {
        if (!bounds.allow(offers[i].j_mu, offers[i].stop_distance_m)) continue;
        if (best == offers.size()) {
            best = i;
            continue;
        }
        const double gain = offers[best].cost - offers[i].cost;
        const bool same = std::abs(gain) <= kSame * offers[best].cost;
        if (same ? offers[i].j_mu > offers[best].j_mu : gain > 0.0) best = i;
    }
    return best;
}

BindingLimit deciding(const std::vector<ReferenceMeans>& offers, std::size_t best, const Bounds& bounds) {
    if (offers[best].cost == 0.0) return BindingLimit::no_cost;
    for (const std::size_t next : {best - 1, best + 1}) {  // before the first, the index wraps round to a value beyond the last
        if (next >= offers.size() || offers[next].cost >= offers[best].cost * (1.0 - kSame)) continue;
        return bounds.min_j_mu && offers[next].j_mu < *bounds.min_j_mu ? BindingLimit::min_j_mu : BindingLimit::max_distance;
    }
    return best == 0 || best + 1 == offers.size() ? BindingLimit::end_of_references : BindingLimit::nothing;
}

Interval middle(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const auto at = [&values](double share) { return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))]; };
    constexpr double kTail = 0.025;
    return {at(kTail), at(1.0 - kTail)};
}

double saved(const ReferenceMeans& best, const ReferenceMeans& other) {
    return other.cost > 0.0 ? 1.0 - best.cost / other.cost : 0.0;
}

std::optional<ReferenceMeans> paper_of(const std::vector<ReferenceMeans>& offers) {
    for (const ReferenceMeans& o : offers) {
        if (std::abs(o.slip_reference - kPaperReference) < 0.5 * Trade::kStep) return o;
    }
    return std::nullopt;
}

}  // namespace

Trade traded(const StopsTable& sweep, const TradeOptions& options) {
    check(sweep, options);
    const std::size_t landings = sweep.identity.landings;
    const std::size_t by_threshold = sweep.identity.references.size();
    const WeighedLandings sample(sweep, options.tariff);
    const std::vector<double> equal(landings, 1.0 / static_cast<double>(landings));
    Trade t{.offers = sample.offers(equal), .greatest_j_mu = {}, .min_distance = {}};
    t.greatest_j_mu =
        *std::max_element(t.offers.begin(), t.offers.end(), [](const ReferenceMeans& a, const ReferenceMeans& b) { return a.j_mu < b.j_mu; });
    t.min_distance = *std::min_element(t.offers.begin(), t.offers.end(),
                                       [](const ReferenceMeans& a, const ReferenceMeans& b) { return a.stop_distance_m < b.stop_distance_m; });
    t.paper = paper_of(t.offers);
    if (sweep.identity.threshold) t.threshold = sample.mean(by_threshold, equal);
    const std::size_t best = best_of(t.offers, options.bounds);
    if (best < t.offers.size()) {
        t.best = t.offers[best];
        t.decides = deciding(t.offers, best, options.bounds);
    }

    std::vector<double> references;
    std::vector<double> against_paper;
    std::vector<double> against_threshold;
    for (int r = 0; r < options.resamples; ++r) {
        wear::Generator generator = wear::generator_of(options.seed, static_cast<std::uint64_t>(r));
        std::vector<double> weights(landings, 0.0);
        for (std::size_t j = 0; j < landings; ++j)
            weights[static_cast<std::size_t>(wear::uniform(generator) * static_cast<double>(landings))] += equal.front();
        const std::vector<ReferenceMeans> offers = sample.offers(weights);
        const std::size_t i = best_of(offers, options.bounds);
        if (i == offers.size()) continue;
        references.push_back(offers[i].slip_reference);
        if (const auto paper = paper_of(offers)) against_paper.push_back(saved(offers[i], *paper));
        if (t.threshold) against_threshold.push_back(saved(offers[i], sample.mean(by_threshold, weights)));
    }
    t.feasible_share = static_cast<double>(references.size()) / static_cast<double>(options.resamples);
    if (!t.best) return t;
    t.best_interval = middle(std::move(references));
    if (t.paper) t.against_paper = Saving{saved(*t.best, *t.paper), middle(std::move(against_paper))};
    if (t.threshold) t.against_threshold = Saving{saved(*t.best, *t.threshold), middle(std::move(against_threshold))};
    return t;
}

}  // namespace sweep
