/// Receives all frames on the bus and provides the present state, the live speeds, and bus.log of each maneuver. Runs on its own thread; in lockstep
/// on the caller's, turn by turn.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "firmware/can/layout.hpp"
#include "firmware/can/wall_minus_monotonic.hpp"
#include "rig_bridge/bridge/bus_listener.hpp"
#include "rig_bridge/bridge/lockstep.hpp"
#include "rig_bridge/bridge/plc_and_bus.hpp"
#include "rig_bridge/bridge/recording.hpp"
#include "rig_bridge/record/capture.hpp"

namespace rig::bridge {

class BusRecorder final : public BusFeed {
  public:
    /// Throws what Capture throws. `housekeeping` is called by the thread several times a second. `layout` and `lockstep` must outlive it; `lockstep`
    /// null: own thread and the machine's clock.
    BusRecorder(const std::string& interface, const antiskid::can::Layout& layout, const record::MeterParameters& parameters,
                std::function<void()> housekeeping, Lockstep* lockstep = nullptr);
    ~BusRecorder() override;
    BusRecorder(const BusRecorder&) = delete;
    BusRecorder& operator=(const BusRecorder&) = delete;

    [[nodiscard]] BusNow now() const override;

    /// Lockstep: receives until the bridge's turn is due, waiting for it has timed out, or `enough` returns true.
    void await_turn(const std::function<bool()>& enough);

    /// Starts bus.log. Throws std::runtime_error naming `path`.
    void begin(const std::filesystem::path& path);
    /// Asks the thread to end the record; take() returns it a few milliseconds later.
    void end();
    /// The record, once the thread has ended it, else null. Its log is not yet finished: BusLog::finish() waits for the disk.
    [[nodiscard]] std::unique_ptr<Recording> take();

  private:
    void run();
    [[nodiscard]] antiskid::can::Time time() const;
    /// Takes what has arrived; returns whether more may be waiting.
    bool hear_batch();
    void publish(bool drained);
    void change_record();
    void keep_capture();
    [[nodiscard]] std::uint64_t dropped(const record::CaptureStatus& status) const { return dropped_before_ + status.dropped; }

    std::string interface_;
    const antiskid::can::Layout& layout_;
    record::MeterParameters parameters_;
    std::function<void()> housekeeping_;
    Lockstep* lockstep_;

    // The thread's own.
    antiskid::can::Time last_turn_{};
    antiskid::can::Time next_housekeeping_{};
    std::unique_ptr<record::Capture> capture_;
    BusListener listener_;
    std::unique_ptr<Recording> recording_;
    std::uint64_t dropped_before_ = 0;  // by earlier captures
    std::string capture_error_;

    mutable std::mutex mutex_;  // guards the members below
    BusNow now_;
    std::unique_ptr<Recording> next_;
    std::unique_ptr<Recording> ended_;
    bool end_asked_ = false;

    std::atomic<bool> stop_{false};
    std::thread thread_;
};

}  // namespace rig::bridge
