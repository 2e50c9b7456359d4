/// SIGINT, SIGTERM and SIGHUP as requests that are counted: the first asks for a safe end, the second for an end at once.
#pragma once

namespace rig {

class StopRequests {
  public:
    /// Blocks the three signals in the calling thread and all that it starts later: construct before any other thread. SIGPIPE is ignored:
    /// a reader of the view that went away must not end a maneuver.
    StopRequests();
    ~StopRequests();
    StopRequests(const StopRequests&) = delete;
    StopRequests& operator=(const StopRequests&) = delete;

    /// How many have come so far. Does not wait.
    [[nodiscard]] int count();
    /// Of the first one; 0: none has come.
    [[nodiscard]] int number() const { return number_; }

  private:
    int descriptor_ = -1;
    int count_ = 0;
    int number_ = 0;
};

}  // namespace rig
