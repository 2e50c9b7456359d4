#include "plant_sim/study/identification/valve_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant_sim/study/identification/valve_response.hpp"

namespace identification {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kNearZero_Pa = 0.15e6;  // below, a gauge's noise is cut off at zero
constexpr double kShortest_s = 2.0;      // of a standstill that is an experiment
constexpr double kSettled_s = 0.3;       // after a change of this much the static map shows
constexpr double kRamp_mAps = 10.0;      // slower is a ramp
constexpr double kMoves_mA = 0.5;
constexpr double kLongestGap_s = 0.05;
constexpr double kLeastLevels = 4;

/// The part of a recording that counts, on a grid of periods.
struct Experiment {
    std::string name;
    double period_s = 0.0;
    double start_s = 0.0;
    std::vector<double> current_mA;
    std::vector<double> pressure_Pa;
    std::vector<std::uint8_t> measured;  ///< false where samples were missing
};

/// The current is followed from the start of braking, so that the valve's state at standstill is known; pressures count at standstill only.
Experiment experiment(const Recording& recording) {
    Experiment e{.name = recording.name,
                 .period_s = recording.period_s,
                 .start_s = 0.0,
                 .current_mA = {},
                 .pressure_Pa = {},
                 .measured = {}};
    double last_s = 0.0;
    for (const Sample& s : recording.samples) {
        const bool counts = s.phase == phase::kStandstill || s.phase == phase::kRetract;
        if (!counts && s.phase != phase::kBraking) continue;
        if (e.current_mA.empty()) e.start_s = s.time_s;
        if (!e.current_mA.empty()) {
            const double gap_s = s.time_s - last_s;
            if (gap_s > kLongestGap_s) {
                throw NotIdentifiable(fmt::format(
                    "{}: {:.0f} ms without samples at {:.3f} s; expected a recording without gaps of "
                    "more than {:.0f} ms while the valve works",
                    e.name, gap_s * 1e3, s.time_s, kLongestGap_s * 1e3));
            }
            for (auto missing = std::llround(gap_s / e.period_s) - 1; missing > 0; --missing) {
                e.current_mA.push_back(e.current_mA.back());
                e.pressure_Pa.push_back(0.0);
                e.measured.push_back(0);
            }
        }
        last_s = s.time_s;
        e.current_mA.push_back(s.current_mA);
        e.pressure_Pa.push_back(s.pressure_Pa);
        e.measured.push_back(counts ? 1 : 0);
    }
    return e;
}

bool is_experiment(const Recording& recording) {
    const auto still = std::count_if(recording.samples.begin(), recording.samples.end(),
                                     [](const Sample& s) { return s.phase == phase::kStandstill; });
    return static_cast<double>(still) * recording.period_s >= kShortest_s;
}

void check_range(const Experiment& e, const KnownRig& rig) {
    std::size_t pinned = 0;
    double most_mA = 0.0;
    for (std::size_t k = 0; k < e.current_mA.size(); ++k) {
        if (e.measured[k] == 0) continue;
        most_mA = std::max(most_mA, e.current_mA[k]);
        pinned += e.pressure_Pa[k] >= 0.9995 * rig.gauge_range_Pa ? 1U : 0U;
    }
    if (pinned > 3) {
        throw NotIdentifiable(fmt::format(
            "{}: {} readings at the end of the pressure gauge's range ({:.1f} MPa): it saturates; expected a "
            "gauge that reaches above the supply pressure",
            e.name, pinned, rig.gauge_range_Pa * 1e-6));
    }
    constexpr double kRounding_mA = 0.01;
    if (most_mA > rig.map_currents.back() + kRounding_mA) {
        throw NotIdentifiable(fmt::format(
            "{}: currents up to {:.2f} mA, outside of the map that was asked for ({:.2f} to {:.2f} mA); "
            "expected --currents up to there",
            e.name, most_mA, rig.map_currents.front(), rig.map_currents.back()));
    }
}

/// What rising and falling ramps say of the static map, without regard to the lag: a start for the fit, and the check that there are ramps.
class Branches {
  public:
    explicit Branches(const std::vector<double>& currents)
        : currents_(currents), up_(currents.size()), down_(currents.size()) {}

    void add(const Experiment& e) {
        const auto half = static_cast<std::size_t>(std::llround(0.5 * kSettled_s / e.period_s));
        if (e.current_mA.size() <= 2 * half) return;
        for (std::size_t k = half; k + half < e.current_mA.size(); ++k) {
            if (e.measured[k] == 0) continue;
            const double change_mA = e.current_mA[k + half] - e.current_mA[k - half];
            const double slope = change_mA / (2.0 * static_cast<double>(half) * e.period_s);
            // A ramp moves half its way in half the time; a step does not.
            const double middle_mA = e.current_mA[k] - e.current_mA[k - half];
            if (std::abs(slope) > kRamp_mAps || std::abs(change_mA) < 0.05 ||
                std::abs(middle_mA - 0.5 * change_mA) > 0.2 * std::abs(change_mA) + 0.06)
                continue;
            const std::size_t node = nearest(e.current_mA[k]);
            if (node == currents_.size()) continue;
            (change_mA > 0.0 ? up_ : down_)[node].push_back(e.pressure_Pa[k]);
        }
    }

    /// Throws where a point of the map has not been passed both ways. The first point, of no pressure, and the last, where a ramp turns,
    /// need one way.
    [[nodiscard]] std::vector<double> pressures() const {
        std::vector<double> middle(currents_.size(), 0.0);
        std::string missing;
        for (std::size_t i = 1; i < currents_.size(); ++i) {
            const bool last = i + 1 == currents_.size();
            const bool passed =
                last ? !up_[i].empty() || !down_[i].empty() : !up_[i].empty() && !down_[i].empty();
            if (!passed) {
                missing += fmt::format("{}{:g}", missing.empty() ? "" : ", ", currents_[i]);
                continue;
            }
            const double up = up_[i].empty() ? median(down_[i]) : median(up_[i]);
            const double down = down_[i].empty() ? up : median(down_[i]);
            middle[i] = 0.5 * (up + down);
        }
        if (!missing.empty()) {
            throw NotIdentifiable(
                "no slow ramp passes " + missing +
                " mA both upwards and downwards: the static map and its hysteresis need a recording of the "
                "ramp "
                "experiment (config/scenarios/ramp.toml), slower than 10 mA/s over the whole map");
        }
        return middle;
    }

  private:
    [[nodiscard]] std::size_t nearest(double current_mA) const {
        constexpr double kNear_mA = 0.3;
        for (std::size_t i = 0; i < currents_.size(); ++i) {
            if (std::abs(current_mA - currents_[i]) < kNear_mA) return i;
        }
        return currents_.size();
    }
    [[nodiscard]] static double median(std::vector<double> v) {
        const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
        std::nth_element(v.begin(), middle, v.end());
        return *middle;
    }

    std::vector<double> currents_;
    std::vector<std::vector<double>> up_, down_;
};

void check_dynamics(std::span<const Experiment> experiments, double dead_zone_mA) {
    std::size_t changes = 0;
    for (const Experiment& e : experiments) {
        const auto window = static_cast<std::size_t>(std::llround(0.03 / e.period_s));
        for (std::size_t k = window; k < e.current_mA.size(); ++k) {
            const double from_mA = e.current_mA[k - window];
            const double to_mA = e.current_mA[k];
            // What happens in the dead zone no gauge sees.
            if (e.measured[k] == 0 || std::min(from_mA, to_mA) <= dead_zone_mA ||
                std::abs(to_mA - from_mA) < kMoves_mA)
                continue;
            ++changes;
            k += window;
        }
    }
    if (static_cast<double>(changes) < kLeastLevels) {
        throw NotIdentifiable(
            "the current never moves fast: natural frequency, damping and delay of eq. (6) need a recording "
            "of steps or of a "
            "sweep (config/scenarios/step.toml, sweep.toml)");
    }
}

/// theta: dead zone (mA), pressures (MPa), hysteresis (mA), natural frequency (rad/s), damping, delay (ms).
struct Shape {
    std::vector<double> current_mA;

    [[nodiscard]] Index pressures() const { return static_cast<Index>(current_mA.size()); }
    [[nodiscard]] Index hysteresis() const { return 1 + pressures(); }
    [[nodiscard]] Index size() const { return 5 + pressures(); }

    [[nodiscard]] plant::PressureMap map(const VectorXd& theta) const {
        std::vector<plant::PressureMap::Point> points;
        points.reserve(current_mA.size() + 1);
        points.push_back({theta[0], 0.0});
        // A trial of the fit may fall from point to point; the map of a valve does not.
        for (Index i = 0; i < pressures(); ++i) {
            points.push_back({current_mA[static_cast<std::size_t>(i)],
                              std::max(theta[1 + i] * 1e6, points.back().pressure_Pa)});
        }
        return plant::PressureMap(std::move(points));
    }
    [[nodiscard]] plant::ValveParameters valve(const VectorXd& theta) const {
        return {.natural_frequency_radps = theta[hysteresis() + 1],
                .damping = theta[hysteresis() + 2],
                .delay_s = theta[hysteresis() + 3] * 1e-3,
                .hysteresis_mA = theta[hysteresis()]};
    }
    [[nodiscard]] std::vector<std::string> names() const {
        std::vector<std::string> all{"the dead zone"};
        all.reserve(static_cast<std::size_t>(size()));
        for (const double current : current_mA)
            all.push_back(fmt::format("the pressure at {:g} mA", current));
        for (const char* name : {"hysteresis", "natural frequency", "damping", "delay"})
            all.emplace_back(name);
        return all;
    }
};

LeastSquares problem(const Shape& shape, double dead_zone_mA, const std::vector<double>& pressures) {
    // Where dynamics start does not matter much: any valve that can hold a wheel lies within a factor of three of this.
    constexpr double kStart_radps = 2.0 * std::numbers::pi * 12.0;
    LeastSquares p;
    const Index n = shape.size();
    p.start.resize(n);
    p.scale.resize(n);
    p.least.resize(n);
    p.most.resize(n);
    const auto set = [&p](Index i, double start, double scale, double least, double most) {
        p.start[i] = start;
        p.scale[i] = scale;
        p.least[i] = least;
        p.most[i] = most;
    };
    constexpr double kApart_mA = 0.05;
    set(0, dead_zone_mA, 0.1, 0.0, shape.current_mA.front() - kApart_mA);
    for (Index i = 0; i < shape.pressures(); ++i)
        set(1 + i, pressures[static_cast<std::size_t>(i) + 1] * 1e-6, 0.1, 0.0, 1e3);
    set(shape.hysteresis(), 0.0, 0.1, -10.0, 10.0);
    set(shape.hysteresis() + 1, kStart_radps, 10.0, 3.0, 1000.0);
    set(shape.hysteresis() + 2, 0.7, 0.1, 0.06, 0.985);
    set(shape.hysteresis() + 3, 4.0, 1.0, 0.0, 60.0);
    return p;
}

/// The modelled pressure of every experiment, and which samples count.
class Model {
  public:
    Model(const Shape& shape, std::span<const Experiment> experiments, double range_Pa)
        : shape_(shape), experiments_(experiments), range_Pa_(range_Pa) {
        modelled_.reserve(experiments.size());
        used_.reserve(experiments.size());
        for (const Experiment& e : experiments) {
            modelled_.emplace_back(e.current_mA.size());
            used_.emplace_back(e.current_mA.size());
        }
    }

    void run(const VectorXd& theta) {
        const plant::PressureMap map = shape_.map(theta);
        const plant::ValveParameters valve = shape_.valve(theta);
        for (std::size_t i = 0; i < experiments_.size(); ++i)
            valve_response(experiments_[i].current_mA, experiments_[i].period_s, map, valve, modelled_[i]);
    }
    /// By what the model says, not by the reading: a choice by the reading would be a choice by its noise.
    void choose() {
        count_ = 0;
        for (std::size_t i = 0; i < experiments_.size(); ++i) {
            for (std::size_t k = 0; k < used_[i].size(); ++k) {
                const double p = modelled_[i][k];
                used_[i][k] =
                    experiments_[i].measured[k] != 0 && p > kNearZero_Pa && p < range_Pa_ - kNearZero_Pa ? 1
                                                                                                         : 0;
                count_ += used_[i][k];
            }
        }
    }
    void residuals(VectorXd& out) const {
        out.resize(static_cast<Index>(count_));
        Index row = 0;
        for (std::size_t i = 0; i < experiments_.size(); ++i) {
            for (std::size_t k = 0; k < used_[i].size(); ++k) {
                if (used_[i][k] != 0) out[row++] = (experiments_[i].pressure_Pa[k] - modelled_[i][k]) * 1e-6;
            }
        }
    }
    [[nodiscard]] std::size_t count() const { return count_; }

    [[nodiscard]] std::vector<ValveResiduals> report() const {
        std::vector<ValveResiduals> all;
        all.reserve(experiments_.size());
        for (std::size_t i = 0; i < experiments_.size(); ++i) {
            const Experiment& e = experiments_[i];
            ValveResiduals r{.recording = e.name,
                             .rms_Pa = 0.0,
                             .time_s = {},
                             .current_mA = e.current_mA,
                             .measured_Pa = e.pressure_Pa,
                             .modelled_Pa = modelled_[i],
                             .used = used_[i]};
            r.time_s.reserve(e.current_mA.size());
            double sum = 0.0;
            double n = 0.0;
            for (std::size_t k = 0; k < e.current_mA.size(); ++k) {
                r.time_s.push_back(static_cast<double>(k) * e.period_s);
                if (used_[i][k] == 0) continue;
                const double error = e.pressure_Pa[k] - modelled_[i][k];
                sum += error * error;
                n += 1.0;
            }
            r.rms_Pa = n > 0.0 ? std::sqrt(sum / n) : 0.0;
            all.push_back(std::move(r));
        }
        return all;
    }

  private:
    const Shape& shape_;
    std::span<const Experiment> experiments_;
    double range_Pa_;
    std::vector<std::vector<double>> modelled_;
    std::vector<std::vector<std::uint8_t>> used_;
    std::size_t count_ = 0;
};

/// dP/dI of the map where half the full pressure is.
double middle_slope(const plant::PressureMap& map) {
    const auto& points = map.points();
    const double half_Pa = 0.5 * points.back().pressure_Pa;
    std::size_t i = 1;
    while (i + 1 < points.size() && points[i].pressure_Pa < half_Pa) ++i;
    return (points[i].pressure_Pa - points[i - 1].pressure_Pa) /
           (points[i].current_mA - points[i - 1].current_mA);
}

void check_known(const Estimate& e, const char* name, const char* unit) {
    constexpr double kWorst = 0.25;
    if (e.high - e.value <= kWorst * e.value) return;
    throw NotIdentifiable(
        fmt::format("too little excitation: {} is {:.3g} {} to {:.3g} {}, which says nothing; expected more "
                    "or larger steps, "
                    "or a sweep beyond the valve's frequency (config/scenarios/step.toml, sweep.toml)",
                    name, e.low, unit, e.high, unit));
}

}  // namespace

plant::PressureMap ValveFit::map() const {
    std::vector<plant::PressureMap::Point> points;
    points.reserve(current_mA.size() + 1);
    points.push_back({dead_zone_mA.value, 0.0});
    for (std::size_t i = 0; i < current_mA.size(); ++i)
        points.push_back({current_mA[i], pressure_Pa[i].value});
    return plant::PressureMap(std::move(points));
}

ValveFit fit_valve(std::span<const Recording> recordings, const KnownRig& rig) {
    std::vector<Experiment> experiments;
    for (const Recording& recording : recordings) {
        check(recording);
        if (is_experiment(recording)) experiments.push_back(experiment(recording));
    }
    if (experiments.empty()) {
        throw NotIdentifiable(
            "no recording has the valve at work while the flywheel stands: the valve needs the experiments "
            "ramp, step and sweep "
            "(config/scenarios)");
    }
    Branches branches(rig.map_currents);
    for (const Experiment& e : experiments) {
        check_range(e, rig);
        branches.add(e);
    }
    const std::vector<double> start_Pa = branches.pressures();
    check_dynamics(experiments, rig.map_currents.front());

    const Shape shape{{rig.map_currents.begin() + 1, rig.map_currents.end()}};
    const std::vector<std::string> names = shape.names();
    LeastSquares least = problem(shape, rig.map_currents.front(), start_Pa);
    constexpr double kBatch_s = 0.01;
    least.batch = std::max(1, static_cast<int>(std::lround(kBatch_s / experiments.front().period_s)));
    Model model(shape, experiments, rig.gauge_range_Pa);
    const auto evaluate = [&model](const VectorXd& theta, VectorXd& residuals) {
        model.run(theta);
        model.residuals(residuals);
    };
    Fit found;
    // Which samples count follows from the model, so it settles with it.
    for (int round = 0; round < 2; ++round) {
        model.run(least.start);
        model.choose();
        found = fit(least, names, evaluate);
        least.start = found.theta;
    }
    model.run(found.theta);

    ValveFit out;
    out.current_mA = shape.current_mA;
    const int band = static_cast<int>(shape.current_mA.size()) + 1;
    out.dead_zone_mA = found.estimate(0, band);
    for (Index i = 0; i < shape.pressures(); ++i)
        out.pressure_Pa.push_back(scaled(found.estimate(1 + i, band), 1e6));
    out.hysteresis_mA = found.estimate(shape.hysteresis());
    out.natural_frequency_Hz = scaled(found.estimate(shape.hysteresis() + 1), 0.5 / std::numbers::pi);
    out.damping = found.estimate(shape.hysteresis() + 2);
    out.delay_s = scaled(found.estimate(shape.hysteresis() + 3), 1e-3);
    check_known(out.natural_frequency_Hz, "the natural frequency", "Hz");
    check_known(out.damping, "the damping", "");
    out.rms_Pa = found.rms * 1e6;
    out.residual_correlation = found.first_correlation;
    out.lags_s = found.lags * least.batch * experiments.front().period_s;
    out.residuals = model.report();
    out.hysteresis_Pa = scaled(out.hysteresis_mA, middle_slope(out.map()));
    return out;
}

}  // namespace identification
