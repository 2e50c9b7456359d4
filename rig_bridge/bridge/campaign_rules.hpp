/// What an unattended campaign does next. Pure: outcomes in, decisions out; the ledger keeps what has happened.
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
    int retries = 0;                       ///< of one maneuver, after it was aborted
    std::optional<double> min_friction{};  ///< wear limit: mean friction of a finished maneuver below it ends the campaign
    bool stop_on_abnormal = false;         ///< an abnormal brake ends the campaign
};

enum class CampaignState : std::uint8_t { go_on, fault, worn, abnormal };

struct Decision {
    CampaignState verdict = CampaignState::go_on;
    std::string reason;  ///< for people; empty when all is well
};

class CampaignJudge {
  public:
    explicit CampaignJudge(const CampaignRules& rules) : rules_(rules) {}

    /// After a maneuver, in the order in which they were run. Causes that a person makes (emergency_stop, guard_open, requested,
    /// foreign_command, two_senders) and a drive that does not do what it is told (overspeed, speed_mismatch) are never retried: a person
    /// decides when the rig may move again.
    [[nodiscard]] Decision after(const record::Summary& summary, const record::Health& health = {});

    /// Before the first: the last finished one of an earlier session may have reached the wear limit or shown an abnormal brake.
    [[nodiscard]] Decision before(const record::Summary& last_finished, const record::Health& health = {}) const {
        return brake(last_finished, health);
    }

  private:
    [[nodiscard]] Decision brake(const record::Summary& summary, const record::Health& health) const;

    CampaignRules rules_;
    std::int64_t failing_ = 0;  // number of the maneuver that failed last
    int failures_ = 0;          // of that one, in a row
};

/// Time left, from how long the newest maneuvers took, cool-down included.
class Pace {
  public:
    void add(double seconds);
    [[nodiscard]] std::optional<double> left_s(std::int64_t maneuvers) const;

  private:
    static constexpr std::size_t kKept = 20;
    std::deque<double> newest_;
};

}  // namespace rig::bridge
