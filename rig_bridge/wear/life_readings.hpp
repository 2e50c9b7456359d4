/// How long a part lasts, from what inspections read of its wear: linear in the energy taken (Archard), each reading with an error of its own.
///
///     LifeReadings brake(3.9e9, 0.12, 0.02);
///     brake.read(2.95e9, 0.71);
///     regulator.revise_brake_life(brake.life_J());
///
/// 1 / life is the slope of a line through the origin: its mean given all readings (normal errors and prior) is the least-squares slope, drawn to
/// the expected life's by how little lives scatter. Pure.
#pragma once

namespace wear {

class LifeReadings {
  public:
    /// `life_J` > 0 is expected, with relative standard deviation `deviation` >= 0; a reading has standard deviation `error` >= 0 of the whole part.
    LifeReadings(double life_J, double deviation, double error)
        : reading_weight_(1.0 / (error * error + kLeast * kLeast)),
          squares_(life_J * life_J / (deviation * deviation + kLeast * kLeast)),
          products_(squares_ / life_J) {}

    /// After `taken_J` > 0 since new the share `worn` of the part is gone, as read: an error may bring it below 0 or above 1.
    void read(double taken_J, double worn) {
        squares_ += reading_weight_ * taken_J * taken_J;
        products_ += reading_weight_ * taken_J * worn;
    }
    /// Not positive where the readings say that it does not wear.
    [[nodiscard]] double life_J() const { return squares_ / products_; }

  private:
    static constexpr double kLeast = 1e-6;  // no certainty is infinite: then the two could not be weighed
    double reading_weight_;
    double squares_;
    double products_;
};

}  // namespace wear
