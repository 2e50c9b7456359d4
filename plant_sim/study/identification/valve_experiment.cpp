#include "plant_sim/study/identification/valve_experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant_sim/study/order_statistics.hpp"

namespace identification {

namespace {

constexpr double kSettled_s = 0.3;   // after a change of this much the static map shows
constexpr double kRamp_mAps = 10.0;  // slower is a ramp

/// Readings near the points of the map, by the direction of the ramp.
class Branches {
  public:
    explicit Branches(const std::vector<double>& currents) : currents_(currents), up_(currents.size()), down_(currents.size()) {}

    void add(const ValveExperiment& e) {
        const auto half = static_cast<std::size_t>(std::llround(0.5 * kSettled_s / e.period_s));
        if (e.current_mA.size() <= 2 * half) return;
        for (std::size_t k = half; k + half < e.current_mA.size(); ++k) {
            if (e.measured[k] == 0) continue;
            const double change_mA = e.current_mA[k + half] - e.current_mA[k - half];
            const double slope = change_mA / (2.0 * static_cast<double>(half) * e.period_s);
            // A ramp makes half of its change in half of the time; a step does not.
            const double middle_mA = e.current_mA[k] - e.current_mA[k - half];
            if (std::abs(slope) > kRamp_mAps || std::abs(change_mA) < 0.05 ||
                std::abs(middle_mA - 0.5 * change_mA) > 0.2 * std::abs(change_mA) + 0.06)
                continue;
            const std::size_t node = nearest(e.current_mA[k]);
            if (node == currents_.size()) continue;
            (change_mA > 0.0 ? up_ : down_)[node].push_back(e.pressure_Pa[k]);
        }
    }

    [[nodiscard]] std::vector<double> pressures() const {
        std::vector<double> middle(currents_.size(), 0.0);
        std::string missing;
        for (std::size_t i = 1; i < currents_.size(); ++i) {
            const bool last = i + 1 == currents_.size();
            const bool passed = last ? !up_[i].empty() || !down_[i].empty() : !up_[i].empty() && !down_[i].empty();
            if (!passed) {
                missing += fmt::format("{}{:g}", missing.empty() ? "" : ", ", currents_[i]);
                continue;
            }
            const double up = study::median(up_[i].empty() ? down_[i] : up_[i]);
            const double down = down_[i].empty() ? up : study::median(down_[i]);
            middle[i] = 0.5 * (up + down);
        }
        if (!missing.empty()) {
            throw NotIdentifiable("no slow ramp passes " + missing +
                                  " mA both upwards and downwards: the static map and its hysteresis need a recording of the ramp experiment "
                                  "(config/scenarios/ramp.toml), slower than 10 mA/s over the whole map");
        }
        return middle;
    }

  private:
    [[nodiscard]] std::size_t nearest(double current_mA) const {
        constexpr double kNear_mA = 0.3;
        for (std::size_t i = 0; i < currents_.size(); ++i) {
            if (std::abs(current_mA - currents_[i]) < kNear_mA) return i;
        }
        return currents_.size();
    }

    std::vector<double> currents_;
    std::vector<std::vector<double>> up_, down_;
};

}  // namespace

bool shows_valve(const Recording& recording) {
    constexpr double kShortest_s = 2.0;
    const auto still =
        std::count_if(recording.samples.begin(), recording.samples.end(), [](const Sample& s) { return s.phase == phase::kStandstill; });
    return static_cast<double>(still) * recording.period_s >= kShortest_s;
}

ValveExperiment valve_experiment(const Recording& recording) {
    constexpr double kLongestGap_s = 0.05;
    ValveExperiment e{.name = recording.name, .period_s = recording.period_s, .start_s = 0.0, .current_mA = {}, .pressure_Pa = {}, .measured = {}};
    double last_s = 0.0;
    for (const Sample& s : recording.samples) {
        const bool counts = s.phase == phase::kStandstill || s.phase == phase::kRetract;
        if (!counts && s.phase != phase::kBraking) continue;
        if (e.current_mA.empty()) e.start_s = s.time_s;
        if (!e.current_mA.empty()) {
            const double gap_s = s.time_s - last_s;
            if (gap_s > kLongestGap_s) {
                throw NotIdentifiable(fmt::format(
                    "{}: {:.0f} ms without samples at {:.3f} s; expected a recording without gaps of more than {:.0f} ms while the valve works",
                    e.name, gap_s * 1e3, s.time_s, kLongestGap_s * 1e3));
            }
            for (auto missing = std::llround(gap_s / e.period_s) - 1; missing > 0; --missing) {
                e.current_mA.push_back(e.current_mA.back());
                e.pressure_Pa.push_back(0.0);
                e.measured.push_back(0);
            }
        }
        last_s = s.time_s;
        e.current_mA.push_back(s.current_mA);
        e.pressure_Pa.push_back(s.pressure_Pa);
        e.measured.push_back(counts ? 1 : 0);
    }
    return e;
}

void check_range(const ValveExperiment& e, const KnownRig& rig) {
    std::size_t pinned = 0;
    double max_mA = 0.0;
    for (std::size_t k = 0; k < e.current_mA.size(); ++k) {
        if (e.measured[k] == 0) continue;
        max_mA = std::max(max_mA, e.current_mA[k]);
        pinned += e.pressure_Pa[k] >= 0.9995 * rig.gauge_range_Pa ? 1U : 0U;
    }
    if (pinned > 3) {
        throw NotIdentifiable(
            fmt::format("{}: {} readings at the end of the pressure gauge's range ({:.1f} MPa): it saturates; expected a gauge that reaches above "
                        "the supply pressure",
                        e.name, pinned, rig.gauge_range_Pa * 1e-6));
    }
    constexpr double kRounding_mA = 0.01;
    if (max_mA > rig.map_currents.back() + kRounding_mA) {
        throw NotIdentifiable(
            fmt::format("{}: currents up to {:.2f} mA, outside of the map that was asked for ({:.2f} to {:.2f} mA); expected --currents up to there",
                        e.name, max_mA, rig.map_currents.front(), rig.map_currents.back()));
    }
}

void check_dynamics(std::span<const ValveExperiment> experiments, double dead_zone_mA) {
    constexpr double kMoves_mA = 0.5;
    constexpr std::size_t kMinChanges = 4;
    std::size_t changes = 0;
    for (const ValveExperiment& e : experiments) {
        const auto window = static_cast<std::size_t>(std::llround(0.03 / e.period_s));
        for (std::size_t k = window; k < e.current_mA.size(); ++k) {
            const double from_mA = e.current_mA[k - window];
            const double to_mA = e.current_mA[k];
            // No gauge shows the dead zone.
            if (e.measured[k] == 0 || std::min(from_mA, to_mA) <= dead_zone_mA || std::abs(to_mA - from_mA) < kMoves_mA) continue;
            ++changes;
            k += window;
        }
    }
    if (changes < kMinChanges) {
        throw NotIdentifiable(
            "the current never moves fast: natural frequency, damping and delay of eq. (6) need a recording of steps or of a sweep "
            "(config/scenarios/step.toml, sweep.toml)");
    }
}

std::vector<double> ramp_pressures_Pa(std::span<const ValveExperiment> experiments, const KnownRig& rig) {
    Branches branches(rig.map_currents);
    for (const ValveExperiment& e : experiments) branches.add(e);
    return branches.pressures();
}

}  // namespace identification
