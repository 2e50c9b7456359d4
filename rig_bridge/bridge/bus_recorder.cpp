#include "rig_bridge/bridge/bus_recorder.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "rig_bridge/record/live_file.hpp"

namespace rig::bridge {

using antiskid::can::Time;

namespace {

constexpr Time kLook{2'000'000};  // far below the main loop's step; the kernel's queue holds a second
constexpr Time kHousekeeping{100'000'000};
constexpr Time kWithoutBus{10'000'000};  // a lockstep without a bus waits for nobody

Time steady_now() {
    return std::chrono::steady_clock::now().time_since_epoch();
}

}  // namespace

BusRecorder::BusRecorder(const std::string& interface, const antiskid::can::Layout& layout, const record::MeterParameters& parameters,
                         std::function<void()> housekeeping, Lockstep* lockstep)
    : interface_(interface),
      layout_(layout),
      parameters_(parameters),
      housekeeping_(std::move(housekeeping)),
      lockstep_(lockstep),
      last_turn_(steady_now()),
      capture_(std::make_unique<record::Capture>(interface)),
      listener_(layout_, parameters, antiskid::can::WallMinusMonotonic{}, lockstep) {
    if (lockstep_ == nullptr) thread_ = std::thread([this] { run(); });
}

BusRecorder::~BusRecorder() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
}

BusNow BusRecorder::now() const {
    const std::lock_guard lock(mutex_);
    return now_;
}

void BusRecorder::begin(const std::filesystem::path& path) {
    auto next = std::make_unique<Recording>(std::make_unique<record::LiveFile>(path), interface_, layout_, parameters_,
                                            antiskid::can::WallMinusMonotonic{}().wall_minus_monotonic);
    const std::lock_guard lock(mutex_);
    now_.wall_minus_monotonic = next->label.of(Time{});
    next_ = std::move(next);
    end_asked_ = false;
    ended_.reset();
}

void BusRecorder::end() {
    const std::lock_guard lock(mutex_);
    end_asked_ = true;
}

std::unique_ptr<Recording> BusRecorder::take() {
    const std::lock_guard lock(mutex_);
    return std::move(ended_);
}

void BusRecorder::change_record() {
    const std::lock_guard lock(mutex_);
    if (next_) {
        recording_ = std::move(next_);
        recording_->dropped_before = dropped(capture_ ? capture_->status() : record::CaptureStatus{});
    }
    if (end_asked_ && recording_) {
        ended_ = std::move(recording_);
        end_asked_ = false;
    }
}

void BusRecorder::publish(bool drained) {
    const record::CaptureStatus status =
        capture_ ? capture_->status() : record::CaptureStatus{.up = false, .gone = true, .interface_error = capture_error_};
    if (recording_) {
        recording_->dropped = dropped(status) - recording_->dropped_before;
        recording_->interrupted = recording_->interrupted || !status.up;
    }
    const std::lock_guard lock(mutex_);
    now_.up = status.up;
    now_.error = status.interface_error;
    listener_.fill(now_, time(), drained, recording_.get());
}

/// A socket on a removed interface never works again: opens a new one as soon as the interface is back.
void BusRecorder::keep_capture() {
    if (capture_ && !capture_->status().gone) return;
    if (capture_) {
        capture_error_ = capture_->status().interface_error;
        dropped_before_ += capture_->status().dropped;
    }
    capture_.reset();
    try {
        capture_ = std::make_unique<record::Capture>(interface_);
    } catch (const std::exception& e) {
        capture_error_ = e.what();
    }
}

Time BusRecorder::time() const {
    return lockstep_ == nullptr ? steady_now() : lockstep_->now();
}

bool BusRecorder::hear_batch() {
    change_record();
    if (const Time now = steady_now(); now >= next_housekeeping_) {
        next_housekeeping_ = now + kHousekeeping;
        keep_capture();
        housekeeping_();
    }
    const auto frames = capture_ ? capture_->receive() : std::span<record::CapturedFrame>{};
    listener_.receive(frames, recording_.get());
    publish(frames.size() < record::Capture::kBatch);
    return frames.size() == record::Capture::kBatch;
}

void BusRecorder::run() {
    while (!stop_)
        if (!hear_batch()) std::this_thread::sleep_for(kLook);
}

void BusRecorder::await_turn(const std::function<bool()>& enough) {
    while (!enough()) {
        const bool more = hear_batch();
        if (lockstep_->due()) break;
        const Time passed = steady_now() - last_turn_;
        const Time longest = capture_ && capture_->up() ? lockstep_->max_wait() : std::min(lockstep_->max_wait(), kWithoutBus);
        if (more || passed < longest) {
            const Time quiet = more ? Time{} : lockstep_->quiet();
            if (capture_ && quiet == Time{})
                (void)capture_->wait(kLook);
            else
                std::this_thread::sleep_for(capture_ ? quiet : kLook);
            continue;
        }
        lockstep_->timed_out(passed);
        publish(true);
        break;
    }
    last_turn_ = steady_now();
}

}  // namespace rig::bridge
