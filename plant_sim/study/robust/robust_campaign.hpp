/// Stops on drawn plants and runways, with the same draws for each law.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/can/layout.hpp"
#include "firmware/control/config.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "plant_sim/study/robust/regrip.hpp"
#include "plant_sim/study/robust/uncertainty.hpp"
#include "plant_sim/study/stop_meter.hpp"
#include "plant_sim/study/team/team.hpp"

namespace robust {

struct RobustPlanOptions {
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path controller;  ///< empty: controller.toml of `config`
    std::filesystem::path ranges;      ///< empty: uncertainty.toml of `config`
    std::vector<std::string> families{kFamilyNames.begin(), kFamilyNames.begin() + kDrawnFamilies};
    std::vector<std::string> laws{"slip", "threshold"};
    std::size_t draws = 140;  ///< of each drawn family
    std::uint64_t seed = 1;
};

/// A law in the comparison.
struct ComparedLaw {
    std::string name;
    antiskid::control::Law law{};
    bool holds_peak =
        false;  ///< at the peak slip of the surface under the wheel, given or found; otherwise the reference is Uncertainty::slip_reference
};
/// The slip law with the true peak slip of the surface under the wheel as its reference in each period: the standard for laws that must find it.
inline constexpr std::string_view kToldPeak = "told_peak";
/// Not a law but a bound: the soonest that any law could be, see soonest.hpp. Only for the grids.
inline constexpr std::string_view kSoonest = "soonest";
/// The same, but with an unknown runway ahead, and the surface under the wheel known 20 ms late, as from an observer. Only for the grid `brake_on`.
inline constexpr std::string_view kWary = "wary";
[[nodiscard]] constexpr bool is_bound(std::string_view law) {
    return law == kSoonest || law == kWary;
}

struct RobustPlan {
    Basis basis;
    antiskid::control::Config controller;
    antiskid::can::Layout layout;
    std::vector<Family> families;
    std::vector<ComparedLaw> laws;
    std::size_t draws = 0;
    std::uint64_t seed = 0;
    double drop_out_mps = 0.0;
    double demand_Pa = 0.0;
    std::string config_hash;

    /// Number of draws of a family; of a grid, the number of its stops.
    [[nodiscard]] std::size_t draws_of(Family family) const;
    [[nodiscard]] std::size_t stops() const;
};

/// Landings: light and heavy on every surface except ice, where stops take minutes. Throws settings::Error or std::invalid_argument.
[[nodiscard]] RobustPlan load_plan(const RobustPlanOptions& options);

struct DrawnStop {
    Family family{};
    std::size_t law = 0;     ///< index in RobustPlan::laws
    std::size_t number = 0;  ///< of the draw
    study::StopFigures figures;
    antiskid::control::FaultSet faults;
    std::optional<Regrip> regrip;  ///< only for the family `changes`
    /// Whether the controller named a fault, although the plant has none, and released the brakes for good.
    [[nodiscard]] bool brakes_released() const { return !faults.empty(); }
};

struct RunOptions {
    unsigned threads = 1;  ///< of each process
    const std::atomic<bool>* stop = nullptr;
    std::function<void(std::size_t done)> progress{};  ///< called by the leader
};

/// Pilot and meter of draw `number` with a law of the plan.
[[nodiscard]] study::SessionOptions session(const RobustPlan& plan, const ComparedLaw& law, std::size_t number);
/// Slip that a law of the plan holds on a surface; none: it holds no slip.
[[nodiscard]] std::optional<double> held_slip(const RobustPlan& plan, const ComparedLaw& law, const rig::Surface& surface);

/// Runs the plan in this process. Rows are in the order of families, laws and numbers, for any number of threads; incomplete if stopped.
[[nodiscard]] std::vector<DrawnStop> run(const RobustPlan& plan, const RunOptions& options);
/// Runs the plan in a team: the leader gets the same rows, the other processes none. Every process must have the same plan; one that has not throws
/// std::invalid_argument.
[[nodiscard]] std::vector<DrawnStop> run(const RobustPlan& plan, const RunOptions& options, study::team::Team& team);

}  // namespace robust
