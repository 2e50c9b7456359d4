/// Mean friction over cumulative energy, without scatter, as a fitted model says it: the conditional mean of eq. (14) with every component by
/// its weight, in a table.
#pragma once

#include <vector>

#include "rig_bridge/wear/model.hpp"

namespace wear {

class MeanCurve {
  public:
    explicit MeanCurve(const Model& model);

    /// At any c_e. Linear between points of the table, and beyond the data as the model goes on (kHowItExtrapolates).
    [[nodiscard]] double operator()(double c_e_J) const;
    [[nodiscard]] double first_J() const { return first_J_; }  ///< of the data
    [[nodiscard]] double last_J() const { return last_J_; }

  private:
    double first_J_;
    double last_J_;
    double step_J_;
    double slope_before_perJ_;
    double slope_after_perJ_;
    std::vector<double> friction_;
};

}  // namespace wear
