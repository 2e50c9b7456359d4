/// Stands in for a degradation model until there is one: mean friction of a maneuver over the energy that the brake has taken, a curve of
/// the kind that Fig. 9 shows, with scatter. Made up, not identified from anything.
#pragma once

namespace wear {

struct StandInParameters {
    double friction = 0.0;    ///< of the slow stretch
    double bedding_in = 0.0;  ///< above it while new, lost over bedding_in_J
    double bedding_in_J = 1.0;
    double slow_loss = 0.0;  ///< over the whole life, linear in energy
    double wear_out = 0.0;   ///< lost at the end of life, e-fold over wear_out_J
    double wear_out_J = 1.0;
    double life_J = 1.0;
    double deviation = 0.0;  ///< standard deviation of a maneuver's mean
    double least = 0.0;      ///< nothing is below
};

class StandInLaw {
  public:
    explicit StandInLaw(const StandInParameters& parameters) : parameters_(parameters) {}

    /// Mean mu_b of the maneuver that begins after `cumulative_energy_J` >= 0; `draw` is of mean 0 and standard deviation 1.
    [[nodiscard]] double mean_friction(double cumulative_energy_J, double draw) const;

  private:
    StandInParameters parameters_;
};

}  // namespace wear
