/// The landings of a regulated life in closed loop: sensors, codec rounding, the real controller and the plant, energies as the rig's meter
/// counts them. And the table of what references give on each surface, made of such landings, and landings made of that table.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "firmware/can/layout.hpp"
#include "firmware/control/config.hpp"
#include "plant_sim/study/regulation/life.hpp"
#include "rig_bridge/rig/load_rig.hpp"
#include "rig_bridge/wear/regulation_config.hpp"

namespace plant_sim::lab {

/// Every surface under every maneuver of the configuration.
struct LandingSite {
    std::string surface;
    std::string maneuver;
    rig::LoadedRig rig;

    [[nodiscard]] double kinetic_J() const;  ///< at brake-on, after what the wheel's spin-up has cost the aircraft
};

struct LandingSites {
    std::vector<LandingSite> sites;
    antiskid::control::Config controller;
    antiskid::can::Layout layout;
    std::vector<std::filesystem::path> files;  ///< that were read

    /// Mean and deviation of a landing's energy where every site is as likely as any other.
    [[nodiscard]] double mean_J() const;
    [[nodiscard]] double deviation_J() const;
};

/// Throws settings::Error naming file, line and key.
[[nodiscard]] LandingSites load_sites(const std::filesystem::path& config);

/// All these landings, side by side on `threads`; Draw::scenario counts the sites. The stops, in the same order, do not depend on `threads`. Throws
/// std::runtime_error, naming the landing, when an aircraft did not come to rest.
[[nodiscard]] std::vector<regulation::Stop> land(const LandingSites& sites, std::span<const regulation::LandingRequest> requests, unsigned threads);

/// The same without a plant, by the table: no scatter within a surface, and a brake's friction makes no difference. For many lives. Every site's
/// surface must be in the table.
[[nodiscard]] std::vector<regulation::Stop> land_by_table(const LandingSites& sites, const wear::SurfaceTable& table,
                                                          std::span<const regulation::LandingRequest> requests);

struct CharacteriseOptions {
    std::vector<double> references;  ///< rising
    std::uint64_t seed = 1;
    unsigned threads = 1;
    const std::atomic<bool>* stop = nullptr;
    std::function<void(std::size_t stops)> on_stops{};
};
/// All sites with every reference, the brake new and worn out. Empty when it was stopped.
[[nodiscard]] wear::SurfaceTable characterise(const LandingSites& sites, const CharacteriseOptions& options);
/// How many stops that takes.
[[nodiscard]] std::size_t characterising_stops(const LandingSites& sites, const CharacteriseOptions& options);

}  // namespace plant_sim::lab
