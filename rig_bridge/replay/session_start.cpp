#include "rig_bridge/replay/session_start.hpp"

#include <algorithm>

#include "firmware/can/roles.hpp"
#include "firmware/can/schedule.hpp"

namespace rig::replay {

using antiskid::can::Role;

namespace {

constexpr std::uint64_t kMax = 100'000;

/// How often a message was due before each step.
class Timetable {
  public:
    Timetable(const antiskid::can::Layout& layout, const antiskid::can::Schedule& schedule, Role role, std::uint64_t steps)
        : modulo_(layout[role].protection.counter_modulo), counted_(layout[role].protection.protection != antiskid::can::Protection::none) {
        before_.reserve(steps + 1);
        before_.push_back(0);
        for (std::uint64_t i = 0; i < steps; ++i) before_.push_back(before_.back() + (schedule.due(role, static_cast<std::uint32_t>(i)) ? 1U : 0U));
    }

    [[nodiscard]] bool agrees(std::uint64_t step, int sent) const {
        if (sent == SentAtStep::kUnknown) return true;
        const bool due = before_[step + 1] != before_[step];
        if (sent == SentAtStep::kNotSent) return !due;
        return due && (!counted_ || before_[step] % modulo_ == static_cast<std::uint32_t>(sent));
    }

  private:
    std::uint32_t modulo_;
    bool counted_;
    std::vector<std::uint32_t> before_;
};

}  // namespace

std::optional<std::uint64_t> steps_before(const antiskid::can::Layout& layout, antiskid::control::Time period, const std::vector<SentAtStep>& steps) {
    const antiskid::can::Schedule schedule(layout, period);
    std::vector<std::pair<Role, Timetable>> tables;
    tables.reserve(antiskid::can::kToRig.size());
    for (const Role role : antiskid::can::kToRig)
        if (layout[role].bound) tables.emplace_back(role, Timetable(layout, schedule, role, kMax + steps.size()));
    for (std::uint64_t start = 0; start < kMax; ++start) {
        const auto fits = [&](const auto& table) {
            for (std::size_t i = 0; i < steps.size(); ++i)
                if (!table.second.agrees(start + i, steps[i][table.first])) return false;
            return true;
        };
        if (std::all_of(tables.begin(), tables.end(), fits)) return start;
    }
    return std::nullopt;
}

}  // namespace rig::replay
