#include "firmware/controller/options.hpp"

#include <cstdio>

#include "firmware/host/settings/command_line.hpp"

namespace antiskid::controller {

namespace {

constexpr auto kFooter = R"(Examples:
  antiskid-controller --can can0 --cpu 1                  on a rig, by the sensors' frames, alone on processor 1
  antiskid-controller --can vcan0 --clock sync            in lockstep with virtual-rig
  antiskid-controller --can can0 --dbc config/foreign.dbc --binding config/foreign_binding.toml
                                                          on a rig with other encoders and another valve driver
  antiskid-controller --can can0 --cpu 1 --check          before the wheel turns: machine, bus, sensors, timing; sends nothing
  antiskid-controller --can can0 --cpu 1 --check --valve-step --json -
                                                          the same and a small step of the valve, on a rig at rest
Paths are relative to the working directory. The program runs until SIGINT (Ctrl-C), SIGTERM or SIGHUP; the valve's
safe current is then the last command on the bus.
Exit status: 0 ended by a signal, 1 failed while running (no such interface, safe current not delivered, report not
written), 2 mistake on the command line or in a configuration file. With --check: 0 no check failed, 1 one did (a
configuration file that is refused among them), 2 mistake on the command line, 130 Ctrl-C.)";

void add_check_options(CLI::App& app, bool& wanted, CheckRequest& check) {
    auto* const asked =
        app.add_flag("--check", wanted, "check machine, CAN interface, the rig's frames and the loop's timing, show a table, run nothing");
    app.add_option("--timing-s", check.timing_s, "--check: how long to listen and to time the loop")
        ->needs(asked)
        ->check(CLI::Range(1, 3600))
        ->type_name("S")
        ->capture_default_str();
    app.add_flag("--valve-step", check.valve_step,
                 "--check: also step the valve to twice the residual pressure for 0.5 s; refused unless wheel and flywheel stand, there is no "
                 "pressure and nothing else is wrong with the sensors")
        ->needs(asked);
    app.add_option("--bitrate", check.bitrate, "--check: of the rig's CAN")
        ->needs(asked)
        ->check(CLI::Range(10'000, 1'000'000))
        ->type_name("BIT/S")
        ->capture_default_str();
    app.add_option("--expect-hash", check.expect_hash, "--check: the configuration must have this hash")->needs(asked)->type_name("HASH");
}

}  // namespace

std::string_view name(const ClockSource clock) {
    if (clock == ClockSource::timer) return "timer";
    return clock == ClockSource::sync ? "sync" : "sensors";
}

std::variant<Options, int> parse_options(const int argc, const char* const* argv) {
    Options options;
    CLI::App app{"Anti-skid controller: reads the rig's sensors from a CAN interface and commands the brake valve.", "antiskid-controller"};
    app.footer(kFooter);
    app.set_version_flag("--version", ANTISKID_VERSION);
    app.add_option("--can", options.interface, "CAN interface, e.g. can0")->required()->type_name("IF");
    settings::add_choice(app, "--clock", options.clock,
                         {{"sensors", ClockSource::sensors}, {"timer", ClockSource::timer}, {"sync", ClockSource::sync}},
                         "what a step waits for: the sensors' frame, with the machine's clock where it fails to come; the machine's clock alone; or "
                         "SYNC, for lockstep");
    app.add_option("--sync-timeout", options.sync_timeout_ms, "--clock sync: a rig silent for so long is a fault")
        ->check(CLI::Range(1, 3'600'000))
        ->type_name("MS")
        ->capture_default_str();
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path controller, dbc, binding;
    settings::add_config_directory(app, config);
    settings::existing_file(app.add_option("--controller", controller, "the controller's numbers (default: CONFIG/controller.toml)"));
    settings::add_layout_files(app, dbc, binding);
    settings::add_json(app, options.json, "statistics at exit, or with --check what was found,");
    app.add_option("--cpu", options.realtime.cpu, "pin the loop to this processor")->check(CLI::Range(0, 4095))->type_name("N");
    app.add_option("--priority", options.realtime.priority, "SCHED_FIFO priority of the loop, 1 to 99; 0: ordinary scheduling")
        ->check(CLI::Range(0, 99))
        ->type_name("N")
        ->capture_default_str();
    settings::add_choice(
        app, "--log-level", options.log_level,
        {{"debug", spdlog::level::debug}, {"info", spdlog::level::info}, {"warning", spdlog::level::warn}, {"error", spdlog::level::err}},
        "least severe messages to show");
    bool check = false;
    CheckRequest request;
    add_check_options(app, check, request);
    if (const auto status = settings::parse(app, argc, argv)) return *status;
    if (check && options.clock == ClockSource::sync) {
        std::fputs("antiskid-controller: --check listens by the machine's clock: leave --clock sync out\n", stderr);
        return 2;
    }
    options.controller = controller.empty() ? config / "controller.toml" : controller;
    options.layout = LayoutFiles(config, dbc, binding);
    if (check) options.check = request;
    return options;
}

}  // namespace antiskid::controller
