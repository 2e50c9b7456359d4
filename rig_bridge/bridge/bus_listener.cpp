#include "rig_bridge/bridge/bus_listener.hpp"

#include <utility>

namespace rig::bridge {

using antiskid::can::Role;
using antiskid::can::Time;

BusListener::BusListener(const antiskid::can::Layout& layout, const record::MeterParameters& parameters, antiskid::can::WallClockOffset::Clock clocks,
                         Lockstep* lockstep)
    : layout_(layout),
      parameters_(parameters),
      lockstep_(lockstep),
      stamps_(std::move(clocks)),
      live_(layout),
      status_(layout, Role::status),
      senders_(layout),
      wheel_(parameters.wheel_teeth),
      flywheel_(parameters.flywheel_teeth) {}

void BusListener::receive(std::span<record::CapturedFrame> frames, Recording* recording) {
    stamps_.next_batch();
    for (record::CapturedFrame& one : frames) {
        const Time came = stamps_.monotonic(one.frame.received);
        if (recording != nullptr) recording->take(one, came);
        if (!one.plain()) continue;
        if (lockstep_ != nullptr) lockstep_->accept(one.frame);
        if (layout_[Role::sync].bound && one.frame.id == layout_[Role::sync].id) ++syncs_;
        antiskid::can::Frame heard = one.frame;
        heard.received = lockstep_ == nullptr ? came : lockstep_->now();
        accept(heard);
    }
}

void BusListener::accept(const antiskid::can::Frame& frame) {
    (void)live_.accept(frame);
    status_.accept(frame, live_.stats(Role::status));
    senders_.accept(frame);
}

void BusListener::fill(BusNow& now, Time time, bool drained, const Recording* recording) {
    constexpr Time kLately{200'000'000};
    const antiskid::can::BusView& view = live_.view();
    now.view = view;
    if (drained) now.valid_at = time;
    now.controller_rejected = status_.reason(now.valid_at - kLately);
    now.two_controllers = senders_.two_controllers();
    now.two_bridges = senders_.two_bridges();
    wheel_.update(view.wheel);
    flywheel_.update(view.flywheel);
    const double radius_m = parameters_.wheel_radius_m - static_cast<double>(view.load_cells.vertical_N) / parameters_.wheel_stiffness_Npm;
    now.rim_mps = flywheel_.radps() * parameters_.flywheel_radius_m;
    now.wheel_radps = wheel_.radps();
    now.wheel_rim_mps = now.wheel_radps * radius_m;
    now.slip = now.rim_mps > 0.0 ? 1.0 - now.wheel_rim_mps / now.rim_mps : 0.0;
    now.syncs = lockstep_ == nullptr ? syncs_ : lockstep_->syncs();
    if (recording == nullptr) return;
    now.frames = recording->log.frames();
    now.dropped = recording->dropped;
    now.missing = recording->log.missing();
    if (now.missing != 0) now.recording_error = recording->log.error();
}

}  // namespace rig::bridge
