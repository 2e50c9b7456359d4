/// Faults of a value that is sent in undamaged frames, by a sensor, a sequencer or a driver.
#pragma once

#include <cstdint>

#include "firmware/can/rig_sample.hpp"
#include "plant_sim/study/faults/catalogue.hpp"

namespace faults {

/// Magnitudes for a value.
struct Scale {
    double min_bias;  ///< a bias, a spike and the deviation of noise are from this ...
    double max_bias;  ///< ... to this, by strength
    double full;      ///< largest reading
};

/// - freeze: the value keeps its reading at the fault's beginning
/// - bias: an offset
/// - noise: normally distributed, with a standard deviation
/// - spike: an offset in a share of the periods
/// - saturation: limited to a share of full scale, by strength; if negative, constantly full scale
/// - wrong_sign
class ValueFault {
  public:
    ValueFault(const Fault& fault, const Scale& scale) : fault_(fault), scale_(scale) {}
    [[nodiscard]] double apply(double value, bool active, rig::Random& random);

  private:
    Fault fault_;
    Scale scale_;
    bool begun_ = false;
    double at_start_ = 0.0;
};

/// Faults of a switch. freeze: as above; noise: random in every period; spike: inverted in a share of the periods; wrong_sign: inverted.
class SwitchFault {
  public:
    explicit SwitchFault(const Fault& fault) : fault_(fault) {}
    [[nodiscard]] bool apply(bool value, bool active, rig::Random& random);

  private:
    Fault fault_;
    bool begun_ = false;
    bool at_start_ = false;
};

/// Faults of an encoder, whose value is edge count and time. After the fault it continues to count from its present count.
///
/// - freeze: no further edges
/// - bias: speed wrong by 2 to 50 %; noise: by 1 to 30 % in every period; spike: by 0.2 to 10 times the speed in a share of the periods
/// - saturation: limited to 5 to 90 % of full scale; if negative, full scale
/// - missing_tooth: one to three adjacent teeth are missing
/// - wrong_sign: counts backwards
/// - clock_step: edge times jump by 1 ms to 100 s
class EncoderFault {
  public:
    /// `full_radps`: speed at full scale.
    EncoderFault(const Fault& fault, double teeth, double full_radps) : fault_(fault), teeth_(teeth), full_radps_(full_radps) {}
    /// Call once a period of `period_s`. `speed_radps`: speed of the shaft.
    [[nodiscard]] antiskid::can::SpeedSample apply(const antiskid::can::SpeedSample& sample, double speed_radps, double now_s, double period_s,
                                                   bool active, rig::Random& random);

  private:
    [[nodiscard]] double wrong_speed(double speed_radps, rig::Random& random) const;
    void begin(const antiskid::can::SpeedSample& sample);
    void turn(double speed_radps, double now_s, double period_s);
    [[nodiscard]] antiskid::can::SpeedSample without_teeth(const antiskid::can::SpeedSample& sample, double speed_radps) const;

    Fault fault_;
    double teeth_;
    double full_radps_;
    bool begun_ = false;
    antiskid::can::SpeedSample at_start_;
    antiskid::can::SpeedSample shown_;
    double edges_ = 0.0;          // of the wrong speed since the fault's beginning
    std::uint32_t ahead_by_ = 0;  // offset of the count after the fault, modulo 2^32
};

}  // namespace faults
