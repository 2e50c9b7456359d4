/// What an unattended campaign does next. Pure: outcomes in, decisions out; the ledger keeps the history.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "rig_bridge/record/health.hpp"
#include "rig_bridge/record/summary.hpp"

namespace rig::bridge {

struct CampaignRules {
    std::int64_t maneuvers = 0;
    int retries = 0;                       ///< of an aborted maneuver
    std::optional<double> min_friction{};  ///< wear limit: mean friction of a finished maneuver below it ends the campaign
    bool stop_on_abnormal = false;         ///< an abnormal brake ends the campaign
};

enum class CampaignState : std::uint8_t { go_on, fault, worn, abnormal };

struct Decision {
    CampaignState verdict = CampaignState::go_on;
    std::string reason;  ///< for people; empty with `go_on`
};

class CampaignJudge {
  public:
    explicit CampaignJudge(const CampaignRules& rules) : rules_(rules) {}

    /// Call after each maneuver, in order. Abort causes due to a person (emergency_stop, guard_open, requested, foreign_command, two_senders) and to
    /// a drive that does not follow its set-point (overspeed, speed_mismatch) are never retried: a person decides when the rig may move again.
    [[nodiscard]] Decision after(const record::Summary& summary, const record::Health& health = {});

    /// Call before the first maneuver: the last finished one of an earlier session may have reached the wear limit or shown an abnormal brake.
    [[nodiscard]] Decision before(const record::Summary& last_finished, const record::Health& health = {}) const {
        return brake(last_finished, health);
    }

  private:
    [[nodiscard]] Decision brake(const record::Summary& summary, const record::Health& health) const;

    CampaignRules rules_;
    std::int64_t failing_ = 0;  // number of the maneuver that failed last
    int failures_ = 0;          // of that maneuver, in a row
};

/// Estimates the time left from the durations of the newest maneuvers, including cool-down.
class Pace {
  public:
    void add(double seconds);
    [[nodiscard]] std::optional<double> left_s(std::int64_t maneuvers) const;

  private:
    static constexpr std::size_t kKept = 20;
    std::deque<double> newest_;
};

}  // namespace rig::bridge
