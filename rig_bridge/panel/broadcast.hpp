/// Distributes events to viewers. Each reads at its own pace; a viewer that falls behind by more than kKept events is dropped, so that nobody waits
/// for it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace rig::panel {

class Broadcast {
  public:
    static constexpr std::size_t kKept = 512;  ///< about eight seconds of pixels and states, which a new viewer gets at once

    void publish(std::string_view event, const std::string& data);
    /// After this call no viewer gets anything.
    void close();

    /// Position of a viewer.
    struct Place {
        bool began = false;
        std::uint64_t next = 0;
    };
    /// New events for a viewer as server-sent events, after at most `wait`; a comment if there are none. None: the viewer fell behind, or the
    /// broadcast is closed.
    [[nodiscard]] std::optional<std::string> take(Place& place, std::chrono::milliseconds wait);

  private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::string> kept_;
    std::uint64_t first_ = 0;  // number of the oldest that is kept
    bool closed_ = false;
};

}  // namespace rig::panel
