/// Estimates a part's life from inspections of its wear, which is linear in the energy taken (Archard); each reading has an independent error.
///
///     LifeReadings brake(3.9e9, 0.12, 0.02);
///     brake.read(2.95e9, 0.71);
///     regulator.revise_brake_life(brake.life_J());
///
/// 1 / life is the slope of a line through the origin: its posterior mean (normal errors and prior) is the least-squares slope, weighted with that of
/// the expected life. Pure.
#pragma once

namespace wear {

class LifeReadings {
  public:
    /// `life_J` > 0 is expected, with relative standard deviation `deviation` >= 0; a reading has standard deviation `error` >= 0 of the whole part.
    LifeReadings(double life_J, double deviation, double error)
        : reading_weight_(1.0 / (error * error + kLeast * kLeast)),
          squares_(life_J * life_J / (deviation * deviation + kLeast * kLeast)),
          products_(squares_ / life_J) {}

    /// Adds a reading: share `worn` of the part after `taken_J` > 0 since new. The reading's error may bring it below 0 or above 1.
    void read(double taken_J, double worn) {
        squares_ += reading_weight_ * taken_J * taken_J;
        products_ += reading_weight_ * taken_J * worn;
    }
    /// The estimated life; not positive if the readings show no wear.
    [[nodiscard]] double life_J() const { return squares_ / products_; }

  private:
    static constexpr double kLeast = 1e-6;  // lower limit of the deviations, so that prior and readings can be weighted
    double reading_weight_;
    double squares_;
    double products_;
};

}  // namespace wear
