/// What a brake in use says of its own life, by the curves of brakes that were worn out (life_curves.hpp).
///
/// For a given life the model is linear and normal: one Kalman filter for each life of a grid, weighed by likelihood. Exact, without random draws.
///
///     LifeFilter brake(curves);
///     for (each maneuver) brake.learn(point);
///     brake.ends_J(limit, 200, seed);  // energies at which friction is below the limit, equally probable
#pragma once

#include <cstdint>

#include "rig_bridge/wear/brake_filter.hpp"
#include "rig_bridge/wear/life_curves.hpp"

namespace wear {

class LifeFilter {
  public:
    static constexpr std::size_t kStates = kCurve + 2;  ///< values at the knots, the remembered part, the slope of the lining's wear
    using State = std::array<double, kStates>;

    /// Any life: Student's t of log L, as one more of the lives learnt from, at `grid` of them, at least 2.
    /// `curves` must outlive this.
    explicit LifeFilter(const LifeCurves& curves, int grid = 161);
    explicit LifeFilter(LifeCurves&&, int grid = 161) = delete;
    /// The life is known.
    [[nodiscard]] static LifeFilter of_life(const LifeCurves& curves, double life_J);

    /// Adds a point; call in the order of the maneuvers.
    void learn(const Point& point);
    /// Adds a reading of the lining. Without effect where the curves were learnt without readings.
    void read(const LiningReading& reading);

    struct Life {
        double life_J = 0.0;
        double weight = 0.0;  ///< the weights sum to 1
    };
    /// Rising.
    [[nodiscard]] std::vector<Life> lives() const;
    /// `count` equally probable lives, rising. Between two lives of the grid the probability is spread evenly.
    [[nodiscard]] std::vector<double> lives_J(std::size_t count) const;
    /// `count` equally probable energies, rising, from which on friction without scatter is below `limit`; infinite: not within two lives. With the
    /// limit that the curves were learnt for, the lives; with another, where curves drawn by `seed` cross it.
    [[nodiscard]] std::vector<double> ends_J(double limit, std::size_t count, std::uint64_t seed) const;

    /// Friction of the next maneuver.
    [[nodiscard]] Expectation expected() const;
    /// log p(friction of the next maneuver | points so far).
    [[nodiscard]] double log_density(double friction) const;

    struct Hypothesis {
        double life_J = 0.0;
        double log_prior = 0.0;
        double log_likelihood = 0.0;  ///< of the frictions
        double log_readings = 0.0;    ///< likelihood of the readings of the lining
        State state{};
        std::array<double, kStates * kStates> covariance{};
    };
    [[nodiscard]] const std::vector<Hypothesis>& hypotheses() const { return hypotheses_; }
    [[nodiscard]] double taken_J() const { return taken_J_; }

  private:
    struct Predicted {
        double mean = 0.0, variance = 0.0;
    };
    [[nodiscard]] double of_energies() const;
    [[nodiscard]] Predicted predicted(const Hypothesis& hypothesis) const;
    LifeFilter() = default;
    void add(double life_J, double deviations, double log_prior);

    const LifeCurves* curves_ = nullptr;
    std::vector<Hypothesis> hypotheses_;
    std::array<double, kEnergiesBefore> energies_{};  // relative to the mean, less 1; newest first
    double taken_J_ = 0.0;
    bool begun_ = false;
};

}  // namespace wear
