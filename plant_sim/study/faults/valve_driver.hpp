/// The valve's driver that a rig must have (docs/engineering/fault_campaign.md).
#pragma once

#include "firmware/can/controller_view.hpp"
#include "firmware/can/message_stats.hpp"

namespace faults {

/// Outputs the commanded current. Outputs none if no command was accepted for kSilence, and while the rejected commands exceed the accepted ones by
/// more than kMaxRejected: if many commands are old or corrupt, some of them pass the checks by chance.
class ValveDriver {
  public:
    static constexpr antiskid::control::Time kSilence{20'000'000};
    static constexpr std::uint32_t kMaxRejected = 20;

    /// Call once a period, after the frames of that period.
    void update(const antiskid::can::ControllerView& controller, const antiskid::can::MessageStats& stats, antiskid::control::Time now) {
        const std::uint32_t more = stats.rejected() - rejected_;
        rejected_ = stats.rejected();
        score_ += more < kMaxRejected ? more : kMaxRejected;
        if (stats.accepted != accepted_ && score_ > 0) --score_;
        accepted_ = stats.accepted;
        if (score_ > 2 * kMaxRejected) score_ = 2 * kMaxRejected;
        has_command_ =
            controller.command_received != antiskid::control::kNever && now - controller.command_received <= kSilence && score_ <= kMaxRejected;
        current_mA_ = has_command_ ? static_cast<double>(controller.current_mA) : 0.0;
    }
    [[nodiscard]] bool has_command() const { return has_command_; }
    [[nodiscard]] double current_mA() const { return current_mA_; }

  private:
    std::uint32_t rejected_ = 0;
    std::uint32_t accepted_ = 0;
    std::uint32_t score_ = 0;
    bool has_command_ = false;
    double current_mA_ = 0.0;
};

}  // namespace faults
