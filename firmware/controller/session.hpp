/// One run of the controller on a bus: the loop on a thread of its own, and around it the thread that may
/// wait.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "firmware/can/controller_port.hpp"
#include "firmware/control/controller.hpp"
#include "firmware/controller/controller_setup.hpp"
#include "firmware/host/control_loop.hpp"
#include "firmware/host/frame_intake.hpp"
#include "firmware/host/pacer.hpp"
#include "firmware/host/realtime.hpp"

namespace antiskid::controller {

/// Controller, port, pacer and loop, wired as the options say. Large: keep it on the heap.
class Session {
  public:
    /// All three must outlive the session.
    Session(const ControllerSetup& setup, const Options& options, can::Bus& bus, host::Clock& clock);

    [[nodiscard]] host::ControlLoop& loop() { return loop_; }
    [[nodiscard]] host::CycleRing& ring() { return ring_; }
    [[nodiscard]] const can::ControllerPort& port() const { return port_; }

  private:
    host::CycleRing ring_;
    can::ControllerPort port_;
    control::Controller controller_;
    host::FrameIntake intake_;
    std::unique_ptr<host::Pacer> pacer_;
    host::ControlLoop loop_;
};

/// The loop's thread. However its owner goes, the loop is stopped and has sent the safe current when the
/// destructor returns.
class LoopThread {
  public:
    /// Asks for the rights of `request` on the new thread, logs what was refused, and then runs the loop
    /// until `stop`.
    LoopThread(host::ControlLoop& loop, const host::RealtimeRequest& request, std::atomic<bool>& stop);
    ~LoopThread();
    LoopThread(const LoopThread&) = delete;
    LoopThread& operator=(const LoopThread&) = delete;

  private:
    std::atomic<bool>& stop_;
    std::thread thread_;
};

}  // namespace antiskid::controller
