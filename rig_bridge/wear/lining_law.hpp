/// Physical model of lining wear: run-in of the contact area, wear after Archard (1953), and a core with less friction when the lining is nearly
/// gone. Scatter comes from temperature, correlated between maneuvers, which friction follows with hysteresis (a play operator). It contains no
/// Gaussian mixture, so that a wear model fitted to its campaigns is tested independently. The numbers are assumptions [A].
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "rig_bridge/wear/draw.hpp"

namespace wear {

struct LiningLaw {
    double plateau = 0.26;             ///< friction of a run-in brake with all of its lining
    double run_in = 0.06;              ///< above the plateau while the contact is new
    double run_in_J = 12e6;            ///< that the contact takes to run in
    double loss = 0.04;                ///< over the whole lining, linear in what is worn
    double lining_J = 500e6;           ///< that the lining lasts
    double core_loss = 0.05;           ///< lost at the end
    double core_share = 0.06;          ///< of the lining's life in which the core is met
    double per_temperature = -0.0035;  ///< change of friction a standard deviation of temperature
    double memory = 0.6;               ///< of temperature from one maneuver to the next, 0 to 0.75
    double play = 0.8;                 ///< half width of the hysteresis, in deviations of temperature
    double measurement = 0.0012;       ///< standard deviation of what is new in each maneuver
    bool operator==(const LiningLaw&) const = default;
};

/// Temperature of successive maneuvers in standard deviations from its mean, and its part that friction follows. Draws are normal().
class LiningTemperature {
  public:
    explicit LiningTemperature(double draw) : temperature_(draw), following_(draw) {}

    /// Advances by one maneuver.
    void step(const LiningLaw& law, double draw);
    [[nodiscard]] double temperature() const { return temperature_; }
    [[nodiscard]] double following() const { return following_; }

  private:
    double temperature_;
    double following_;  // lags behind temperature within the play
};

/// Friction without scatter when `worn_J` >= 0 of the lining is used up.
[[nodiscard]] double expected_friction(const LiningLaw& law, double worn_J);

/// Scatter of a lining's friction per maneuver: a pure function of the brake's seed and the maneuver's number, so that a brake can be continued from
/// any maneuver. Uses the temperatures of the last 24 maneuvers; each draw has its own generator.
class LiningScatter {
  public:
    LiningScatter(std::uint64_t seed, std::uint64_t number);

    /// Advances by one maneuver; seeds one generator, the constructor 25.
    void next();
    /// Mean friction of the maneuver when `worn_J` of the lining is used up.
    [[nodiscard]] double friction(const LiningLaw& law, double worn_J) const;

  private:
    static constexpr std::size_t kRemembered = 24;  // 0.75^24 = 0.1 %
    void draw(std::uint64_t stream);

    std::uint64_t seed_;
    std::uint64_t number_;
    std::array<double, kRemembered + 1> temperatures_{};  // by stream, modulo their number
    double measurement_ = 0.0;
};

}  // namespace wear
