/// Landings of a regulated life in closed loop: sensors, rounding by the codec, the real controller and the plant, with energies as the rig's meter
/// measures them. Also the table of results for each reference and surface, made from such landings, and landings made from that table.
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

/// One maneuver on one surface.
struct LandingSite {
    std::string surface;
    std::string maneuver;
    rig::LoadedRig rig;

    [[nodiscard]] double kinetic_J() const;  ///< at brake-on, after the wheel's spin-up
};

struct LandingSites {
    std::vector<LandingSite> sites;
    antiskid::control::Config controller;
    antiskid::can::Layout layout;
    std::vector<std::filesystem::path> files;  ///< all files read

    /// Mean and standard deviation of a landing's energy with all sites equally probable.
    [[nodiscard]] double mean_J() const;
    [[nodiscard]] double deviation_J() const;
};

/// Throws settings::Error naming file, line and key.
[[nodiscard]] LandingSites load_sites(const std::filesystem::path& config);

/// Runs the landings side by side on `threads`; Draw::scenario is an index of the sites. Returns the stops in the same order; they do not depend on
/// `threads`. Throws std::runtime_error naming the landing if an aircraft does not come to rest.
[[nodiscard]] std::vector<regulation::Stop> land(const LandingSites& sites, std::span<const regulation::LandingRequest> requests, unsigned threads);

/// The same from the table, without a plant, for many lives: no scatter within a surface, and no effect of the brake's friction. The table must have
/// every site's surface.
[[nodiscard]] std::vector<regulation::Stop> land_by_table(const LandingSites& sites, const wear::SurfaceTable& table,
                                                          std::span<const regulation::LandingRequest> requests);

struct CharacteriseOptions {
    std::vector<double> references;  ///< ascending
    std::uint64_t seed = 1;
    unsigned threads = 1;
    const std::atomic<bool>* stop = nullptr;
    std::function<void(std::size_t stops)> on_stops{};
};
/// Runs all sites with every reference, with a new and with a worn brake. Empty if it was stopped.
[[nodiscard]] wear::SurfaceTable characterise(const LandingSites& sites, const CharacteriseOptions& options);
/// Number of stops of characterise().
[[nodiscard]] std::size_t characterising_stops(const LandingSites& sites, const CharacteriseOptions& options);

}  // namespace plant_sim::lab
