/// One run of the controller on a bus: the loop on a thread of its own, and around it the thread that may
/// wait.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "firmware/can/controller_port.hpp"
#include "firmware/control/controller.hpp"
#include "firmware/host/control_loop.hpp"
#include "firmware/host/frame_intake.hpp"
#include "firmware/host/pacer.hpp"
#include "firmware/host/realtime.hpp"
#include "firmware/host/setup.hpp"

namespace antiskid::rt {

/// Controller, port, pacer and loop, wired as the options say. Large: keep it on the heap.
class Session {
  public:
    /// All three must outlive the session.
    Session(const Setup& setup, const Options& options, can::Bus& bus, Clock& clock);

    [[nodiscard]] ControlLoop& loop() { return loop_; }
    [[nodiscard]] CycleRing& ring() { return ring_; }
    [[nodiscard]] const can::ControllerPort& port() const { return port_; }

  private:
    CycleRing ring_;
    can::ControllerPort port_;
    control::Controller controller_;
    FrameIntake intake_;
    std::unique_ptr<Pacer> pacer_;
    ControlLoop loop_;
};

/// The loop's thread. However its owner goes, the loop is stopped and has sent the safe current when the
/// destructor returns.
class LoopThread {
  public:
    /// Asks for the rights of `request` on the new thread, logs what was refused, and then runs the loop
    /// until `stop`.
    LoopThread(ControlLoop& loop, const RealtimeRequest& request, std::atomic<bool>& stop);
    ~LoopThread();
    LoopThread(const LoopThread&) = delete;
    LoopThread& operator=(const LoopThread&) = delete;

  private:
    std::atomic<bool>& stop_;
    std::thread thread_;
};

}  // namespace antiskid::rt
