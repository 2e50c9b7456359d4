#include "plant_sim/study/margins/margins.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace study::margins {

namespace {

constexpr double kShortest = 1e-12;  // shortest step, relative
constexpr double kOnPoint = 1e-9;    // a locus this close to -1 is on it
constexpr double kReal = 1e-9;       // imaginary part of what counts as real, relative
constexpr double kCrossing = 1e-10;  // relative width of a bracketed crossing

struct Point {
    Complex s;
    std::vector<Complex> loci;
};

/// Orders `loci` by their distance to `before`.
void follow(const std::vector<Complex>& before, std::vector<Complex>& loci) {
    for (std::size_t i = 0; i + 1 < loci.size(); ++i) {
        std::size_t nearest = i;
        for (std::size_t j = i + 1; j < loci.size(); ++j)
            if (std::abs(loci[j] - before[i]) < std::abs(loci[nearest] - before[i])) nearest = j;
        std::swap(loci[i], loci[nearest]);
    }
}

Point point(const Loop& loop, Complex s) {
    Point p{s, {}};
    loop.at(s, p.loci);
    return p;
}

Point point(const Loop& loop, Complex s, const Point& before) {
    Point p = point(loop, s);
    follow(before.loci, p.loci);
    return p;
}

double wrapped_deg(double radians) {
    return std::remainder(radians, 2.0 * std::numbers::pi) * 180.0 / std::numbers::pi;
}

/// Collects the results along the axis.
class Survey {
  public:
    explicit Survey(const Loop& loop) : loop_(loop) {}

    /// A locus that is real at an end of the contour does not change its sign there.
    void end(const Point& p, double frequency) {
        for (const Complex& l : p.loci)
            if (l.real() < 0.0 && std::abs(l.imag()) <= kReal * std::abs(l)) real_axis(l, frequency);
    }

    void step(const Point& a, const Point& b, bool on_axis) {
        for (std::size_t i = 0; i < a.loci.size(); ++i) {
            const Complex from = a.loci[i], to = b.loci[i];
            turn_ += std::arg((1.0 + to) / (1.0 + from));
            if (!on_axis) continue;
            min_ = std::min(min_, std::abs(1.0 + to));
            if ((std::abs(from) > 1.0) != (std::abs(to) > 1.0)) {
                const auto [l, w] = cross(a, b, i, [](Complex x) { return std::abs(x) - 1.0; });
                unit_circle(l, w);
            }
            if ((from.imag() > 0.0) != (to.imag() > 0.0) && std::min(from.real(), to.real()) < 0.0) {
                const auto [l, w] = cross(a, b, i, [](Complex x) { return x.imag(); });
                if (l.real() < 0.0) real_axis(l, w);
            }
        }
    }

    /// From the loop's end to infinity, where L is 0: inside the unit circle, by the shortest path.
    void close(const Point& last) {
        for (const Complex& l : last.loci)
            if (std::abs(l.imag()) > kReal * std::abs(l)) turn_ -= std::arg(1.0 + l);
    }

    [[nodiscard]] Margins margins() const {
        Margins m;
        m.encirclements = static_cast<int>(std::lround(turn_ / std::numbers::pi));
        m.unstable_poles = loop_.unstable_poles();
        m.unstable_closed = m.unstable_poles - m.encirclements;
        m.stable = m.unstable_closed == 0 && min_ > kOnPoint;
        if (!m.stable) return m;
        m.phase_deg = phase_deg_;
        m.crossover_radps = crossover_;
        m.gain_up_dB = up_dB_;
        m.gain_down_dB = down_dB_;
        m.upward_radps = upward_;
        m.downward_radps = downward_;
        m.modulus = min_;
        return m;
    }

  private:
    struct Crossing {
        Complex value;
        double frequency;
    };
    template <typename F>
    [[nodiscard]] Crossing cross(Point a, Point b, std::size_t i, const F& f) const {
        const bool sign = f(a.loci[i]) > 0.0;
        while (std::abs(b.s - a.s) > kCrossing * std::abs(b.s)) {
            Point middle = point(loop_, 0.5 * (a.s + b.s), a);
            if ((f(middle.loci[i]) > 0.0) == sign)
                a = std::move(middle);
            else
                b = std::move(middle);
        }
        return {b.loci[i], b.s.imag()};
    }

    void unit_circle(Complex l, double w) {
        const double deg = std::abs(wrapped_deg(std::arg(l) - std::numbers::pi));
        if (deg >= phase_deg_) return;
        phase_deg_ = deg;
        crossover_ = w;
    }
    void real_axis(Complex l, double w) {
        const double dB = -20.0 * std::log10(std::abs(l));
        if (dB >= 0.0 && dB < up_dB_) {
            up_dB_ = dB;
            upward_ = w;
        }
        if (dB < 0.0 && -dB < down_dB_) {
            down_dB_ = -dB;
            downward_ = w;
        }
    }

    static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const Loop& loop_;
    double turn_ = 0.0;
    double min_ = std::numeric_limits<double>::infinity();
    double phase_deg_ = 180.0;
    double up_dB_ = std::numeric_limits<double>::infinity();
    double down_dB_ = std::numeric_limits<double>::infinity();
    double crossover_ = kNone, upward_ = kNone, downward_ = kNone;
};

/// The loci at s = 0, halfway between both sides of the indent; none if they are far apart because of an integrator.
Point at_rest(const Loop& loop, const Point& right) {
    const Point left = point(loop, -right.s, right);
    Point middle{0.0, {}};
    for (std::size_t i = 0; i < right.loci.size(); ++i) {
        const Complex l = 0.5 * (left.loci[i] + right.loci[i]);
        if (std::abs(right.loci[i] - l) < 0.5 * std::abs(l)) middle.loci.push_back(l);
    }
    return middle;
}

/// Whether the step from `a` to `to` is short enough to determine the rotation around -1.
bool sure(const Loop& loop, const Point& a, Complex to) {
    return loop.max_approach(a.s, to, a.loci) < 0.5;
}

}  // namespace

Margins margins(const Loop& loop, double ratio) {
    const double indent = Loop::kIndent_radps;
    Survey survey(loop);
    Point here = point(loop, {indent, 0.0});
    survey.end(at_rest(loop, here), 0.0);

    // A quarter circle around s = 0, which leaves integrators on the left, then up the axis.
    constexpr double kArc = 0.5 * std::numbers::pi;
    double angle = 0.0;
    double share = 1.0;
    while (angle < kArc) {
        const double next = std::min(angle + share * 0.1, kArc);
        const Complex to = next >= kArc ? Complex(0.0, indent) : std::polar(indent, next);
        if (!sure(loop, here, to)) {
            share *= 0.5;
            if (share < kShortest) throw std::runtime_error("the locus passes through -1 near s = 0");
            continue;
        }
        Point there = point(loop, to, here);
        survey.step(here, there, false);
        here = std::move(there);
        angle = next;
        share = std::min(1.0, 2.0 * share);
    }
    double w = indent;
    const double end = loop.end_radps();
    share = 1.0;
    while (w < end) {
        const double next = std::min(w * (1.0 + share * (ratio - 1.0)), end);
        if (!sure(loop, here, {0.0, next})) {
            share *= 0.5;
            if (share * (ratio - 1.0) < kShortest) {
                // No step from a point on -1 is short enough: this is the limit of stability.
                Margins m;
                m.unstable_poles = loop.unstable_poles();
                m.unstable_closed = 1;
                return m;
            }
            continue;
        }
        Point there = point(loop, {0.0, next}, here);
        survey.step(here, there, true);
        here = std::move(there);
        w = next;
        share = std::min(1.0, 2.0 * share);
    }
    survey.end(here, end);
    survey.close(here);
    return survey.margins();
}

std::vector<LocusPoint> locus(const Loop& loop, double from_radps, double to_radps, int count) {
    std::vector<LocusPoint> points;
    points.reserve(static_cast<std::size_t>(count));
    std::vector<Complex> loci;
    for (int i = 0; i < count; ++i) {
        const double w = from_radps * std::pow(to_radps / from_radps, static_cast<double>(i) / (count - 1));
        loop.at({0.0, w}, loci);
        points.push_back({w, *std::max_element(loci.begin(), loci.end(), [](Complex a, Complex b) { return std::abs(a) < std::abs(b); })});
    }
    return points;
}

}  // namespace study::margins
