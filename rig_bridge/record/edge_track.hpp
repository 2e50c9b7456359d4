/// The motion of one shaft from the edges of its encoder, each stamped by the sensor's own clock: angle and speed at any
/// sample, and when it came to rest. Double precision, no allocation.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/can/frame.hpp"

namespace rig {

using antiskid::can::Time;

class EdgeTrack {
  public:
    /// `edge_pitch`: way from edge to edge, rad or m; all results are in its unit.
    explicit EdgeTrack(double edge_pitch) : pitch_(edge_pitch) {}

    /// What the encoder said by `now_s` (any clock that runs as fast as the sensor's): edges so far, modulo 2^32, and the
    /// stamp of the last one.
    void update(std::uint32_t edge_count, Time edge_time, double now_s);

    /// Forgets how the two clocks lie to each other, so that a slow drift between them does no harm.
    void measure_clock_again() { clock_known_ = false; }

    /// Way since the first update; between edges as the last interval says, at most one edge ahead.
    [[nodiscard]] double way(double now_s) const;
    /// Way at the last edge.
    [[nodiscard]] double way_at_edge() const { return static_cast<double>(edges_) * pitch_; }
    /// Mean speed over the newest edges that lie at least `window_s` apart (M/T method), or over the last interval
    /// where that is longer; once the next edge is overdue, at most what that allows. 0 before the second edge.
    [[nodiscard]] double speed(double window_s, double now_s) const;
    /// Instant of the last edge on the clock of update().
    [[nodiscard]] double last_edge_s() const;
    /// Counts up by one with every update() that brought an edge.
    [[nodiscard]] std::uint64_t news() const { return size_; }

    /// How the motion went on after the last edge, if the deceleration of the last kFitted edges lasted to the end. An
    /// encoder says nothing of the last centimetres: no edge falls there, and a magnetic pick-up is blind at low speed.
    struct Rest {
        double time_s = 0.0;  ///< from the last edge to standstill
        double way = 0.0;
    };
    [[nodiscard]] Rest rest() const;

  private:
    static constexpr std::size_t kKept = 64;
    static constexpr std::size_t kFitted = 8;

    struct Edge {
        std::uint64_t edges = 0;
        Time time{};
    };
    /// `age` 0: the newest.
    [[nodiscard]] const Edge& edge(std::size_t age) const { return kept_[(size_ - 1 - age) % kKept]; }
    [[nodiscard]] std::size_t count() const {
        return size_ < kKept ? static_cast<std::size_t>(size_) : kKept;
    }

    double pitch_;
    std::array<Edge, kKept> kept_{};
    std::uint64_t size_ = 0;  // edges ever kept
    std::uint64_t edges_ = 0;
    std::uint32_t last_count_ = 0;
    double clock_s_ = 0.0;  // of update() minus the sensor's, least seen: the edge that was reported at once
    bool clock_known_ = false;
};

}  // namespace rig
