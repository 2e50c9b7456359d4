/// Stops on drawn plants and runways: every law on the same draws.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "config/reader/config_directory.hpp"
#include "firmware/can/layout.hpp"
#include "firmware/control/config.hpp"
#include "plant_sim/study/robust/uncertainty.hpp"
#include "plant_sim/study/stop_meter.hpp"
#include "plant_sim/study/team/team.hpp"

namespace robust {

struct PlanOptions {
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path controller;  ///< empty: controller.toml of `config`
    std::filesystem::path ranges;      ///< empty: uncertainty.toml of `config`
    std::vector<std::string> families{kFamilyNames.begin(), kFamilyNames.end()};
    std::vector<std::string> laws{"slip", "threshold"};
    std::size_t draws = 140;  ///< of each family
    std::uint64_t seed = 1;
};

struct Plan {
    Basis basis;
    antiskid::control::Config controller;
    antiskid::can::Layout layout;
    std::vector<Family> families;
    std::vector<antiskid::control::Law> laws;
    std::vector<std::string> law_names;
    std::size_t draws = 0;
    std::uint64_t seed = 0;
    double drop_out_mps = 0.0;
    double demand_Pa = 0.0;
    std::string config_hash;

    [[nodiscard]] std::size_t stops() const { return families.size() * laws.size() * draws; }
};

/// Landings: light and heavy on every surface but ice, whose stops are minutes long. Throws settings::Error or std::invalid_argument.
[[nodiscard]] Plan load_plan(const PlanOptions& options);

struct Row {
    Family family{};
    std::size_t law = 0;     ///< of Plan::laws
    std::size_t number = 0;  ///< of the draw
    study::StopFigures figures;
    antiskid::control::FaultSet faults;
    double travel_mAps = 0.0;  ///< of the valve current, from brake-on to drop-out
    [[nodiscard]] bool tripped() const { return !faults.empty(); }
};

struct RunOptions {
    unsigned threads = 1;  ///< of each process
    const std::atomic<bool>* stop = nullptr;
    std::function<void(std::size_t done)> progress{};  ///< by the leader
};

/// How draw `number` is braked with a law of the plan.
[[nodiscard]] study::SessionOptions session(const Plan& plan, antiskid::control::Law law, std::size_t number);

/// By this process alone: in the order of families, laws and numbers, whatever the threads. Less than all of them where it was stopped.
[[nodiscard]] std::vector<Row> run(const Plan& plan, const RunOptions& options);
/// The same rows for the leader of a team, nothing for the others. Every process must be given the same plan: one that was not throws
/// std::invalid_argument.
[[nodiscard]] std::vector<Row> run(const Plan& plan, const RunOptions& options, study::Team& team);

}  // namespace robust
