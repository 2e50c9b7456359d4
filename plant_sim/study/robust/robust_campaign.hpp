/// Stops on drawn plants and runways: every law on the same draws.
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
    std::size_t draws = 140;  ///< of each family that is drawn
    std::uint64_t seed = 1;
};

/// A law as a campaign compares it.
struct Peer {
    std::string name;
    antiskid::control::Law law{};
    bool holds_peak = false;  ///< of the surface under the wheel: told it, or found; otherwise Uncertainty::slip_reference
};
/// The slip law, told at each period where the peak of the surface under the wheel is: what a law that must find it is measured against.
inline constexpr std::string_view kToldPeak = "told_peak";
/// No law but what no law can have sooner: soonest.hpp. Of the grids alone.
inline constexpr std::string_view kSoonest = "soonest";
/// As soonest, but the runway ahead is not known, and what is under the wheel is seen 20 ms late, as an observer sees it. Of the grid `brake_on`
/// alone.
inline constexpr std::string_view kWary = "wary";
[[nodiscard]] constexpr bool is_bound(std::string_view law) {
    return law == kSoonest || law == kWary;
}

struct RobustPlan {
    Basis basis;
    antiskid::control::Config controller;
    antiskid::can::Layout layout;
    std::vector<Family> families;
    std::vector<Peer> laws;
    std::size_t draws = 0;
    std::uint64_t seed = 0;
    double drop_out_mps = 0.0;
    double demand_Pa = 0.0;
    std::string config_hash;

    /// Of a grid, all its stops.
    [[nodiscard]] std::size_t draws_of(Family family) const;
    [[nodiscard]] std::size_t stops() const;
};

/// Landings: light and heavy on every surface but ice, whose stops are minutes long. Throws settings::Error or std::invalid_argument.
[[nodiscard]] RobustPlan load_plan(const RobustPlanOptions& options);

struct Row {
    Family family{};
    std::size_t law = 0;     ///< of RobustPlan::laws
    std::size_t number = 0;  ///< of the draw
    study::StopFigures figures;
    antiskid::control::FaultSet faults;
    std::optional<Regrip> regrip;  ///< of the family `changes`
    [[nodiscard]] bool tripped() const { return !faults.empty(); }
};

struct RunOptions {
    unsigned threads = 1;  ///< of each process
    const std::atomic<bool>* stop = nullptr;
    std::function<void(std::size_t done)> progress{};  ///< by the leader
};

/// How draw `number` is braked with a law of the plan.
[[nodiscard]] study::SessionOptions session(const RobustPlan& plan, const Peer& law, std::size_t number);
/// The slip that a law of the plan holds on a surface, if it holds one.
[[nodiscard]] std::optional<double> held_slip(const RobustPlan& plan, const Peer& law, const rig::Surface& surface);

/// By this process alone: in the order of families, laws and numbers, whatever the threads. Less than all of them where it was stopped.
[[nodiscard]] std::vector<Row> run(const RobustPlan& plan, const RunOptions& options);
/// The same rows for the leader of a team, nothing for the others. Every process must be given the same plan: one that was not throws
/// std::invalid_argument.
[[nodiscard]] std::vector<Row> run(const RobustPlan& plan, const RunOptions& options, study::team::Team& team);

}  // namespace robust
