/// What a mean tyre share gives on each surface, tabulated, for studies of many landings.
#pragma once

#include <optional>
#include <vector>

#include "rig_bridge/wear/surface_references.hpp"

namespace regulation {

/// A reference for each surface, with its results; surfaces as in the table, all equally probable.
struct Choice {
    std::vector<double> tyre_share, distance_m;  ///< of each surface
    double mean_share = 0.0;
    std::optional<double> reference{};  ///< of all surfaces; none: each has its own
};
/// The same reference on all surfaces.
[[nodiscard]] Choice choice_of(const wear::SurfaceTable& table, double reference);

/// The choices of wear::SurfaceReferences, in steps of kStep of the mean share.
class Choices {
  public:
    /// Throws as SurfaceReferences.
    Choices(const wear::SurfaceTable& table, double floor, double default_reference);

    /// The one nearest to `mean_share`.
    [[nodiscard]] const Choice& at(double mean_share) const;
    /// All, by rising mean share.
    [[nodiscard]] const std::vector<Choice>& all() const { return choices_; }

    static constexpr double kStep = 0.001;

  private:
    std::vector<Choice> choices_;
};

}  // namespace regulation
