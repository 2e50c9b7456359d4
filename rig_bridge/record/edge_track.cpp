#include "rig_bridge/record/edge_track.hpp"
#include "firmware/host/seconds.hpp"

#include <algorithm>
#include <cmath>

namespace rig::record {

using antiskid::host::seconds;

namespace {

constexpr double kRounding_ns = 1e3;  // of a stamp that a layout scales

}  // namespace

void EdgeTrack::update(std::uint32_t edge_count, Time edge_time, double now_s, const RollOver& roll_over) {
    const Report fresh{.count = edge_count, .edge_time = edge_time, .first_s = now_s, .newest_s = now_s};
    if (size_ == 0) {
        last_ = fresh;
        keep(0, edge_time);
        return;
    }
    if (const Step step = between(last_, fresh, roll_over); follows(last_, step, now_s)) {
        take(step, fresh);
        strange_.reset();
        return;
    }
    if (lies_behind(fresh, roll_over)) return;
    const Step since = strange_ ? between(*strange_, fresh, roll_over) : Step{};
    if (strange_ && since.edges == 0 && since.time == Time{}) {
        if (now_s - strange_->first_s > limits_.late_s) start_anew();
    } else if (strange_ && follows(*strange_, since, now_s)) {
        start_anew();
        take(since, fresh);
    } else {
        strange_ = fresh;
    }
}

EdgeTrack::Step EdgeTrack::between(const Report& before, const Report& after, const RollOver& roll_over) {
    Time time = after.edge_time - before.edge_time;
    if (const auto span_ns = static_cast<double>(roll_over.time.count()); span_ns > 0.0) {
        const double spans = std::floor((static_cast<double>(time.count()) + kRounding_ns) / span_ns);
        time -= Time{std::llround(spans * span_ns)};
    }
    return {.edges = (after.count - before.count) & roll_over.count_mask, .time = time};
}

bool EdgeTrack::follows(const Report& before, const Step& step, double now_s) const {
    if (step.edges == 0) return true;
    if (step.edges - 1.0 > limits_.edges_per_s * (now_s - before.newest_s + before.late_s + limits_.late_s)) return false;
    // The age of the first report's edge is unknown: its `before_s` is minus infinity. The edge of a late report may be older than that.
    return seconds(step.time) <= now_s - std::min(before.before_s, before.first_s - before.late_s) + limits_.late_s;
}

bool EdgeTrack::lies_behind(const Report& report, const RollOver& roll_over) const {
    const Step back = between(report, last_, roll_over);
    std::size_t near = 0, far = count();
    while (near < far) {
        const std::size_t age = near + (far - near) / 2;
        if (edge(0).edges - edge(age).edges < back.edges)
            near = age + 1;
        else
            far = age;
    }
    if (near == count()) return false;
    const Edge& older = edge(near);
    const Edge& newer = edge(0).edges - older.edges == back.edges ? older : edge(near - 1);
    const auto since_ns = static_cast<double>((edge(0).time - older.time - back.time).count());
    const auto span_ns = static_cast<double>(roll_over.time.count());
    const double spans = span_ns > 0.0 ? std::floor((since_ns + kRounding_ns) / span_ns) : 0.0;
    const double since_older_ns = since_ns - spans * span_ns;
    return since_older_ns >= -kRounding_ns && since_older_ns <= static_cast<double>((newer.time - older.time).count()) + kRounding_ns;
}

void EdgeTrack::take(const Step& step, const Report& report) {
    const double before_s = last_.newest_s;
    if (step.edges == 0) {
        last_.newest_s = report.newest_s;
        ++last_.without_edge;
        return;
    }
    last_ = report;
    last_.before_s = before_s;
    const Time time = edge(0).time + step.time;
    keep(edges_ + step.edges, time);
    const double clock_s = report.first_s - seconds(time);
    clock_s_ = clock_known_ ? std::min(clock_s_, clock_s) : clock_s;
    clock_known_ = true;
    last_.late_s = clock_s - clock_s_;
}

void EdgeTrack::keep(std::uint64_t edges, Time edge_time) {
    edges_ = edges;
    kept_[size_++ % kKept] = {.edges = edges, .time = edge_time};
}

void EdgeTrack::start_anew() {
    ++restarts_;
    last_ = *strange_;
    strange_.reset();
    anew_ = size_;
    keep(edges_, last_.edge_time);
    clock_s_ = last_.first_s - seconds(last_.edge_time);
    clock_known_ = true;
}

double EdgeTrack::last_edge_s() const {
    return size_ == 0 ? 0.0 : stamp_s() + clock_s_;
}

double EdgeTrack::stamp_s() const {
    return size_ == 0 ? 0.0 : seconds(edge(0).time);
}

double EdgeTrack::way(double now_s) const {
    if (count() < 2) return way_at_edge();
    const double interval = seconds(edge(0).time - edge(1).time) / static_cast<double>(edge(0).edges - edge(1).edges);
    if (!(interval > 0.0)) return way_at_edge();
    return way_at_edge() + pitch_ * std::clamp((now_s - last_edge_s()) / interval, 0.0, 1.0);
}

double EdgeTrack::speed(double window_s) const {
    if (count() < 2) return 0.0;
    const auto window = Time{static_cast<std::int64_t>(window_s * 1e9)};
    std::size_t age = 1;
    while (age + 1 < count() && edge(0).time - edge(age).time < window) ++age;
    const double time = seconds(edge(0).time - edge(age).time);
    if (!(time > 0.0)) return 0.0;
    const double mean = static_cast<double>(edge(0).edges - edge(age).edges) * pitch_ / time;
    // Over two reports, not one: frames that are late, on a bus and on a busy host, do not mean a slower shaft. At nearly one edge per report some
    // reports have none.
    if (last_.without_edge < 2) return mean;
    const double since = last_.newest_s - last_.first_s;
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

}  // namespace rig::record
