#include "rig_bridge/replay/player.hpp"

#include <algorithm>
#include <chrono>

namespace rig::replay {

namespace {

constexpr Time kSlice = std::chrono::milliseconds{50};  // longest sleep before looking for a stop

class Player {
  public:
    Player(const PlayOptions& options, FrameSender& sender, antiskid::host::Clock& clock, const std::atomic<bool>& stop, PlayReport& report)
        : options_(options), sender_(sender), clock_(clock), stop_(stop), report_(report) {}

    /// False when stopped.
    bool loop(LogReader& log) {
        anchored_ = false;
        for (LogFrame frame; log.next(frame);) {
            if (frame.error) {
                ++report_.error_frames;
                continue;
            }
            if (!options_.filter.passes(frame)) {
                ++report_.filtered;
                continue;
            }
            if (!send_at(deadline(frame.frame.received), frame)) return false;
        }
        ++report_.loops;
        return true;
    }

  private:
    [[nodiscard]] Time deadline(Time in_log) {
        if (!started_) {
            started_ = true;
            first_ = deadline_ = clock_.now();
        }
        if (!anchored_ || in_log < newest_) {
            anchored_ = true;
            log_base_ = in_log;
            clock_base_ = deadline_;
        }
        newest_ = in_log;
        const double since_ns = static_cast<double>((in_log - log_base_).count()) / options_.speed;
        deadline_ = clock_base_ + Time{static_cast<std::int64_t>(since_ns)};
        return deadline_;
    }

    bool send_at(Time deadline, const LogFrame& frame) {
        Time now = clock_.now();
        while (now < deadline && !stop_) {
            clock_.sleep_until(std::min(deadline, now + kSlice));
            now = clock_.now();
        }
        if (stop_) return false;
        report_.late.add(now - deadline);
        ++(sender_.send(frame) ? report_.sent : report_.unsent);
        report_.duration = now - first_;
        return true;
    }

    const PlayOptions& options_;
    FrameSender& sender_;
    antiskid::host::Clock& clock_;
    const std::atomic<bool>& stop_;
    PlayReport& report_;
    bool started_ = false;
    Time first_{}, deadline_{}, clock_base_{};
    Time log_base_{}, newest_{};
    bool anchored_ = false;  // within the loop
};

}  // namespace

void play(const OpenLog& open, const PlayOptions& options, FrameSender& sender, antiskid::host::Clock& clock, const std::atomic<bool>& stop,
          PlayReport& report) {
    Player player(options, sender, clock, stop, report);
    for (std::uint64_t i = 0; options.loops == 0 || i < options.loops; ++i) {
        const std::uint64_t before = report.sent + report.unsent;
        if (!player.loop(*open())) {
            report.stopped = true;
            return;
        }
        if (report.sent + report.unsent == before) return;  // nothing to play: no endless loop over it
    }
}

}  // namespace rig::replay
