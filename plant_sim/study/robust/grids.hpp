/// Stops that are not drawn: every speed, surface and landing once.
#pragma once

#include <cstddef>

#include "plant_sim/study/robust/uncertainty.hpp"

namespace robust {

/// Brake-on at a speed of its own.
struct BrakeOn {
    std::size_t landing = 0;
    double speed_mps = 0.0;
};

/// A runway that changes once, from the surface of one landing to that of another of the same mass.
struct SurfaceChange {
    std::size_t from = 0, to = 0;  ///< landings
    double speed_mps = 0.0;        ///< about which the wheel meets the other surface
};

/// How many stops a family has that is a grid; 0: it is drawn.
[[nodiscard]] std::size_t grid_size(const Basis& basis, Family family);

/// Stop `number` of a grid, from the beginning again after the last.
[[nodiscard]] BrakeOn brake_on_at(const Basis& basis, std::size_t number);
[[nodiscard]] SurfaceChange change_at(const Basis& basis, std::size_t number);
/// The same as a plant. A change comes 1.5 s after brake-on: long enough for the wheel to be where the law wants it.
[[nodiscard]] Draw grid_stop(const Basis& basis, Family family, std::size_t number);

}  // namespace robust
