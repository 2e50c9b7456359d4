/// E step and the sums of the M step in one pass over the points. Internal to em.
#pragma once

#include <array>
#include <cstddef>

#include "rig_bridge/wear/em.hpp"

namespace wear {

constexpr std::size_t kLanes = 8;  ///< partial sums, added up in this order on every machine

/// A component as the E step needs it: log density = level - (z1^2 + z2^2) / 2 with z = L^-1 (x - mu).
struct Whitened {
    double mx, my, i11, i21, i22, level;
};

/// Sums over the points of responsibility times 1, d, d d', with d = x - mu.
struct Moments {
    double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
};

struct Pass {
    std::array<Moments, kMaxSearched> moments;
    double log_likelihood = 0.0;
};

/// Uses the machine's widest vector unit; results do not depend on it.
void pass(const StandardPoints& points, const Whitened* components, std::size_t count, Pass& out);

}  // namespace wear
