/// Events for viewers: each takes them at its own pace; who falls behind by more than is kept is dropped, and nobody is waited for.
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
    static constexpr std::size_t kKept = 512;  ///< some eight seconds of pixels and states, which a new viewer has at once

    void publish(std::string_view event, const std::string& data);
    /// No viewer gets anything from now on.
    void close();

    /// Where a viewer is.
    struct Place {
        bool began = false;
        std::uint64_t next = 0;
    };
    /// What is new for it as server-sent events, after at most `wait`; a comment where nothing is. None: it fell behind, or all is over.
    [[nodiscard]] std::optional<std::string> take(Place& place, std::chrono::milliseconds wait);

  private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::string> kept_;
    std::uint64_t first_ = 0;  // number of the oldest that is kept
    bool closed_ = false;
};

}  // namespace rig::panel
