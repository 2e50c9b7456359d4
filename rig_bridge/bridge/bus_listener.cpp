#include "rig_bridge/bridge/bus_listener.hpp"

namespace rig::bridge {

using antiskid::can::Role;
using antiskid::can::Time;

BusListener::BusListener(const antiskid::can::Layout& layout, const record::MeterParameters& parameters)
    : parameters_(parameters),
      live_(layout),
      status_(layout, Role::status),
      senders_(layout),
      wheel_(parameters.wheel_teeth),
      flywheel_(parameters.flywheel_teeth) {}

void BusListener::accept(const antiskid::can::Frame& frame) {
    (void)live_.accept(frame);
    status_.accept(frame, live_.stats(Role::status));
    senders_.accept(frame);
}

void BusListener::tell(BusNow& now, Time time, bool drained) {
    constexpr Time kLately{200'000'000};
    const antiskid::can::BusView& view = live_.view();
    now.view = view;
    if (drained) now.looked = time;
    now.controller_rejected = status_.reason(now.looked - kLately);
    now.two_controllers = senders_.two_controllers();
    now.two_bridges = senders_.two_bridges();
    wheel_.update(view.wheel, time);
    flywheel_.update(view.flywheel, time);
    const double radius_m = parameters_.wheel_radius_m - static_cast<double>(view.load_cells.vertical_N) / parameters_.wheel_stiffness_Npm;
    now.rim_mps = flywheel_.radps() * parameters_.flywheel_radius_m;
    now.wheel_radps = wheel_.radps();
    now.wheel_rim_mps = now.wheel_radps * radius_m;
    now.slip = now.rim_mps > 0.0 ? 1.0 - now.wheel_rim_mps / now.rim_mps : 0.0;
}

}  // namespace rig::bridge
