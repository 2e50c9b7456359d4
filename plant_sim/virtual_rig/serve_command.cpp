#include "plant_sim/virtual_rig/serve_command.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "firmware/can/roles.hpp"
#include "firmware/can/socket_can.hpp"
#include "firmware/host/controller_config.hpp"
#include "firmware/host/layout_files.hpp"
#include "firmware/host/realtime.hpp"
#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/command_line.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/number_in.hpp"
#include "firmware/host/stop_signals.hpp"
#include "firmware/host/supervised_can.hpp"
#include "plant_sim/plc/load_served_rig.hpp"
#include "plant_sim/scenario/brake_options.hpp"
#include "plant_sim/virtual_rig/serve_node.hpp"
#include "plant_sim/virtual_rig/serve_panel.hpp"
#include "plant_sim/virtual_rig/serve_reporter.hpp"
#include "plant_sim/wear/brake_state.hpp"
#include "rig_bridge/modbus/server.hpp"
#include "rig_bridge/panel/panel_option.hpp"
#include "rig_bridge/rig/same_rig.hpp"
#include "rig_bridge/rig/scenario.hpp"

namespace plant_sim {

namespace {

using antiskid::control::Time;

struct Options {
    std::string interface;
    std::string modbus = "127.0.0.1:1502";
    std::vector<std::string> modbus_allow{"127.0.0.1"};
    bool rtu = false;
    std::string clock = "timer";
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path dbc, binding, registers;
    std::filesystem::path port_file;
    std::filesystem::path scenario;
    BrakeOptions brake;
    std::uint64_t seed = 1;
    int priority = 70;
    int answer_timeout_ms = 100;
    std::string panel;
    bool spun_up = false;
    bool together = false;
};

/// Everything read from files and the command line, checked.
struct Served {
    rig::LoadedRig plant;
    plc::ServedRigOptions rig;
    antiskid::can::Layout layout;
    rig::RegisterMap map;
    rig::modbus::ServerOptions server;
};

/// The options, or the exit status when there is nothing to run.
std::optional<int> parse(int argc, char** argv, Options& o) {
    CLI::App app{
        "The rig that antiskid-controller and rig-bridge work on: sends wheel, flywheel and pressure frames and obeys the valve command on CAN, "
        "serves the PLC's registers on Modbus, moves the plant behind both. Runs until it is stopped.",
        "virtual-rig serve"};
    app.add_option("--can", o.interface, "CAN interface, e.g. vcan0")->required()->type_name("IF");
    settings::existing_file(app.add_option("--scenario", o.scenario, "the same file that rig-bridge gets: it says which rig this is"))->required();
    auto* const modbus =
        app.add_option("--modbus", o.modbus, "where Modbus TCP is served; port 0: any free one")->type_name("IP:PORT")->capture_default_str();
    app.add_option("--modbus-allow", o.modbus_allow,
                   "peers that may connect by Modbus TCP, numeric, with commas between; others are closed and named")
        ->delimiter(',')
        ->type_name("IP")
        ->capture_default_str();
    std::string rtu;
    settings::one_of(app.add_option("--modbus-rtu", rtu, "Modbus RTU on a pseudo-terminal, whose name is printed; without --modbus instead of TCP"),
                     {"pty"});
    settings::one_of(
        app.add_option("--clock", o.clock, "timer: real time; sync: lockstep with antiskid-controller --clock sync, never faster than real time"),
        {"timer", "sync"})
        ->capture_default_str();
    app.add_option("--answer-timeout", o.answer_timeout_ms,
                   "with --clock sync: the controller is silent when a valve command takes longer, a bridge in lockstep when its turn does")
        ->check(CLI::Range(1, 3'600'000))
        ->type_name("MS")
        ->capture_default_str();
    app.add_flag("--start-together", o.together,
                 "with --clock sync: rig time begins when rig-bridge --clock sync has connected and the controller answers, so that all three have "
                 "the same one");
    o.brake.add_to(app);
    app.add_flag("--spun-up", o.spun_up, "the flywheel turns at the scenario's speed from the start: the first spin-up is short");
    settings::add_seed(app, o.seed)->check(CLI::NonNegativeNumber);
    settings::result_file(app.add_option("--port-file", o.port_file,
                                         "written when everything is served: the TCP port (0: none), then the pseudo-terminal (or nothing)"));
    rig::panel::add_panel_option(app, o.panel);
    settings::add_config_directory(app, o.config);
    settings::existing_file(app.add_option("--registers", o.registers, "register map (default: CONFIG/registers.toml)"));
    settings::add_layout_files(app, o.dbc, o.binding);
    app.add_option("--priority", o.priority, "SCHED_FIFO priority with --clock timer; 0: ordinary scheduling")
        ->check(CLI::Range(0, 99))
        ->capture_default_str();
    app.footer(
        "Examples:\n"
        "  virtual-rig serve --can vcan0 --scenario config/scenarios/heavy.toml\n"
        "  virtual-rig serve --can vcan0 --scenario config/scenarios/endurance.toml --clock sync --modbus 127.0.0.1:0 --port-file port\n"
        "  virtual-rig serve --can vcan0 --scenario config/scenarios/endurance.toml --brake-state brake.json\n"
        "Exit status: 0 stopped by SIGTERM; 1 interface or port not to be had, or the brake's state not kept; 2 mistake on the command line or in a "
        "configuration file; 130 stopped by Ctrl-C.");
    if (const auto mistake = settings::parse(app, argc, argv)) return mistake;
    o.rtu = !rtu.empty();
    if (o.rtu && modbus->count() == 0) o.modbus.clear();
    return std::nullopt;
}

rig::modbus::ServerOptions server_options(const Options& o) {
    rig::modbus::ServerOptions server{.port = std::nullopt, .rtu = o.rtu};
    if (o.modbus.empty()) return server;
    const std::size_t colon = o.modbus.rfind(':');
    if (colon != 0 && colon != std::string::npos) server.port = settings::number_in<std::uint16_t>(o.modbus.substr(colon + 1));
    if (!server.port) throw std::invalid_argument("--modbus: expected IP:PORT, e.g. 127.0.0.1:1502, got '" + o.modbus + "'");
    server.address = o.modbus.substr(0, colon);
    server.allow = o.modbus_allow;
    server.on_rejected = [](const std::string& peer) {
        fmt::print(stderr, "virtual-rig: Modbus TCP: {} is refused, --modbus-allow does not have it\n", peer);
    };
    return server;
}

std::filesystem::path or_default(const std::filesystem::path& given, const std::filesystem::path& otherwise) {
    return given.empty() ? otherwise : given;
}

Served load(const Options& o) {
    const rig::Scenario scenario = rig::load_scenario(o.scenario, o.config);
    const antiskid::control::Config controller = antiskid::load_controller_config(scenario.controller);
    rig::check_same_rig(scenario.rig, controller, scenario.controller);
    Served s{.plant = scenario.rig,
             .rig = plc::load_served_rig(o.config, scenario.endurance() ? plc::Bench::endurance : plc::Bench::landing),
             .layout = antiskid::LayoutFiles(o.config, o.dbc, o.binding).load(antiskid::required_range(controller)),
             .map = rig::load_register_map(or_default(o.registers, o.config / "registers.toml")),
             .server = server_options(o)};
    if (o.clock == "sync" && !s.layout[antiskid::can::Role::sync].bound)
        throw std::invalid_argument("--clock sync needs a layout with a [sync] message; this one has none");
    if (o.together && (o.clock != "sync" || !s.map.bridge_turn))
        throw std::invalid_argument("--start-together needs --clock sync, and [virtual.bridge_turn] in " +
                                    or_default(o.registers, o.config / "registers.toml").string());
    s.rig.period_s = static_cast<double>(antiskid::load_controller_config(scenario.controller).period_s);
    s.rig.watchdog_s = std::chrono::duration<double>(s.map.bridge_timeout).count();
    s.rig.map_version = s.map.version;
    if (o.spun_up) s.rig.rim_mps = s.plant.rig.brake_on_mps;
    s.rig.brake = o.brake.brake_of(s.plant.wear, o.seed);
    if (!o.brake.state.empty())  // reports a path that cannot be written before anything runs
        wear::write_brake_state(o.brake.state, s.rig.brake->state(), s.plant.wear);
    return s;
}

void enter_realtime(int priority) {
    if (const auto rejected = antiskid::host::lock_memory()) fmt::print(stderr, "virtual-rig: {}\n", *rejected);
    for (const std::string& rejected : antiskid::host::enter_realtime({.priority = priority, .cpu = {}}))
        fmt::print(stderr, "virtual-rig: {}\n", rejected);
}

void announce(const Options& o, const rig::modbus::ModbusServer& server) {
    if (server.port() != 0) fmt::print("Modbus TCP on port {}\n", server.port());
    if (!server.rtu_path().empty()) fmt::print("Modbus RTU on {}\n", server.rtu_path());
    fmt::print("serving on {}, clock {}\n", o.interface, o.clock);
    (void)std::fflush(stdout);
    if (!o.port_file.empty()) settings::write_file(o.port_file, fmt::format("{}\n{}\n", server.port(), server.rtu_path()));
}

void summarise(const ServeState& state, const plc::ServedRig& rig, const rig::modbus::ServerCounters& modbus) {
    fmt::print(
        "{:.3f} s of rig time, {} periods not sent in time, {} frames not sent; {} Modbus requests, {} of them refused; {} touchdowns, {:.3f} MJ "
        "taken by the brake\n",
        rig.time_s(), state.overruns.load(), state.frames_lost.load(), modbus.requests, modbus.exceptions, rig.maneuvers(),
        rig.cumulative_energy_J() * 1e-6);
}

/// Writes the brake's state after each maneuver. Called by the reporter's thread.
class BrakeStateFile {
  public:
    BrakeStateFile(const Options& options, const wear::WearingBrake& brake)
        : file_(options.brake.state), brake_(brake), warned_(brake.extrapolates()) {}

    /// Returns text for the report.
    std::string write(const wear::BrakeState& state) {
        std::string text;
        if (!file_.empty()) {
            try {
                wear::write_brake_state(file_, state, brake_.wear());
                failed_ = false;
            } catch (const settings::Error& e) {
                text = fmt::format("the brake's state could not be written: {}", e.what());
                failed_ = true;
            }
        }
        const std::string beyond = extrapolation_notice({brake_.wear(), brake_.rule(), state});
        if (!beyond.empty() && !warned_) text += (text.empty() ? "" : "; ") + beyond;
        warned_ = !beyond.empty();
        return text;
    }
    [[nodiscard]] bool failed() const { return failed_; }

  private:
    std::filesystem::path file_;
    wear::WearingBrake brake_;
    bool warned_;
    bool failed_ = false;
};

int run(const Options& o, const Served& s) {
    BrakeStateFile state_file(o, *s.rig.brake);
    if (const std::string beyond = extrapolation_notice(*s.rig.brake); !beyond.empty()) fmt::print(stderr, "virtual-rig: {}\n", beyond);
    antiskid::host::StopSignals signals;
    std::optional<ServePanel> panel;
    if (!o.panel.empty()) panel.emplace(o.panel, o.scenario.stem().string());
    const antiskid::can::IdList wanted = antiskid::can::ids(s.layout, std::array{antiskid::can::Role::valve});
    antiskid::host::SupervisedCan bus([&] { return std::make_unique<antiskid::can::SocketCan>(o.interface, wanted.span()); });
    rig::modbus::ModbusServer server(s.map, s.server);
    plc::ServedRig rig(s.plant, s.rig, o.seed);
    const ServeState* state = nullptr;
    const auto exchange = [&server, &panel, &state](plc::ServedRig& served) {
        if (panel && state != nullptr) panel->show(served, *state);
        const rig::modbus::PlcCommands commands = server.exchange(served.measured());
        served.command(commands.commanded);
        served.open_interlocks(commands.open_interlocks);
    };
    antiskid::host::MonotonicClock clock;
    ServeNode node(rig, s.layout, bus, clock, Time(std::llround(s.rig.period_s * 1e9)), exchange);
    state = &node.state();
    if (panel) fmt::print("{}\n", panel->greeting());
    announce(o, server);
    {
        const ServeReporter reporter(
            node, bus, o.interface, s.rig.period_s, [](const std::string& line) { fmt::print(stderr, "virtual-rig: {}\n", line); },
            [&state_file](const wear::BrakeState& brake) { return state_file.write(brake); });
        if (o.clock == "sync") {
            node.run_lockstep(signals.stop(), Time(o.answer_timeout_ms * std::int64_t{1'000'000}),
                              {.done = [&server] { return server.bridge_turn(); }, .start_together = o.together});
        } else {
            enter_realtime(o.priority);
            node.run_realtime(signals.stop());
        }
    }
    summarise(node.state(), rig, server.counters());
    if (state_file.failed()) return 1;
    return signals.number() == SIGINT ? 130 : 0;
}

}  // namespace

int serve_command(int argc, char** argv) {
    Options options;
    if (const auto status = parse(argc, argv, options)) return *status;
    std::optional<Served> served;
    try {
        served = load(options);
    } catch (const std::exception& e) {
        fmt::print(stderr, "virtual-rig: {}\n", e.what());
        return 2;
    }
    return run(options, *served);
}

}  // namespace plant_sim
