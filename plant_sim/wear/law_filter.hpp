/// What can be known of a brake by someone who is told its law (rival_laws.hpp) but not its life, level and state: the bound of every forecast that
/// learns from friction and energies.
///
/// A particle filter. Life and level do not change, so that their particles would die out: they are drawn anew about what is left, with the same
/// mean and variance (Liu and West, in Doucet et al., Sequential Monte Carlo Methods in Practice, 2001, p. 197).
#pragma once

#include "plant_sim/wear/rival_laws.hpp"

namespace wear::arena {

class LawFilter {
  public:
    static constexpr std::size_t kParticles = 3000;

    LawFilter(Law law, const Settings& settings, std::uint64_t seed);
    void learn(const Point& point);
    /// A reading of the lining, after the point before it; its error is that of the settings.
    void read(const LiningReading& reading);
    /// Friction of the next landing.
    [[nodiscard]] Expectation expected() const;
    /// `count` equally probable brakes that are not worn out.
    [[nodiscard]] std::vector<Brake> drawn(std::size_t count) const;

  private:
    void weigh(const std::vector<double>& log_likelihoods);
    void resample();

    double limit_, reading_error_;
    Generator generator_;
    std::vector<Brake> brakes_;
    std::vector<double> weights_;
    double taken_J_ = 0.0;
};

}  // namespace wear::arena
