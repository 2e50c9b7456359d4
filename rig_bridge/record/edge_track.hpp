/// The motion of one shaft from the edges of its encoder, each stamped by the sensor's own clock: angle and speed at any
/// sample, and when it came to rest. Double precision, no allocation.
///
/// No encoder makes more edges in a time than its fastest speed allows, and no edge is stamped later than it is reported. A report
/// that breaks either is no motion: once the reports after it go on from it (or it stands), the sensor has started anew, and the way
/// goes on from there without a gap; a single one is dropped. So is any that lies on the way that is known, by edge and stamp, as far back as the
/// last kKept reports that brought edges: a frame that was replayed, or overtaken by others.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "firmware/can/frame.hpp"

namespace rig::record {

using antiskid::can::Time;

/// What an encoder can do. As it stands here every report is believed.
struct EdgeLimits {
    double edges_per_s = std::numeric_limits<double>::infinity();
    double late_s = std::numeric_limits<double>::infinity();  ///< age of the oldest report that is used
};

/// Where a sensor's fields begin anew: a count or a stamp that goes back has gone on by the rest of its field.
struct RollOver {
    std::uint32_t count_mask = std::numeric_limits<std::uint32_t>::max();  ///< greatest count
    Time time{};                                                           ///< 0: never
};

class EdgeTrack {
  public:
    /// `edge_pitch`: way from edge to edge, rad or m; all results are in its unit.
    explicit EdgeTrack(double edge_pitch, const EdgeLimits& limits = {}) : pitch_(edge_pitch), limits_(limits) {}

    /// What the encoder said by `now_s` (any clock that runs as fast as the sensor's): edges so far and the stamp of the last one,
    /// each but for whole roll-overs. Once for every report.
    void update(std::uint32_t edge_count, Time edge_time, double now_s, const RollOver& roll_over = {});

    /// Forgets how the two clocks lie to each other, so that a slow drift between them does no harm.
    void measure_clock_again() { clock_known_ = false; }

    /// Way since the first update; between edges as the last interval says, at most one edge ahead.
    [[nodiscard]] double way(double now_s) const;
    /// Way at the last edge.
    [[nodiscard]] double way_at_edge() const { return static_cast<double>(edges_) * pitch_; }
    /// Mean speed over the newest edges that lie at least `window_s` apart (M/T method), or over the last interval
    /// where that is longer; once two reports without an edge span more than a pitch took, at most what that allows. 0 before the second
    /// edge.
    [[nodiscard]] double speed(double window_s) const;
    /// Instant of the last edge on the clock of update().
    [[nodiscard]] double last_edge_s() const;
    /// The same on the sensor's own clock.
    [[nodiscard]] double stamp_s() const;
    /// Counts up by one with every update() that brought an edge.
    [[nodiscard]] std::uint64_t news() const { return size_; }
    /// When the newest report came that is part of the motion; before the first minus infinity.
    [[nodiscard]] double heard_s() const { return last_.newest_s; }
    /// Times that the sensor started anew.
    [[nodiscard]] std::uint64_t restarts() const { return restarts_; }

    /// How the motion went on after the last edge, if the deceleration of the last kFitted edges lasted to the end. An
    /// encoder says nothing of the last centimetres: no edge falls there, and a magnetic pick-up is blind at low speed.
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
    /// A report that the next one is judged by.
    struct Report {
        std::uint32_t count = 0;
        Time edge_time{};
        double first_s = 0.0;                                        ///< when its edge was reported first
        double newest_s = -std::numeric_limits<double>::infinity();  ///< and last
        double before_s = -std::numeric_limits<double>::infinity();  ///< its edge came after this
        double late_s = 0.0;                                         ///< than the promptest
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
    std::uint64_t anew_ = 0;  // of them before the sensor's newest start
    std::uint64_t edges_ = 0;
    std::uint64_t restarts_ = 0;
    Report last_;
    std::optional<Report> strange_;  // cannot follow `last_`; what comes next tells what it was
    double clock_s_ = 0.0;           // of update() minus the sensor's, least seen: the edge that was reported at once
    bool clock_known_ = false;
};

}  // namespace rig::record
