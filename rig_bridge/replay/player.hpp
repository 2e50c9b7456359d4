/// Plays a log in real time: every frame at an absolute deadline of the monotonic clock, so that errors do not accumulate.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/host/clock.hpp"
#include "firmware/host/histogram.hpp"
#include "rig_bridge/replay/log_reader.hpp"

namespace rig::replay {

/// A frame passes if any rule matches; without rules every frame passes.
class IdFilter {
  public:
    /// `110`: that identifier; `100:7F0`: identifiers equal to 100 in the bits of mask 7F0; hexadecimal. Three digits are an 11-bit identifier, eight
    /// a 29-bit one. Throws std::invalid_argument saying what would be right.
    void add(std::string_view rule);

    [[nodiscard]] bool passes(const LogFrame& frame) const;

  private:
    struct Rule {
        std::uint32_t id;
        std::uint32_t mask;
        bool extended;
    };
    std::vector<Rule> rules_;
};

class FrameSender {
  public:
    virtual ~FrameSender() = default;
    /// Data and remote frames of both identifier lengths. False: the frame was discarded. Throws std::runtime_error if the interface is gone.
    virtual bool send(const LogFrame& frame) = 0;
};

struct PlayOptions {
    double speed = 1.0;       ///< > 0; 2: twice as fast as recorded
    std::uint64_t loops = 1;  ///< 0: until stopped; the next begins with the last frame of the one before
    IdFilter filter;
};

struct PlayReport {
    std::uint64_t sent = 0;
    std::uint64_t unsent = 0;        ///< the queue stayed full, or the bus took none
    std::uint64_t filtered = 0;      ///< kept back by the filter
    std::uint64_t error_frames = 0;  ///< in the log; not sent, because they are reports of a CAN chip
    std::uint64_t loops = 0;         ///< played to the end
    bool stopped = false;
    Time duration{};                   ///< from the first deadline to the last frame
    antiskid::host::Histogram late{};  ///< from each frame's deadline to its hand-over to the kernel
};

/// Opens the log anew for each loop.
using OpenLog = std::function<std::unique_ptr<LogReader>()>;

/// `report` is also valid, up to that point, if this throws. If time in the log goes backwards, the frame is due at once and time continues from
/// there.
void play(const OpenLog& open, const PlayOptions& options, FrameSender& sender, antiskid::host::Clock& clock, const std::atomic<bool>& stop,
          PlayReport& report);

[[nodiscard]] std::string to_text(const PlayReport& report);
/// One object. `log` and `interface` as given by the caller.
[[nodiscard]] std::string to_json(const PlayReport& report, const std::string& log, const std::string& interface);

}  // namespace rig::replay
