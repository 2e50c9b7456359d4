#include <chrono>

#include "firmware/host/controller_config.hpp"
#include "plant_sim/plc/load_served_rig.hpp"
#include "plant_sim/simulation/cell_campaign.hpp"

namespace plant_sim::simulation {

CellSetup load_cell_setup(const std::filesystem::path& config) {
    rig::bridge::RigOptions options;
    options.scenario = config / "scenarios" / "light.toml";
    options.config = config;
    options.interface = "can0";
    const rig::bridge::BridgeSetup bridge = rig::bridge::load_setup(options);
    CellSetup setup{.bridge = bridge,
                    .controller = antiskid::load_controller_config(bridge.scenario.controller),
                    .machinery = plc::load_served_rig(config, plc::Bench::landing),
                    .limits = bridge.limits};
    setup.permission_s = static_cast<double>(setup.controller.monitor.maneuver_max_age_s);
    setup.machinery.period_s = static_cast<double>(setup.controller.period_s);
    setup.machinery.watchdog_s = std::chrono::duration<double>(setup.bridge.map.bridge_timeout).count();
    setup.machinery.map_version = setup.bridge.map.version;
    return setup;
}

CellOutcome& CellOutcome::operator+=(const CellOutcome& other) {
    violations.insert(violations.end(), other.violations.begin(), other.violations.end());
    attempts += other.attempts;
    finished += other.finished;
    starts += other.starts;
    refusals += other.refusals;
    damaged += other.damaged;
    operations += other.operations;
    simulated_s += other.simulated_s;
    faulted_frames += other.faulted_frames;
    faulted_requests += other.faulted_requests;
    for (const auto& [cause, count] : other.aborts) aborts[cause] += count;
    for (std::size_t i = 0; i < begun.size(); ++i) begun.at(i) += other.begun.at(i);
    for (std::size_t i = 0; i < disk_fault_counts.size(); ++i) disk_fault_counts.at(i) += other.disk_fault_counts.at(i);
    return *this;
}

std::vector<PlannedFault> faults_of(std::uint64_t seed) {
    wear::Generator draw = wear::generator_of(seed, 0);
    return draw_faults(draw);
}

std::vector<PlannedFault> fewest_faults(const CellSetup& setup, std::uint64_t seed, std::vector<PlannedFault> faults) {
    const auto fails = [&](const std::vector<PlannedFault>& tried) { return !run_cell_campaign(setup, seed, tried).violations.empty(); };
    for (std::size_t i = faults.size(); i-- > 0;) {
        std::vector<PlannedFault> without = faults;
        without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
        if (fails(without)) faults = std::move(without);
    }
    for (PlannedFault& fault : faults) {
        constexpr double kShortest_s = 0.01;
        bool needed = false;
        while (!needed && fault.lasts_s > kShortest_s) {
            fault.lasts_s *= 0.5;
            needed = !fails(faults);
        }
        if (needed) fault.lasts_s *= 2.0;
    }
    return faults;
}

}  // namespace plant_sim::simulation
