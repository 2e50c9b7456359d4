/// Stops on a grid instead of drawn: every speed, surface and landing once.
#pragma once

#include <cstddef>

#include "plant_sim/study/robust/uncertainty.hpp"

namespace robust {

/// A stop with brake-on at a given speed.
struct BrakeOn {
    std::size_t landing = 0;
    double speed_mps = 0.0;
};

/// A runway with one change, from the surface of one landing to that of another of the same mass.
struct SurfaceChange {
    std::size_t from = 0, to = 0;  ///< indices of landings
    double speed_mps = 0.0;        ///< approximate speed at the change
};

/// Number of stops of a family that is a grid; 0: the family is drawn.
[[nodiscard]] std::size_t grid_size(const Basis& basis, Family family);

/// Stop `number` of a grid, modulo the grid's size.
[[nodiscard]] BrakeOn brake_on_at(const Basis& basis, std::size_t number);
[[nodiscard]] SurfaceChange change_at(const Basis& basis, std::size_t number);
/// The same as a plant. A change of surface comes 1.5 s after brake-on, when the wheel is at the law's reference.
[[nodiscard]] Draw grid_stop(const Basis& basis, Family family, std::size_t number);

}  // namespace robust
