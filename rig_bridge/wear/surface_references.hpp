/// The slip reference on each surface that stops soonest, where the tyre shall take a given share of the energy in the mean of all surfaces.
///
/// Minimise sum p_s d_s(r_s) subject to sum p_s share_s(r_s) = S. By Lagrange each surface stands where its distance rises by the same lambda for
/// more share. On lower convex hulls of the points (share, distance) lambda is the slope of an edge, so the answer is exact without a search: all
/// edges in the order of their slope, taken from every surface's lowest reference on until the mean share is S. Pure.
#pragma once

#include <cstddef>
#include <vector>

#include "rig_bridge/wear/floor.hpp"

namespace wear {

class SurfaceReferences {
  public:
    /// Surfaces as the table counts them, each with the references that the floor allows there. Throws as allowed(), and std::invalid_argument for a
    /// table whose shares do not rise.
    SurfaceReferences(const SurfaceTable& table, double floor, double default_reference);

    /// Mean shares that these references can give; the default reference's share lies between.
    [[nodiscard]] Range shares() const;
    /// Of the default reference on every surface.
    [[nodiscard]] double default_share() const;
    /// On `surface`, where the mean share shall be `mean_share`; the nearest that can be had.
    [[nodiscard]] double reference(std::size_t surface, double mean_share) const;
    /// Tyre share of a reference there, by the table.
    [[nodiscard]] double share(std::size_t surface, double reference) const;
    [[nodiscard]] const Range& range(std::size_t surface) const { return surfaces_.at(surface).range; }

    /// One more landing on `surface`: it counts for more from now on. At first all count alike, worth kPriorLandings together.
    void landed(std::size_t surface);
    /// J_mu was below the floor there: that side's bound goes to `step` before `reference`, not beyond the default.
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
