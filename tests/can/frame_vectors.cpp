/// Writes frames of both layouts with what went in and what our own decoder read, one JSON object a line, for an
/// independent parser to judge. Keys are those of the bindings, values in the controller's units.

#include <cstdio>
#include <random>
#include <string>

#include "firmware/can/controller_port.hpp"
#include "firmware/can/observer.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/can/value_names.hpp"
#include "firmware/host/settings/json.hpp"
#include "tests/can/layouts.hpp"

using namespace antiskid;
using namespace antiskid::can;
using control::Time;
using settings::Json;

namespace {

constexpr Time kPortPeriod{1'000'000};

class Writer {
  public:
    Writer(std::string layout_name, const Layout& layout)
        : layout_name_(std::move(layout_name)), layout_(layout), rig_(layout, kPortPeriod), port_(layout, kPortPeriod), observer_(layout) {}

    void run(int samples) {
        for (int i = 0; i < samples; ++i) one();
    }

  private:
    float between(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
    unsigned below(unsigned n) { return std::uniform_int_distribution<unsigned>(0, n - 1)(random_); }

    void one() {
        speed(Role::wheel, layout_.wheel);
        speed(Role::flywheel, layout_.flywheel);
        const float pressure_Pa = between(-1e6F, 3.5e7F);
        const Frame pressure = rig_.pressure(pressure_Pa);
        port_.accept(pressure);
        write(Role::pressure, pressure, {{"pressure", pressure_Pa}}, {{"pressure", port_.sensors().pressure.pressure_Pa}});
        maneuver();
        const Frame rig_heartbeat = rig_.heartbeat();
        port_.accept(rig_heartbeat);
        write(Role::rig_heartbeat, rig_heartbeat, Json::object(), Json::object());
        write(Role::emergency_stop, rig_.emergency_stop(), Json::object(), Json::object());
        const unsigned number = below(0xFFFF'FFFFU);
        const Frame sync = rig_.sync(number);
        port_.accept(sync);
        write(Role::sync, sync, {{"number", number}}, {{"number", port_.sync_number()}});
        if (layout_[Role::load_cells].bound) {
            const Json sent{{"vertical", between(0.0F, 5e4F)},
                            {"longitudinal", between(-6e4F, 6e4F)},
                            {"brake_torque", between(-3e4F, 3e4F)},
                            {"age", below(40'000'000U)}};
            const Frame frame = rig_.load_cells({.vertical_N = sent["vertical"],
                                                 .longitudinal_N = sent["longitudinal"],
                                                 .brake_torque_Nm = sent["brake_torque"],
                                                 .age = control::Time{sent["age"].get<std::int64_t>()}});
            observer_.accept(frame);
            write(Role::load_cells, frame, sent, {{"age", observer_.view().load_cells.age.count()}});
        }
        if (layout_[Role::maneuver_state].bound) maneuver_state();
        command();
    }

    void maneuver_state() {
        const ManeuverStateSample sample{.phase = static_cast<std::uint8_t>(below(kPhaseNames.size())),
                                         .number = below(0xFFFF'FFFFU),
                                         .brake_temperature_C = between(-400.0F, 4000.0F)};
        const Frame frame = rig_.maneuver_state(sample);
        observer_.accept(frame);
        const ManeuverStateSample& read = observer_.view().maneuver_state;
        write(Role::maneuver_state, frame, {{"phase", sample.phase}, {"number", sample.number}, {"brake_temperature", sample.brake_temperature_C}},
              {{"phase", read.phase}, {"number", read.number}, {"brake_temperature", read.brake_temperature_C}});
    }

    void speed(Role role, const SpeedSignals& signals) {
        const SpeedSample sample{
            .edge_count = below(0xFFFF'FFFFU), .edge_time = Time{std::int64_t{below(0xFFFF'FFFFU)} * 1000}, .speed_radps = between(-20.0F, 450.0F)};
        const Frame frame = role == Role::wheel ? rig_.wheel(sample) : rig_.flywheel(sample);
        port_.accept(frame);
        const control::SpeedInput& read = role == Role::wheel ? port_.sensors().wheel : port_.sensors().flywheel;
        if (signals.source == control::SpeedSource::edges) {
            write(role, frame, {{"edge_count", sample.edge_count}, {"edge_time", sample.edge_time.count()}},
                  {{"edge_count", read.edge_count}, {"edge_time", read.edge_time.count()}});
        } else {
            write(role, frame, {{"speed", sample.speed_radps}}, {{"speed", read.speed_radps}});
        }
    }

    void maneuver() {
        const ManeuverSample sample{.law = static_cast<control::Law>(below(4)),
                                    .arm = below(2) == 1,
                                    .weight_on_wheels = below(2) == 1,
                                    .demand_Pa = between(0.0F, 3.5e7F),
                                    .slip_reference = between(0.0F, 0.6F),
                                    .deceleration_mps2 = between(0.0F, 25.0F),
                                    .current_mA = between(0.0F, 55.0F)};
        const Frame frame = rig_.maneuver(sample);
        port_.accept(frame);
        const control::ManeuverInput& read = port_.sensors().maneuver;
        write(Role::maneuver, frame,
              {{"law", static_cast<int>(sample.law)},
               {"arm", sample.arm ? 1 : 0},
               {"weight_on_wheels", sample.weight_on_wheels ? 1 : 0},
               {"demand", sample.demand_Pa},
               {"slip_reference", sample.slip_reference},
               {"deceleration", sample.deceleration_mps2},
               {"current", sample.current_mA}},
              {{"law", static_cast<int>(read.law)},
               {"arm", read.arm ? 1 : 0},
               {"weight_on_wheels", read.weight_on_wheels ? 1 : 0},
               {"demand", read.demand_Pa},
               {"slip_reference", read.slip_reference},
               {"deceleration", read.deceleration_mps2},
               {"current", read.current_mA}});
    }

    void command() {
        control::Command command;
        command.current_mA = between(-5.0F, 70.0F);
        command.state = static_cast<control::State>(below(control::kStateCount));
        command.slip = between(-1.0F, 1.0F);
        command.slip_reference = between(0.0F, 0.5F);
        command.speed_mps = between(0.0F, 100.0F);
        command.faults = control::FaultSet::from_bits(below(1U << control::kFaultCount));
        const Frame valve = port_.valve_command(command.current_mA);
        const Frame status = port_.status(command);
        const Frame faults = port_.faults(command.faults);
        const Frame heartbeat = port_.heartbeat();
        for (const Frame& frame : {valve, status, faults, heartbeat}) rig_.accept(frame);
        const ControllerView& view = rig_.controller();
        write(Role::valve, valve, {{"current", command.current_mA}}, {{"current", view.current_mA}});
        write(Role::status, status,
              {{"state", static_cast<int>(command.state)},
               {"slip", command.slip},
               {"slip_reference", command.slip_reference},
               {"speed", command.speed_mps}},
              {{"state", static_cast<int>(view.state)}, {"slip", view.slip}, {"slip_reference", view.slip_reference}, {"speed", view.speed_mps}});
        Json sent;
        Json read;
        for (std::uint8_t i = 0; i < control::kFaultCount; ++i) {
            const std::string fault(kFaultNames[i]);
            sent[fault] = command.faults.contains(static_cast<control::Fault>(i)) ? 1 : 0;
            read[fault] = view.faults.contains(static_cast<control::Fault>(i)) ? 1 : 0;
        }
        write(Role::faults, faults, sent, read);
        write(Role::controller_heartbeat, heartbeat, Json::object(), Json::object());
        if (!layout_[Role::road].bound) return;
        const control::RoadEstimate found{.peak_slip = static_cast<float>(below(5'000)) * 1e-4F,
                                          .grip_N = static_cast<float>(below(300'000)),
                                          .confidence = static_cast<float>(below(200)) * 5e-3F};
        const Frame road = port_.road(found);
        rig_.accept(road);
        write(Role::road, road, {{"peak_slip", found.peak_slip}, {"grip", found.grip_N}, {"confidence", found.confidence}},
              {{"peak_slip", view.road.peak_slip}, {"grip", view.road.grip_N}, {"confidence", view.road.confidence}});
    }

    void write(Role role, const Frame& frame, const Json& sent, const Json& read) {
        std::string hex;
        for (const std::uint8_t byte : frame.payload()) {
            constexpr std::string_view kDigits = "0123456789abcdef";
            hex += kDigits[byte / 16U];
            hex += kDigits[byte % 16U];
        }
        const Json line{{"layout", layout_name_}, {"role", std::string(name(role))}, {"id", frame.id}, {"data", hex}, {"sent", sent}, {"read", read}};
        std::puts(line.dump().c_str());
    }

    std::string layout_name_;
    const Layout& layout_;
    RigPort rig_;
    ControllerPort port_;
    Observer observer_;
    std::mt19937 random_{33};
};

}  // namespace

int main() try {
    Writer("antiskid", can_test::ours()).run(300);
    Writer("foreign", can_test::foreign()).run(300);
} catch (const std::exception& error) {
    std::fputs(error.what(), stderr);
    return 1;
}
