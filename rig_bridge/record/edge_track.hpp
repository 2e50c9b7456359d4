/// Motion of one shaft from its encoder's edges, each stamped by the sensor's clock: way and speed at any time, and the instant of standstill. Double
/// precision, no allocation.
///
/// A report is implausible if it has more edges than the encoder's top speed allows, or an edge stamped later than it is reported. If the following
/// reports continue from it (or it shows standstill), the sensor has restarted, and the way continues from there without a gap; a single implausible
/// report is dropped. A report that repeats an edge and stamp of the last kKept reports with new edges (replayed or delayed frame) is dropped, too.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "firmware/can/frame.hpp"

namespace rig::record {

using antiskid::can::Time;

/// Limits of an encoder. With the default values every report is accepted.
struct EdgeLimits {
    double edges_per_s = std::numeric_limits<double>::infinity();
    double late_s = std::numeric_limits<double>::infinity();  ///< age of the oldest report that is used
};

/// Ranges of a sensor's fields: a count or stamp that decreases has rolled over.
struct RollOver {
    std::uint32_t count_mask = std::numeric_limits<std::uint32_t>::max();  ///< greatest count
    Time time{};                                                           ///< 0: never
};

class EdgeTrack {
  public:
    /// `edge_pitch`: way from edge to edge, rad or m. All results use that unit.
    explicit EdgeTrack(double edge_pitch, const EdgeLimits& limits = {}) : pitch_(edge_pitch), limits_(limits) {}

    /// Call once per report with its time `now_s` (any clock with the rate of the sensor's), the number of edges so far and the stamp of the last
    /// edge, both modulo their fields.
    void update(std::uint32_t edge_count, Time edge_time, double now_s, const RollOver& roll_over = {});

    /// Discards the measured offset of the two clocks, which may drift slowly.
    void measure_clock_again() { clock_known_ = false; }

    /// Way since the first update; extrapolated from the last interval by at most one edge.
    [[nodiscard]] double way(double now_s) const;
    /// Way at the last edge.
    [[nodiscard]] double way_at_edge() const { return static_cast<double>(edges_) * pitch_; }
    /// Mean speed over the newest edges at least `window_s` apart (M/T method), or over the last interval if that is longer. If reports without an
    /// edge last longer than the last pitch did, it is limited to the speed that this allows. 0 before the second edge.
    [[nodiscard]] double speed(double window_s) const;
    /// Instant of the last edge on the clock of update().
    [[nodiscard]] double last_edge_s() const;
    /// The same on the sensor's own clock.
    [[nodiscard]] double stamp_s() const;
    /// Number of update() calls that brought an edge.
    [[nodiscard]] std::uint64_t edge_updates() const { return size_; }
    /// Time of the newest accepted report; minus infinity before the first.
    [[nodiscard]] double heard_s() const { return last_.newest_s; }
    /// Number of restarts of the sensor.
    [[nodiscard]] std::uint64_t restarts() const { return restarts_; }

    /// Motion from the last edge to standstill, extrapolated with the deceleration of the last kFitted edges. The encoder shows nothing of the last
    /// centimetres: no edge occurs there, and a magnetic pick-up has no signal at low speed.
    struct Rest {
        double time_s = 0.0;  ///< from the last edge to standstill
        double way = 0.0;
    };
    [[nodiscard]] Rest rest() const;

  private:
    static constexpr std::size_t kKept = 1024;  // a second of a sensor that reports each millisecond
    static constexpr std::size_t kFitted = 8;

    struct Edge {
        std::uint64_t edges = 0;
        Time time{};
    };
    /// The report with which the next one is compared.
    struct Report {
        std::uint32_t count = 0;
        Time edge_time{};
        double first_s = 0.0;                                        ///< when its edge was reported first
        double newest_s = -std::numeric_limits<double>::infinity();  ///< and last
        double before_s = -std::numeric_limits<double>::infinity();  ///< time of the last report before its edge
        double late_s = 0.0;                                         ///< delay beyond the promptest report
        std::uint32_t without_edge = 0;                              ///< reports since
    };
    /// From one report to another.
    struct Step {
        std::uint32_t edges = 0;
        Time time{};
    };
    [[nodiscard]] static Step between(const Report& before, const Report& after, const RollOver& roll_over);
    [[nodiscard]] bool follows(const Report& before, const Step& step, double now_s) const;
    [[nodiscard]] bool lies_behind(const Report& report, const RollOver& roll_over) const;
    void take(const Step& step, const Report& report);
    void keep(std::uint64_t edges, Time edge_time);
    void start_anew();
    /// `age` 0: the newest.
    [[nodiscard]] const Edge& edge(std::size_t age) const { return kept_[(size_ - 1 - age) % kKept]; }
    [[nodiscard]] std::size_t count() const {
        const std::uint64_t since = size_ - anew_;
        return since < kKept ? static_cast<std::size_t>(since) : kKept;
    }

    double pitch_;
    EdgeLimits limits_;
    std::array<Edge, kKept> kept_{};
    std::uint64_t size_ = 0;  // edges ever kept
    std::uint64_t anew_ = 0;  // of them before the sensor's latest restart
    std::uint64_t edges_ = 0;
    std::uint64_t restarts_ = 0;
    Report last_;
    std::optional<Report> strange_;  // implausible after `last_`; the next report decides what it was
    double clock_s_ = 0.0;           // smallest difference of update()'s clock minus the sensor's: of the edge reported with least delay
    bool clock_known_ = false;
};

}  // namespace rig::record
