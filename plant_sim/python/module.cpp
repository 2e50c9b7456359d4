// antiskid._native: what antiskid/__init__.pyi describes.
#include <cmath>
#include <limits>
#include <memory>

#include "firmware/can/names.hpp"
#include "firmware/control/controller.hpp"
#include "firmware/host/controller_config.hpp"
#include "firmware/host/seconds.hpp"
#include "plant_sim/python/bindings.hpp"
#include "plant_sim/python/rig_loop.hpp"
#include "plant_sim/python/scenario.hpp"
#include "rig_bridge/rig/load_rig.hpp"
#include "rig_bridge/wear/regulation_config.hpp"

namespace plant_sim::python {

namespace {

using antiskid::control::Command;
using antiskid::control::Controller;
using antiskid::control::Sensors;
using antiskid::control::Time;

Time nanoseconds(double seconds) {
    return Time{std::llround(seconds * 1e9)};
}

void bind_scenario(py::module_& m) {
    py::class_<Scenario, std::shared_ptr<Scenario>>(m, "Scenario")
        .def(py::init<const py::kwargs&>())
        .def("stop", &Scenario::stop)
        .def("recorded_stop", &Scenario::recorded_stop)
        .def("stops", &Scenario::stops, py::arg("slip"), py::arg("seed") = std::vector<std::uint64_t>{}, py::arg("threads") = 1)
        .def("drive", &Scenario::drive, py::arg("time_s"), py::kw_only(), py::arg("pressure_Pa") = py::none(), py::arg("current_mA") = py::none())
        .def("rig", [](const std::shared_ptr<Scenario>& scenario) { return std::make_unique<RigLoop>(scenario); })
        .def("controller", [](const Scenario& scenario) { return Controller(scenario.inputs().controller); });
}

void bind_rig(py::module_& m) {
    const auto wheel = [](const RigLoop& rig) -> const plant::WheelState& { return rig.session().rig().wheel(); };
    py::class_<RigLoop>(m, "Rig")
        .def_property_readonly("done", &RigLoop::done)
        .def_property_readonly("braking", &RigLoop::braking)
        .def_property_readonly("period_s", &RigLoop::period_s)
        .def_property_readonly("now_s", [](const RigLoop& rig) { return antiskid::host::seconds(rig.now()); })
        .def_property_readonly("speed_mps", [wheel](const RigLoop& rig) { return wheel(rig).v_mps; })
        .def_property_readonly("wheel_speed_radps", [wheel](const RigLoop& rig) { return wheel(rig).omega_radps; })
        .def_property_readonly("slip", [](const RigLoop& rig) { return rig.session().rig().forces().slip; })
        .def_property_readonly("pressure_Pa", [](const RigLoop& rig) { return rig.session().rig().pressure_Pa(); })
        .def_property_readonly("demand_Pa", [](const RigLoop& rig) { return static_cast<double>(rig.session().sample().maneuver.demand_Pa); })
        .def("current_for_mA", &RigLoop::current_for_mA, py::arg("pressure_Pa"))
        .def("sensors", [](RigLoop& rig) { return Sensors(rig.sensors()); })
        .def(
            "advance", [](RigLoop& rig, double current_mA) { rig.advance(current_mA); }, py::arg("current_mA"))
        .def("apply", &RigLoop::apply, py::arg("command"))
        .def("figures", &RigLoop::figures);
}

double seconds_or_nan(Time time) {
    return time == antiskid::control::kNever ? std::numeric_limits<double>::quiet_NaN() : antiskid::host::seconds(time);
}

void bind_sensors(py::module_& m) {
    using antiskid::control::ManeuverInput;
    using antiskid::control::PressureInput;
    using antiskid::control::SpeedInput;
    py::class_<Sensors> sensors(m, "Sensors");
    sensors.def(py::init());
    const auto value = [&sensors]<class Part, class Value>(const char* name, Part Sensors::*part, Value Part::*member) {
        sensors.def_property(
            name, [=](const Sensors& s) { return s.*part.*member; }, [=](Sensors& s, Value given) { s.*part.*member = given; });
    };
    const auto time = [&sensors](const char* name, auto of) {
        sensors.def_property(
            name, [of](Sensors& s) { return seconds_or_nan(of(s)); },
            [of](Sensors& s, double given_s) { of(s) = std::isnan(given_s) ? antiskid::control::kNever : nanoseconds(given_s); });
    };
    value("wheel_edge_count", &Sensors::wheel, &SpeedInput::edge_count);
    time("wheel_edge_s", [](Sensors& s) -> Time& { return s.wheel.edge_time; });
    time("wheel_received_s", [](Sensors& s) -> Time& { return s.wheel.received; });
    value("flywheel_edge_count", &Sensors::flywheel, &SpeedInput::edge_count);
    time("flywheel_edge_s", [](Sensors& s) -> Time& { return s.flywheel.edge_time; });
    time("flywheel_received_s", [](Sensors& s) -> Time& { return s.flywheel.received; });
    value("pressure_Pa", &Sensors::pressure, &PressureInput::pressure_Pa);
    time("pressure_received_s", [](Sensors& s) -> Time& { return s.pressure.received; });
    value("arm", &Sensors::maneuver, &ManeuverInput::arm);
    value("weight_on_wheels", &Sensors::maneuver, &ManeuverInput::weight_on_wheels);
    value("demand_Pa", &Sensors::maneuver, &ManeuverInput::demand_Pa);
    value("slip_reference", &Sensors::maneuver, &ManeuverInput::slip_reference);
    time("maneuver_received_s", [](Sensors& s) -> Time& { return s.maneuver.received; });
    time("rig_heartbeat_received_s", [](Sensors& s) -> Time& { return s.rig_heartbeat_received; });
    sensors.def_readwrite("emergency_stop", &Sensors::emergency_stop);
}

void bind_controller(py::module_& m) {
    py::class_<Command>(m, "Command")
        .def(py::init())
        .def_readwrite("current_mA", &Command::current_mA)
        .def_readonly("slip", &Command::slip)
        .def_readonly("slip_reference", &Command::slip_reference)
        .def_readonly("speed_mps", &Command::speed_mps)
        .def_readonly("wheel_speed_radps", &Command::wheel_speed_radps)
        .def_readonly("pressure_request_Pa", &Command::pressure_request_Pa)
        .def_property_readonly("state", [](const Command& c) { return std::string(antiskid::can::name(c.state)); })
        .def_property_readonly("faults", [](const Command& c) { return antiskid::can::fault_names(c.faults); });
    py::class_<Controller>(m, "Controller")
        .def(py::init([](const std::filesystem::path& config) { return Controller(antiskid::load_controller_config(config)); }), py::arg("config"))
        .def(
            "step", [](Controller& controller, const Sensors& sensors, double now_s) { return controller.step(sensors, nanoseconds(now_s)); },
            py::arg("sensors"), py::arg("now_s"));
}

void bind_regulator(py::module_& m) {
    using wear::Regulator;
    py::class_<Regulator>(m, "Regulator")
        .def(py::init([](double landing_J, double landing_deviation_J, std::optional<int> landings, std::optional<double> brake_life_J,
                         std::optional<double> brake_taken_J, std::optional<double> tyre_life_J, const Directory& config) {
                 const std::filesystem::path directory = directory_of(config);
                 wear::RegulationConfig asked = wear::load_regulation_config(directory / "regulation.toml");
                 asked.plan.landings = landings.value_or(asked.plan.landings);
                 asked.plan.brake_taken_J = brake_taken_J.value_or(asked.plan.brake_taken_J);
                 asked.plan.tyre_life_J = tyre_life_J.value_or(asked.plan.tyre_life_J);
                 const double life_J = brake_life_J ? *brake_life_J : rig::load_rig(directory, {}).wear.life_J;
                 return Regulator(wear::plan_of(asked, life_J, landing_J, landing_deviation_J), asked.rules, asked.range());
             }),
             py::arg("landing_J"), py::arg("landing_deviation_J"), py::kw_only(), py::arg("landings") = py::none(),
             py::arg("brake_life_J") = py::none(), py::arg("brake_taken_J") = py::none(), py::arg("tyre_life_J") = py::none(),
             py::arg("config") = py::none())
        .def_property_readonly("reference", &Regulator::reference)
        .def_property_readonly("range", [](const Regulator& r) { return py::make_tuple(r.range().lowest, r.range().highest); })
        .def_property_readonly("landings", &Regulator::landings)
        .def_property_readonly("brake_left_J", &Regulator::brake_left_J)
        .def_property_readonly("tyre_left_J", &Regulator::tyre_left_J)
        .def_property_readonly("required_share", &Regulator::required_share)
        .def(
            "after",
            [](Regulator& r, double kinetic_J, double brake_J, double tyre_J, double j_mu, std::optional<double> reference) {
                return std::string(wear::name(r.after(
                    {.reference = reference.value_or(r.reference()), .kinetic_J = kinetic_J, .brake_J = brake_J, .tyre_J = tyre_J, .j_mu = j_mu})));
            },
            py::kw_only(), py::arg("kinetic_J"), py::arg("brake_J"), py::arg("tyre_J"), py::arg("j_mu") = wear::kUnknown,
            py::arg("reference") = py::none());
}

}  // namespace

}  // namespace plant_sim::python

PYBIND11_MODULE(_native, m) {
    plant_sim::python::bind_scenario(m);
    plant_sim::python::bind_rig(m);
    plant_sim::python::bind_sensors(m);
    plant_sim::python::bind_controller(m);
    plant_sim::python::bind_ledger(m);
    plant_sim::python::bind_endurance(m);
    plant_sim::python::bind_wear(m);
    plant_sim::python::bind_regulator(m);
    plant_sim::python::bind_studies(m);
    plant_sim::python::bind_bus_log(m);
    m.attr("__version__") = ANTISKID_VERSION;
}
