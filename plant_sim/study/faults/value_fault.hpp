/// What a sensor, a sequencer or a driver can do to its value, while the frames that carry it are sound.
#pragma once

#include <cstdint>

#include "firmware/can/rig_sample.hpp"
#include "plant_sim/study/faults/catalogue.hpp"

namespace faults {

/// What is large for a value.
struct Scale {
    double min_bias;  ///< a bias, a spike and the deviation of noise are this ...
    double max_bias;  ///< ... to this, by strength
    double full;      ///< what it reads at most
};

/// - freeze: the value at the start of the fault stays
/// - bias: an offset
/// - noise: normal, with a standard deviation
/// - spike: an offset in a share of the periods
/// - saturation: not above a share of full scale by strength; if negative, stuck at full scale
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

/// A switch: freeze as above; noise: on or off by chance, in every period; spike: turned over in a share of the periods; wrong_sign: turned over.
class SwitchFault {
  public:
    explicit SwitchFault(const Fault& fault) : fault_(fault) {}
    [[nodiscard]] bool apply(bool value, bool active, rig::Random& random);

  private:
    Fault fault_;
    bool begun_ = false;
    bool at_start_ = false;
};

/// An encoder, whose value is edge count and time. After the fault it goes on counting from where it is.
///
/// - freeze: no edge is seen any more
/// - bias: speed wrong by 2 to 50 %; noise: of 1 to 30 % in every period; spike: by 0.2 to 10 times the speed in a share of the periods
/// - saturation: not above 5 to 90 % of full scale; if negative, at full scale
/// - missing_tooth: one to three teeth in a row are gone
/// - wrong_sign: counts backwards
/// - clock_step: edge times jump by 1 ms to 100 s
class EncoderFault {
  public:
    /// `full_radps`: the speed at full scale.
    EncoderFault(const Fault& fault, double teeth, double full_radps) : fault_(fault), teeth_(teeth), full_radps_(full_radps) {}
    /// `speed_radps`: of the shaft. Call once a period of `period_s`.
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
    double edges_ = 0.0;          // that the wrong speed has passed since the start
    std::uint32_t ahead_by_ = 0;  // of the count after the fault, modulo 2^32
};

}  // namespace faults
