/// A runway whose surface changes along its length.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "rig_bridge/rig/tyre.hpp"

namespace rig {

/// Extends from `from_m` to the next patch.
struct Patch {
    double from_m = 0.0;
    Surface surface;
};

struct Runway {
    std::vector<Patch> patches;   ///< `from_m` strictly increasing; empty: one surface all along
    bool from_touchdown = false;  ///< distances count from the last touchdown, or start of rolling; otherwise from where the rig began

    /// Whether friction is eq. (4) everywhere, see Surface::plain().
    [[nodiscard]] bool plain() const {
        return std::all_of(patches.begin(), patches.end(), [](const Patch& patch) { return patch.surface.plain(); });
    }
    /// Number of patches that begin at or before a distance.
    [[nodiscard]] std::size_t begun(double distance_m) const {
        const auto begins = [](double at, const Patch& patch) { return at < patch.from_m; };
        return static_cast<std::size_t>(std::upper_bound(patches.begin(), patches.end(), distance_m, begins) - patches.begin());
    }
};

}  // namespace rig
