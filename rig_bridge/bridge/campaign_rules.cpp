#include "rig_bridge/bridge/campaign_rules.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "rig_bridge/rig/sequencer.hpp"

namespace rig::bridge {

using rig::Abort;

namespace {

/// Due to a person, or to a drive that does not follow its set-point: a retry could repeat the danger.
bool needs_a_person(const std::string& outcome) {
    constexpr std::array kCauses{Abort::emergency_stop, Abort::guard_open,     Abort::requested,  Abort::foreign_command,
                                 Abort::overspeed,      Abort::speed_mismatch, Abort::two_senders};
    return std::any_of(kCauses.begin(), kCauses.end(), [&outcome](Abort cause) { return outcome == name(cause); });
}

}  // namespace

Decision CampaignJudge::brake(const record::Summary& summary, const record::Health& health) const {
    if (rules_.stop_on_abnormal && health.state == record::HealthState::abnormal)
        return {CampaignState::abnormal, fmt::format("maneuver {}: the brake is abnormal: {}", summary.number, health.reason)};
    const double friction = summary.figures.mean_friction;
    if (record::off_conditions(summary)) return {};
    if (!rules_.min_friction || friction >= *rules_.min_friction) return {};
    return {CampaignState::worn,
            fmt::format("maneuver {}: mean friction {:.4f} is below the wear limit {:.4f}", summary.number, friction, *rules_.min_friction)};
}

Decision CampaignJudge::after(const record::Summary& summary, const record::Health& health) {
    if (summary.outcome == "finished") {
        failures_ = 0;
        return brake(summary, health);
    }
    failures_ = failing_ == summary.number ? failures_ + 1 : 1;
    failing_ = summary.number;
    std::string what = fmt::format("maneuver {} was aborted: {}", summary.number, summary.outcome);
    if (needs_a_person(summary.outcome)) return {CampaignState::fault, what + "; never retried by itself"};
    if (failures_ <= rules_.retries) return {CampaignState::go_on, what + fmt::format("; retry {} of {}", failures_, rules_.retries)};
    return {CampaignState::fault, rules_.retries == 0 ? what : what + fmt::format("; {} retries did not help", rules_.retries)};
}

void Pace::add(double seconds) {
    newest_.push_back(seconds);
    if (newest_.size() > kKept) newest_.pop_front();
}

std::optional<double> Pace::left_s(std::int64_t maneuvers) const {
    if (newest_.empty()) return std::nullopt;
    const double sum = std::accumulate(newest_.begin(), newest_.end(), 0.0);
    return static_cast<double>(maneuvers) * sum / static_cast<double>(newest_.size());
}

}  // namespace rig::bridge
