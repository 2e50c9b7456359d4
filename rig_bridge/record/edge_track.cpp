#include "rig_bridge/record/edge_track.hpp"

#include <algorithm>
#include <cmath>

namespace rig {

namespace {

double seconds(Time time) {
    return static_cast<double>(time.count()) * 1e-9;
}

}  // namespace

void EdgeTrack::update(std::uint32_t edge_count, Time edge_time, double now_s) {
    const bool first = size_ == 0;
    const std::uint32_t passed = first ? 0 : edge_count - last_count_;
    if (!first && passed == 0) return;
    last_count_ = edge_count;
    edges_ += passed;
    kept_[size_++ % kKept] = {.edges = edges_, .time = edge_time};
    if (first) return;  // an edge of unknown age says nothing about the clocks
    const double clock_s = now_s - seconds(edge_time);
    clock_s_ = clock_known_ ? std::min(clock_s_, clock_s) : clock_s;
    clock_known_ = true;
}

double EdgeTrack::last_edge_s() const {
    return size_ == 0 ? 0.0 : seconds(edge(0).time) + clock_s_;
}

double EdgeTrack::way(double now_s) const {
    if (size_ < 2) return way_at_edge();
    const double interval =
        seconds(edge(0).time - edge(1).time) / static_cast<double>(edge(0).edges - edge(1).edges);
    if (!(interval > 0.0)) return way_at_edge();
    return way_at_edge() + pitch_ * std::clamp((now_s - last_edge_s()) / interval, 0.0, 1.0);
}

double EdgeTrack::speed(double window_s, double now_s) const {
    if (size_ < 2) return 0.0;
    const auto window = Time{static_cast<std::int64_t>(window_s * 1e9)};
    std::size_t age = 1;
    while (age + 1 < count() && edge(0).time - edge(age).time < window) ++age;
    const double time = seconds(edge(0).time - edge(age).time);
    if (!(time > 0.0)) return 0.0;
    const double mean = static_cast<double>(edge(0).edges - edge(age).edges) * pitch_ / time;
    const double since = now_s - last_edge_s();
    return mean * since > pitch_ ? pitch_ / since : mean;
}

EdgeTrack::Rest EdgeTrack::rest() const {
    const std::size_t n = std::min(count(), kFitted);
    if (n < 3) return {};
    const double span = seconds(edge(0).time - edge(n - 1).time);
    if (!(span > 0.0)) return {};
    // Least squares of way = b u + c u^2 + d over u = time / span in -1..0, the newest edge at u = 0.
    double s0 = 0.0, s1 = 0.0, s2 = 0.0, s3 = 0.0, s4 = 0.0, y0 = 0.0, y1 = 0.0, y2 = 0.0;
    for (std::size_t age = 0; age < n; ++age) {
        const double u = -seconds(edge(0).time - edge(age).time) / span;
        const double y = -static_cast<double>(edge(0).edges - edge(age).edges) * pitch_;
        s0 += 1.0;
        s1 += u;
        s2 += u * u;
        s3 += u * u * u;
        s4 += u * u * u * u;
        y0 += y;
        y1 += u * y;
        y2 += u * u * y;
    }
    const double a11 = s2 - s1 * s1 / s0, a12 = s3 - s1 * s2 / s0, a22 = s4 - s2 * s2 / s0;
    const double r1 = y1 - s1 * y0 / s0, r2 = y2 - s2 * y0 / s0;
    const double determinant = a11 * a22 - a12 * a12;
    if (!(determinant > 0.0)) return {};
    const double speed = (r1 * a22 - r2 * a12) / determinant / span;
    const double deceleration = -2.0 * (r2 * a11 - r1 * a12) / determinant / (span * span);
    if (!(speed > 0.0) || !(deceleration > 0.0)) return {};
    return {.time_s = speed / deceleration, .way = 0.5 * speed * speed / deceleration};
}

}  // namespace rig
