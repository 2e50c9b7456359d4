#include "plant_sim/study/faults/value_fault.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant_sim/plc/speed_sample.hpp"

namespace faults {

using antiskid::can::SpeedSample;

double ValueFault::apply(double value, bool active, rig::Random& random) {
    if (!active) return value;
    if (!begun_) at_start_ = value;
    begun_ = true;
    const double size = between(scale_.min_bias, scale_.max_bias, fault_.strength);
    const double offset = fault_.negative ? -size : size;
    switch (fault_.what.kind) {
        case Kind::freeze:
            return at_start_;
        case Kind::bias:
            return value + offset;
        case Kind::noise:
            return value + size * random.noise();
        case Kind::spike:
            return random.uniform() < fault_.share ? value + offset : value;
        case Kind::saturation:
            return fault_.negative ? scale_.full : std::min(value, fault_.strength * scale_.full);
        case Kind::wrong_sign:
            return -value;
        default:
            return value;
    }
}

bool SwitchFault::apply(bool value, bool active, rig::Random& random) {
    if (!active) return value;
    if (!begun_) at_start_ = value;
    begun_ = true;
    switch (fault_.what.kind) {
        case Kind::freeze:
            return at_start_;
        case Kind::noise:
            return random.uniform() < 0.5;
        case Kind::spike:
            return (random.uniform() < fault_.share) != value;
        case Kind::wrong_sign:
            return !value;
        default:
            return value;
    }
}

void EncoderFault::begin(const SpeedSample& sample) {
    if (begun_) return;
    begun_ = true;
    at_start_ = sample;
    shown_ = sample;
}

double EncoderFault::wrong_speed(double speed_radps, rig::Random& random) const {
    const double sign = fault_.negative ? -1.0 : 1.0;
    double wrong = speed_radps;
    switch (fault_.what.kind) {
        case Kind::bias:
            wrong = speed_radps * (1.0 + sign * between(0.02, 0.5, fault_.strength));
            break;
        case Kind::noise:
            wrong = speed_radps * (1.0 + between(0.01, 0.3, fault_.strength) * random.noise());
            break;
        case Kind::spike:
            if (random.uniform() < fault_.share) wrong = speed_radps * (1.0 + sign * between(0.2, 10.0, fault_.strength));
            break;
        case Kind::saturation:
            wrong = fault_.negative ? full_radps_ : std::min(speed_radps, between(0.05, 0.9, fault_.strength) * full_radps_);
            break;
        default:
            break;
    }
    return std::max(wrong, 0.0);
}

/// The edges of a shaft at `speed_radps` over one period that ends now.
void EncoderFault::turn(double speed_radps, double now_s, double period_s) {
    const double per_s = speed_radps * teeth_ / (2.0 * std::numbers::pi);
    const double before = std::floor(edges_);
    edges_ += per_s * period_s;
    shown_.speed_radps = static_cast<float>(speed_radps);
    if (std::floor(edges_) == before) return;
    shown_.edge_count = at_start_.edge_count + static_cast<std::uint32_t>(std::floor(edges_));
    shown_.edge_time = plc::nearest_ns(now_s - (edges_ - std::floor(edges_)) / per_s);
}

SpeedSample EncoderFault::without_teeth(const SpeedSample& sample, double speed_radps) const {
    const auto teeth = static_cast<std::uint32_t>(teeth_);
    const auto gone = 1 + static_cast<std::uint32_t>(3.0 * fault_.strength);  // the first of each turn
    const std::uint32_t passed = sample.edge_count - at_start_.edge_count;
    const std::uint32_t in_turn = passed % teeth;
    SpeedSample seen = sample;
    seen.edge_count -= passed / teeth * gone + std::min(in_turn, gone);
    if (in_turn > 0 && in_turn <= gone && speed_radps > 0.0)
        seen.edge_time -= plc::nearest_ns(in_turn * 2.0 * std::numbers::pi / teeth_ / speed_radps);
    return seen;
}

SpeedSample EncoderFault::apply(const SpeedSample& sample, double speed_radps, double now_s, double period_s, bool active, rig::Random& random) {
    if (!active) {
        SpeedSample after = sample;
        after.edge_count += ahead_by_;
        return after;
    }
    begin(sample);
    SpeedSample wrong = sample;
    switch (fault_.what.kind) {
        case Kind::freeze:
            return at_start_;
        case Kind::clock_step: {
            const auto step = plc::nearest_ns(between(1e-3, 100.0, fault_.strength));
            wrong.edge_time += fault_.negative ? -step : step;
            return wrong;
        }
        case Kind::wrong_sign:
            wrong.edge_count = at_start_.edge_count - (sample.edge_count - at_start_.edge_count);
            break;
        case Kind::missing_tooth:
            wrong = without_teeth(sample, speed_radps);
            break;
        default:
            turn(wrong_speed(speed_radps, random), now_s, period_s);
            wrong = shown_;
    }
    ahead_by_ = wrong.edge_count - sample.edge_count;
    return wrong;
}

}  // namespace faults
