#include "rig_bridge/wear/limit_forecast.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace wear {

namespace {

double normal_cdf(double z) {
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

When when(double done, double left_J, double share, double landing_J, double deviation_J) {
    const double to_come = share > 0.0 ? left_J / (share * landing_J) : 0.0;
    return {done + to_come, deviation_J / landing_J * std::sqrt(to_come)};
}

}  // namespace

const char* name(Feasibility verdict) {
    static constexpr std::array kNames{"together", "early", "late", "brake_first", "tyre_first", "reached"};
    return kNames[static_cast<std::size_t>(verdict)];
}

LimitForecast limit_forecast(const Regulator& r) {
    const WearPlan& plan = r.plan();
    const double brake_J = r.brake_left_J();
    const double tyre_J = r.tyre_left_J();
    const double left_J = brake_J + tyre_J;
    const double landing_J = r.landing_J();
    const double done = r.landings();
    const double to_come = std::max(static_cast<double>(plan.landings) - done, 0.0);
    const double expected_J = to_come * landing_J;
    LimitForecast o;
    o.required_share = r.required_share();
    o.min_share = std::min(r.share_of(r.range().lowest), 1.0);
    o.max_share = std::min(r.share_of(r.range().highest), 1.0);
    o.brought = left_J > 0.0 ? expected_J / left_J : 0.0;
    const double share = std::clamp(o.required_share, o.min_share, o.max_share);
    o.brake = when(done, brake_J, 1.0 - share, landing_J, plan.landing_deviation_J);
    o.tyre = when(done, tyre_J, share, landing_J, plan.landing_deviation_J);
    if (brake_J <= 0.0 || tyre_J <= 0.0) {
        o.verdict = Feasibility::reached;
        return o;
    }
    const double slack_J = plan.tolerance * (plan.brake_budget_J() + plan.tyre_budget_J());
    // Energy shifted by the bounds from one to the other; without effect if it is within the tolerance of both.
    const double shift_J = (share - o.required_share) * left_J;
    const double bearable_J = plan.tolerance * std::min(plan.brake_budget_J(), plan.tyre_budget_J());
    if (shift_J < -bearable_J) {
        o.verdict = Feasibility::brake_first;
        return o;
    }
    if (shift_J > bearable_J) {
        o.verdict = Feasibility::tyre_first;
        return o;
    }
    const double scatter_J = plan.landing_deviation_J * std::sqrt(to_come);
    const double off_J = expected_J - left_J;
    if (scatter_J > 0.0)
        o.probability = normal_cdf((slack_J - off_J) / scatter_J) - normal_cdf((-slack_J - off_J) / scatter_J);
    else
        o.probability = std::abs(off_J) <= slack_J ? 1.0 : 0.0;
    if (std::abs(off_J) <= slack_J)
        o.verdict = Feasibility::together;
    else
        o.verdict = off_J > 0.0 ? Feasibility::early : Feasibility::late;
    return o;
}

std::string sentence(const LimitForecast& o, const WearPlan& plan) {
    switch (o.verdict) {
        case Feasibility::together:
            return fmt::format(
                "feasible: both limits near landing {}; the landings' own scatter allows {:.0f} % of lives "
                "within "
                "{:.0f} %",
                plan.landings, o.probability * 100.0, plan.tolerance * 100.0);
        case Feasibility::early:
        case Feasibility::late:
            return fmt::format(
                "not feasible at landing {}: the planned landings bring {:.1f} % of the energy that is left, "
                "whatever the reference; both limits come together near landing {:.0f} +- {:.0f}",
                plan.landings, o.brought * 100.0, o.brake.landing, o.brake.deviation);
        case Feasibility::brake_first:
            return fmt::format(
                "not feasible: the tyre's share would have to be {:.3f}, the allowed references give at most "
                "{:.3f}; "
                "the brake's limit comes first, near landing {:.0f} +- {:.0f}, the tyre's near {:.0f} +- "
                "{:.0f}",
                o.required_share, o.max_share, o.brake.landing, o.brake.deviation, o.tyre.landing, o.tyre.deviation);
        case Feasibility::tyre_first:
            return fmt::format(
                "not feasible: the tyre's share would have to be {:.3f}, the allowed references give at "
                "least {:.3f}; "
                "the tyre's limit comes first, near landing {:.0f} +- {:.0f}, the brake's near {:.0f} +- "
                "{:.0f}",
                o.required_share, o.min_share, o.tyre.landing, o.tyre.deviation, o.brake.landing, o.brake.deviation);
        case Feasibility::reached:
            break;
    }
    return "a limit is reached";
}

}  // namespace wear
