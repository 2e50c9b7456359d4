/// Slip references per surface that minimise stopping distance for a given mean tyre share of the energy over all surfaces.
///
/// Minimise sum p_s d_s(r_s) subject to sum p_s share_s(r_s) = S. At the optimum (Lagrange) d distance / d share is the same lambda on every surface.
/// On the lower convex hulls of the points (share, distance) lambda is the slope of an edge, which gives the exact solution without a search:
/// starting at each surface's lowest reference, edges are taken in order of slope until the mean share is S. Pure.
#pragma once

#include <cstddef>
#include <vector>

#include "rig_bridge/wear/floor.hpp"

namespace wear {

class SurfaceReferences {
  public:
    /// Surfaces are indexed as in the table, each with the references allowed by the floor. Throws as allowed(), and std::invalid_argument for a
    /// table whose shares do not increase.
    SurfaceReferences(const SurfaceTable& table, double floor, double default_reference);

    /// Range of mean shares that these references can give; includes the default reference's share.
    [[nodiscard]] Range shares() const;
    /// Mean share with the default reference on every surface.
    [[nodiscard]] double default_share() const;
    /// Reference on `surface` for the mean share `mean_share`, or the nearest possible one.
    [[nodiscard]] double reference(std::size_t surface, double mean_share) const;
    /// Tyre share of a reference there, by the table.
    [[nodiscard]] double share(std::size_t surface, double reference) const;
    [[nodiscard]] const Range& range(std::size_t surface) const { return surfaces_.at(surface).range; }

    /// Counts a landing on `surface`, which increases its weight. Initially all have equal weight, worth kPriorLandings together.
    void landed(std::size_t surface);
    /// Call if J_mu was below the floor there: moves the bound on that side to `step` before `reference`, at most to the default.
    void narrow(std::size_t surface, double reference, double step);

    static constexpr double kPriorLandings = 20.0;

  private:
    struct Surface {
        Range range;
        double weight = 0.0;
        std::vector<double> reference{}, share{};  // allowed ones, both bounds among them
    };
    struct Edge {
        double slope_m;  // of distance over share
        std::size_t surface;
        double share0, share1;
    };
    void find_edges();
    [[nodiscard]] double all_weights() const;

    SurfaceTable table_;
    double default_reference_;
    std::vector<Surface> surfaces_;
    std::vector<Edge> edges_;  // by slope
};

}  // namespace wear
