#include "firmware/can/load_layout.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "firmware/can/message_binder.hpp"
#include "firmware/can/value_names.hpp"
#include "firmware/host/settings/settings.hpp"

namespace antiskid::can {

namespace {

class Loader {
  public:
    Loader(const Dbc& dbc, const settings::Table& root, const RequiredRange& required) : dbc_(dbc), root_(root), required_(required) {}

    Layout run() {
        sensors();
        maneuver();
        rest_of_the_rig();
        controller();
        return layout_;
    }

  private:
    void sensors() {
        MessageBinder wheel = bind(Role::wheel, {});
        layout_.wheel = speed(wheel, required_.wheel);
        MessageBinder flywheel = bind(Role::flywheel, {});
        layout_.flywheel = speed(flywheel, required_.flywheel);
        MessageBinder pressure = bind(Role::pressure, {});
        layout_.pressure_Pa = pressure.physical("pressure", Quantity::pressure, {.max = required_.pressure_Pa});
    }

    void maneuver() {
        MessageBinder binder = bind(Role::maneuver, {.crc_required = true});
        ManeuverSignals& maneuver = layout_.maneuver;
        maneuver.law = binder.code("law", {.min = 2, .max = 8}, kLawNames);
        maneuver.arm = binder.whole("arm", kFlag);
        maneuver.weight_on_wheels = binder.whole("weight_on_wheels", kFlag);
        maneuver.demand_Pa = binder.physical("demand", Quantity::pressure, {.max = required_.pressure_Pa});
        maneuver.slip_reference = binder.physical("slip_reference", Quantity::ratio);
        maneuver.deceleration_mps2 = binder.physical("deceleration", Quantity::acceleration);
        maneuver.current_mA = binder.physical("current", Quantity::current, {.max = required_.current_mA});
    }

    void rest_of_the_rig() {
        static_cast<void>(bind(Role::rig_heartbeat, {}));
        static_cast<void>(bind(Role::emergency_stop, {.cyclic = false, .ordered = false}));
        if (root_.has(name(Role::sync))) {
            MessageBinder sync = bind(Role::sync, {.cyclic = false});
            if (sync.table().has("number")) layout_.sync_counter = sync.whole("number", {.min = 1, .max = 32});
        }
        if (root_.has(name(Role::load_cells))) {
            MessageBinder cells = bind(Role::load_cells, {});
            layout_.load_cells.vertical_N = cells.physical("vertical", Quantity::force, required_.vertical_N);
            layout_.load_cells.longitudinal_N = cells.physical("longitudinal", Quantity::force, required_.longitudinal_N);
            layout_.load_cells.brake_torque_Nm = cells.physical("brake_torque", Quantity::torque, required_.brake_torque_Nm);
            if (cells.table().has("age")) layout_.load_cells.age_ns = cells.physical("age", Quantity::time);
        }
        if (root_.has(name(Role::maneuver_state))) {
            MessageBinder state = bind(Role::maneuver_state, {});
            layout_.maneuver_state.phase = state.code("phase", {.min = 4, .max = 8}, kPhaseNames);
            layout_.maneuver_state.number = state.whole("number", {.min = 16, .max = 32});
            layout_.maneuver_state.brake_temperature_C = state.physical("brake_temperature", Quantity::temperature);
        }
    }

    void controller() {
        MessageBinder valve = bind(Role::valve, {.crc_required = true});
        layout_.valve_current_mA = valve.physical("current", Quantity::current, {.max = required_.current_mA});

        MessageBinder status = bind(Role::status, {});
        layout_.status.state = status.code("state", {.min = 3, .max = 8}, kStateNames);
        layout_.status.slip = status.physical("slip", Quantity::ratio);
        layout_.status.slip_reference = status.physical("slip_reference", Quantity::ratio);
        layout_.status.speed_mps = status.physical("speed", Quantity::speed);

        MessageBinder faults = bind(Role::faults, {});
        const settings::Table bits = faults.table().table("bits");
        for (std::size_t i = 0; i < kFaultNames.size(); ++i) {
            layout_.faults[i] = faults.whole(bits, kFaultNames[i], kFlag);
        }
        if (root_.has(name(Role::road))) {
            MessageBinder road = bind(Role::road, {});
            layout_.road.peak_slip = road.physical("peak_slip", Quantity::ratio);
            layout_.road.grip_N = road.physical("grip", Quantity::force);
            layout_.road.confidence = road.physical("confidence", Quantity::ratio);
        }
        static_cast<void>(bind(Role::controller_heartbeat, {}));
    }

    struct Rule {
        bool cyclic = true;
        bool crc_required = false;
        bool ordered = true;
    };

    MessageBinder bind(Role role, const Rule& rule) {
        MessageBinder binder(dbc_, root_.table(name(role)));
        Message message = binder.message(rule.cyclic);
        message.protection = binder.protection(rule.crc_required, rule.ordered);
        for (const Role other : roles_) {
            const Message& taken = layout_[other];
            if (taken.id == message.id) {
                binder.table().fail("message",
                                    "has the identifier that [" + std::string(name(other)) + "] uses; every role needs a message of its own");
            }
            if (taken.protection.protection == Protection::counter_crc && message.protection.protection == Protection::counter_crc &&
                taken.protection.data_id == message.protection.data_id) {
                binder.table().fail("data_id", "is that of [" + std::string(name(other)) + "]; it must tell this message from every other");
            }
        }
        roles_.push_back(role);
        layout_[role] = message;
        return binder;
    }

    static SpeedSignals speed(MessageBinder& binder, const RequiredRange::Shaft& required) {
        SpeedSignals signals;
        const bool edges = binder.table().has("edge_count") || binder.table().has("edge_time");
        const bool reported = binder.table().has("speed");
        if (edges == reported) {
            binder.table().fail(reported ? "speed" : "message", "give either edge_count and edge_time, or speed");
        }
        if (reported) {
            signals.source = control::SpeedSource::speed;
            signals.speed_radps = binder.rotation("speed", required.radps);
        } else {
            signals.source = control::SpeedSource::edges;
            signals.edge_count = binder.whole("edge_count", {.min = 8, .max = 32});
            if (std::ldexp(1.0, static_cast<int>(signals.edge_count.bits)) <= required.edges)
                binder.table().fail("edge_count", "rolls over within " + std::to_string(std::llround(required.edges)) +
                                                      " edges, which this rig's encoder may send between two readings; expected more bits");
            signals.edge_time = binder.clock("edge_time");
        }
        return signals;
    }

    static constexpr Widths kFlag{.min = 1, .max = 1};

    const Dbc& dbc_;
    const settings::Table& root_;
    RequiredRange required_;
    Layout layout_;
    std::vector<Role> roles_;
};

}  // namespace

Layout load_layout(const std::filesystem::path& dbc, const std::filesystem::path& binding, const RequiredRange& required) {
    const Dbc messages = load_dbc(dbc);
    const settings::Document document = settings::Document::load(binding);
    const settings::Table root = document.root();
    const Layout layout = Loader(messages, root, required).run();
    document.finish();
    return layout;
}

}  // namespace antiskid::can
