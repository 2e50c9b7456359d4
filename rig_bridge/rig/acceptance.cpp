#include "rig_bridge/rig/acceptance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rig {

namespace {

constexpr double kDeviations = 3.0;

const record::FigureField& field_of(double record::Figures::*value) {
    return *std::find_if(record::kFigureFields.begin(), record::kFigureFields.end(),
                         [value](const record::FigureField& f) { return f.value == value; });
}

class Bands {
  public:
    explicit Bands(std::vector<Band> declared) : all_(std::move(declared)) {}

    /// Used if the scenario does not declare the figure and it scatters.
    void derive(double record::Figures::*value, double expected, double deviation) {
        const record::FigureField& figure = field_of(value);
        const bool declared = std::any_of(all_.begin(), all_.end(), [&](const Band& band) { return band.figure == &figure; });
        if (declared || !(deviation > 0.0)) return;
        all_.push_back({.figure = &figure, .min = expected - kDeviations * deviation, .max = expected + kDeviations * deviation});
    }
    [[nodiscard]] std::vector<Band> take() { return std::move(all_); }

  private:
    std::vector<Band> all_;
};

bool within(const Band& band, const record::Figures& figures) {
    const double value = figures.*band.figure->value;
    return value >= band.min && value <= band.max;
}

}  // namespace

std::vector<Band> acceptance(const Scenario& scenario, const rig::Plan& plan) {
    const Scatter& scatter = scenario.scatter;
    Bands bands(scenario.acceptance);
    const double v = plan.speed_mps, a = plan.deceleration_mps2;
    bands.derive(&record::Figures::brake_on_mps, v, scatter.speed_mps);
    if (plan.load_lift_Ns2pm2 == 0.0) bands.derive(&record::Figures::mean_load_N, plan.load_base_N, scatter.load_N);
    if (plan.law == rig::BrakeLaw::deceleration && scatter.deceleration_mps2 > 0.0) {
        const double of_speed = scatter.speed_mps / v, of_deceleration = scatter.deceleration_mps2 / a;
        const double duration_s = v / a, length_m = 0.5 * v * v / a;
        bands.derive(&record::Figures::duration_s, duration_s, duration_s * std::hypot(of_speed, of_deceleration));
        bands.derive(&record::Figures::length_m, length_m, length_m * std::hypot(2.0 * of_speed, of_deceleration));
    }
    return bands.take();
}

std::vector<std::string> out_of_tolerance(const std::vector<Band>& bands, const record::Figures& figures) {
    std::vector<std::string> keys;
    for (const Band& band : bands) {
        if (!within(band, figures)) keys.emplace_back(band.figure->key);
    }
    return keys;
}

std::string what_is_outside(const std::vector<Band>& bands, const record::Figures& figures) {
    std::string text;
    for (const Band& band : bands) {
        if (within(band, figures)) continue;
        const record::FigureField& f = *band.figure;
        text += fmt::format("{}{} {:.5g} {} ({:.5g} to {:.5g})", text.empty() ? "" : ", ", f.label, figures.*f.value * f.scale, f.unit,
                            band.min * f.scale, band.max * f.scale);
    }
    return text;
}

}  // namespace rig
