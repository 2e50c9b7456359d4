/// Plant against reference over one stop.
#pragma once

#include "tests/model/reference/profiles.hpp"
#include "tests/model/reference/reference_plant.hpp"

struct Comparison {
    double v = 0.0;                ///< largest |v - v_ref| / v_ref
    double omega = 0.0;            ///< largest |omega - omega_ref| over the free-rolling speed v_ref / r
    double energy = 0.0;           ///< largest difference of brake or tyre energy, of the kinetic energy at the start
    double distance = 0.0;         ///< relative difference of the distance at the end
    double friction_distance = 0;  ///< the same for the numerator of eq. (16)
    double residual = 0.0;         ///< largest |eq. (8) - eq. (9)| of the plant over the kinetic energy at the start
    double end_mps = 0.0;
    bool locked = false;   ///< the reference locked at some time
    bool spun_up = false;  ///< and rolled with less than 0.01 of slip after that
};

/// Of plant::OpenLoop, judged every 1 ms; neither distances nor energies between its steps.
[[nodiscard]] Comparison compare_open_loop(const rig::RigParameters& rig, reference::Input input, const reference::Profile& profile,
                                           const reference::Options& options, double tolerance);

/// `step_s` is the plant's step; knots of `profile` must lie on its multiples.
[[nodiscard]] Comparison compare(const rig::RigParameters& rig, reference::Input input, const reference::Profile& profile, double step_s,
                                 const reference::Options& options);
