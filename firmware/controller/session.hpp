/// One run of the controller on a bus, with the loop on its own thread.
#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "firmware/can/controller_port.hpp"
#include "firmware/control/controller.hpp"
#include "firmware/controller/controller_setup.hpp"
#include "firmware/host/control_loop.hpp"
#include "firmware/host/frame_intake.hpp"
#include "firmware/host/pacer.hpp"
#include "firmware/host/realtime.hpp"

namespace antiskid::controller {

/// Controller, port, pacer and loop, connected according to the options. Large: keep it on the heap.
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

/// The loop's thread. The destructor stops the loop and returns after it has sent the safe current.
class LoopThread {
  public:
    /// Requests real-time scheduling as in `request` for the new thread, logs refusals, and runs the loop until `stop`.
    LoopThread(host::ControlLoop& loop, const host::RealtimeRequest& request, std::atomic<bool>& stop);
    ~LoopThread();
    LoopThread(const LoopThread&) = delete;
    LoopThread& operator=(const LoopThread&) = delete;

  private:
    std::atomic<bool>& stop_;
    std::thread thread_;
};

}  // namespace antiskid::controller
