#include "rig_bridge/bridge/options.hpp"

#include <algorithm>
#include <cstdlib>

#include "firmware/host/settings/command_line.hpp"
#include "rig_bridge/modbus/plc_address.hpp"
#include "rig_bridge/panel/panel_option.hpp"
#include "rig_bridge/record/specimen_options.hpp"

namespace rig::bridge {

namespace {

constexpr auto kFooter = R"(Examples:
  rig-bridge preflight config/scenarios/heavy.toml --can can0 --plc 192.168.1.10:502 --out runs/brake7 --maneuvers 500
  rig-bridge maneuver config/scenarios/heavy.toml --can can0 --plc 192.168.1.10:502
  rig-bridge maneuver config/scenarios/heavy.toml --can vcan0 --plc 127.0.0.1:1502 --out out/heavy
  rig-bridge campaign config/scenarios/endurance.toml --can can0 --plc-rtu /dev/ttyUSB0 --maneuvers 500 --out runs/brake7
  rig-bridge campaign config/scenarios/heavy.toml --can can0 --plc 192.168.1.10:502 --maneuvers 160 --regulate --out runs/pair3
  rig-bridge campaign config/scenarios/light.toml --can can0 --plc 192.168.1.10:502 --maneuvers 20 --out runs/brake8 --held --panel
  rig-bridge status runs/brake7
  rig-bridge watch runs/brake7 --can can0
  rig-bridge pause runs/brake7 --why "tyre change"; rig-bridge resume runs/brake7
  rig-bridge ledger note runs/brake7 --maneuver 31 --tyre T9 --notes "tread cut on the left" --who "A. Rossi"
  rig-bridge ledger note runs/brake7 --maneuver 40 --lining-worn 0.31 --tread-worn 0.2 --who "A. Rossi"
  rig-bridge ledger amend runs/brake7 --maneuver 31 --energy-MJ 0.974 --who "A. Rossi" --why "encoder node restarted; see its log"
Ctrl-C brings the maneuver to its safe end first; a second one ends the program at once, and the PLC's watchdog and the controller's
time-outs make the rig safe. The same campaign command goes on where it was, whatever ended it.
preflight takes the arguments of the maneuver or campaign that is to come, and moves nothing.
Exit status: 0 finished (also: wear limit reached; preflight: no check failed), 1 aborted or failed (the reason is named), 2 mistake on the
command line or in a configuration file, 130 Ctrl-C.)";

struct PlcOptions {
    std::string tcp;
    std::string rtu;
};

void add_rig_options(CLI::App& app, RigOptions& o, PlcOptions& plc, const char* out) {
    settings::existing_file(app.add_option("SCENARIO", o.scenario, "scenario file, e.g. config/scenarios/heavy.toml"))->required();
    app.add_option("--can", o.interface, "CAN interface, e.g. can0")->required()->type_name("IF");
    auto* const tcp = app.add_option("--plc", plc.tcp, "the PLC's Modbus TCP server")->type_name("HOST:PORT");
    auto* const rtu = app.add_option("--plc-rtu", plc.rtu, "the serial line of the PLC's Modbus RTU")->type_name("DEVICE");
    tcp->excludes(rtu);
    settings::add_out(app, o.out, out);
    settings::add_seed(app, o.seed)->check(CLI::NonNegativeNumber);
    settings::add_config_directory(app, o.config);
    settings::add_layout_files(app, o.dbc, o.binding);
    settings::existing_file(app.add_option("--registers", o.registers, "register map (default: CONFIG/registers.toml)"));
    app.add_flag("!--no-reset", o.reset,
                 "a tripped PLC is reset by hand only; without this, by the bridge while nothing is on and every interlock is good");
    app.add_option("--priority", o.priority, "SCHED_FIFO priority; 0: ordinary scheduling")->check(CLI::Range(0, 99))->capture_default_str();
    settings::add_choice(
        app, "--clock", o.lockstep, {{"timer", false}, {"sync", true}},
        "timer: real time; sync: lockstep with virtual-rig and antiskid-controller --clock sync: the same seed gives the same samples and figures");
    app.add_option("--answer-timeout", o.answer_timeout_ms, "with --clock sync: who takes longer is silent; as virtual-rig's")
        ->check(CLI::Range(1, 3'600'000))
        ->type_name("MS")
        ->capture_default_str();
    settings::add_choice(app, "--view", o.view, {{"auto", View::automatic}, {"live", View::live}, {"plain", View::plain}},
                         "live: a block that is drawn over itself; plain: a line a second; auto: live on a terminal");
}

/// What only those that move the rig have.
void add_run_options(CLI::App& app, RigOptions& o) {
    app.add_flag("--leave-turning", o.leave_turning,
                 "after an abort end although the rim may still turn; without this its speed is shown until it stands, or until Ctrl-C");
    settings::existing_file(app.add_option("--on-abort", o.on_abort,
                                           "program to run after an abort, once the rig is safe and the record closed: no arguments, at most 10 s; "
                                           "it has RIG_CAUSE, RIG_OUTCOME, RIG_NEXT_STEP, RIG_CAMPAIGN, RIG_MANEUVER, RIG_FOLDER"));
    app.add_flag("--quiet", o.quiet, "no bell at an abort");
    panel::add_panel_option(app, o.panel);
    record::add_specimen_options(app, o.specimen, "; kept with every maneuver from now on");
}

void campaign_directory(CLI::App& app, std::filesystem::path& directory) {
    settings::existing_directory(app.add_option("DIRECTORY", directory, "of the campaign"))->required();
}

const char* user() {
    const char* const name = std::getenv("USER");
    return name == nullptr || *name == '\0' ? "operator" : name;
}

void choose_plc(const PlcOptions& plc, RigOptions& o) {
    if (plc.tcp.empty() == plc.rtu.empty()) throw std::invalid_argument("say where the PLC is: --plc HOST:PORT or --plc-rtu DEVICE");
    if (!plc.rtu.empty() && plc.rtu.front() != '/')
        throw std::invalid_argument("--plc-rtu: expected the path of a device, e.g. /dev/ttyUSB0, got '" + plc.rtu + "'");
    o.plc = plc.tcp.empty() ? plc.rtu : modbus::numeric_plc_address(plc.tcp);
}

}  // namespace

std::variant<BridgeCommand, int> parse_bridge_command(int argc, const char* const* argv) {
    CLI::App app{"Runs maneuvers on a brake rig: sequences its PLC over Modbus and the controller over CAN, records, keeps the ledger.",
                 "rig-bridge"};
    app.set_version_flag("--version", ANTISKID_VERSION);
    app.require_subcommand(1);
    app.footer(kFooter);

    ManeuverCommand maneuver;
    CampaignCommand campaign;
    StatusCommand status;
    PreflightCommand preflight;
    PlcOptions preflight_plc;
    PlcOptions maneuver_plc;
    PlcOptions campaign_plc;
    CLI::App* const one = app.add_subcommand("maneuver", "one maneuver into a folder");
    add_rig_options(*one, maneuver.rig, maneuver_plc, "folder of this maneuver (default: out/SCENARIO-TIME)");
    settings::add_picture(*one, maneuver.picture, "speeds, slip and pressures", "; leaves trajectory.csv, too");
    one->add_flag("!--no-cool-down", maneuver.cool_down, "do not wait until the brake is cold enough for the next maneuver");
    CLI::App* const many = app.add_subcommand("campaign", "many maneuvers unattended; the same command resumes");
    add_rig_options(*many, campaign.rig, campaign_plc, "folder of the campaign");
    many->get_option("--out")->required();
    many->add_option("--maneuvers", campaign.rules.maneuvers, "how many, those already finished included")
        ->required()
        ->check(CLI::Range(1, 1'000'000));
    many->add_option("--retry", campaign.rules.retries, "run an aborted maneuver again, so many times; never where a person has to look first")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    many->add_option("--min-friction", campaign.rules.min_friction, "wear limit: stop when the mean friction of a maneuver is below")
        ->check(CLI::Range(0.0, 1.0));
    auto* const regulate = many->add_flag("--regulate", campaign.regulate,
                                          "after each maneuver the next slip reference, so that brake and tyre reach their limits together");
    settings::existing_file(many->add_option("--regulation", campaign.regulation, "plan and rules of that (default: CONFIG/regulation.toml)"))
        ->needs(regulate);
    many->add_option("--surfaces", campaign.surfaces,
                     "that the pair has seen or will see beside the scenario's own, with commas between, or all: they bound the references (default: "
                     "the regulation file's)")
        ->needs(regulate);
    auto* const model = many->add_option("--wear-model", campaign.wear_model,
                                         "judge the brake after each maneuver by this population.json or model.json of rig-lab wear");
    settings::existing_file(model);
    many->add_flag("--stop-on-abnormal", campaign.rules.stop_on_abnormal, "end the campaign, with status 1, when the brake is abnormal")
        ->needs(model);
    many->add_option("--name", campaign.name, "of the campaign in its ledger (default: the scenario's)");
    many->add_flag_callback(
        "--held", [&campaign] { campaign.held_by = user(); },
        "check everything, then wait until `resume` or the panel starts it; also each time that it is resumed");
    many->add_flag("--go-on-changed", campaign.changed, "resume although scenario, seed or configuration differ from before");
    CLI::App* const before =
        app.add_subcommand("preflight", "PLC, interlocks, bus, controller, ledger, disk and clock before the wheel turns; reads only");
    add_rig_options(*before, preflight.rig, preflight_plc, "folder of the record or campaign that is to come");
    before->add_option("--maneuvers", preflight.maneuvers, "that the disk must have room for")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    before->add_option("--bitrate", preflight.bitrate, "of the rig's CAN")
        ->check(CLI::Range(10'000, 1'000'000))
        ->type_name("BIT/S")
        ->capture_default_str();
    settings::add_json(*before, preflight.json, "what was found");
    CLI::App* const state = app.add_subcommand("status", "how far a campaign is, from its ledger");
    campaign_directory(*state, status.directory);
    settings::add_json(*state, status.json, "every campaign and maneuver");
    add_run_options(*one, maneuver.rig);
    add_run_options(*many, campaign.rig);
    WatchCommand watch;
    CLI::App* const look = app.add_subcommand("watch", "looks on while another terminal runs the rig; sends nothing, writes nothing");
    settings::existing_directory(look->add_option("DIRECTORY", watch.directory, "of the campaign; without one give --scenario"));
    look->add_option("--can", watch.interface, "CAN interface, e.g. can0")->required()->type_name("IF");
    settings::existing_file(look->add_option("--scenario", watch.scenario, "that is run (default: CONFIG/scenarios, the campaign's)"));
    settings::add_config_directory(*look, watch.config);
    settings::add_layout_files(*look, watch.dbc, watch.binding);
    auto* const once = look->add_flag("--once", watch.once, "say it once; exit status 1 when no bridge is heard");
    settings::add_json(*look, watch.json, "with --once what is seen; else with - alone, an object a line, one a second,");
    HoldCommand pause{.directory = {}, .hold = true, .who = user(), .why = {}};
    HoldCommand resume;
    CLI::App* const hold = app.add_subcommand("pause", "holds a campaign before its next maneuver, also one that is started later");
    campaign_directory(*hold, pause.directory);
    hold->add_option("--who", pause.who, "who holds it")->capture_default_str();
    hold->add_option("--why", pause.why, "and why");
    CLI::App* const go = app.add_subcommand("resume", "lets a campaign go on that `pause` holds");
    campaign_directory(*go, resume.directory);
    CLI::App* const ledger = app.add_subcommand("ledger", "what people say about a campaign's ledger");
    ledger->require_subcommand(1);
    AmendCommand amendment;
    CLI::App* const amend =
        ledger->add_subcommand("amend", "what a maneuver adds to the cumulative energy; a row of its own, nothing is overwritten");
    campaign_directory(*amend, amendment.directory);
    amend->add_option("--maneuver", amendment.number, "its number")->required()->check(CLI::PositiveNumber);
    amend->add_option("--attempt", amendment.attempt, "which attempt at it, where there are several")->check(CLI::PositiveNumber);
    amend->add_option("--energy-MJ", amendment.energy_MJ, "brake energy that counts")->required()->check(CLI::Range(0.0, 1e6));
    amend->add_option("--who", amendment.who, "who says so")->required();
    amend->add_option("--why", amendment.why, "and why")->required();
    amend->add_option("--campaign", amendment.campaign, "where the ledger has several");
    NoteCommand noted;
    CLI::App* const note =
        ledger->add_subcommand("note", "serial numbers, operator, notes, or the wear that was read after a maneuver; nothing is overwritten");
    campaign_directory(*note, noted.directory);
    note->add_option("--maneuver", noted.number, "its number")->required()->check(CLI::PositiveNumber);
    note->add_option("--attempt", noted.attempt, "which attempt at it, where there are several")->check(CLI::PositiveNumber);
    note->add_option("--who", noted.who, "who says so")->required();
    note->add_option("--campaign", noted.campaign, "where the ledger has several");
    record::add_specimen_options(*note, noted.said, "");
    for (std::size_t i = 0; i < noted.worn.size(); ++i)
        note->add_option(record::kWearReadingFields.at(i).option, noted.worn.at(i), record::kWearReadingFields.at(i).what);
    for (CLI::App* const verb : {one, many, before, state, look, hold, go, ledger, amend, note}) verb->footer(kFooter);
    if (const auto mistake = settings::parse(app, argc, argv)) return *mistake;
    if (state->parsed()) return BridgeCommand{status};
    if (amend->parsed()) return BridgeCommand{amendment};
    if (note->parsed()) {
        for (std::size_t i = 0; i < noted.worn.size(); ++i)
            if (!noted.worn.at(i).empty()) (void)record::worn_share(record::kWearReadingFields.at(i).option, noted.worn.at(i));
        if (noted.said == record::Specimen{} && noted.worn == decltype(noted.worn){})
            throw std::invalid_argument("ledger note: nothing is said; see --help");
        return BridgeCommand{noted};
    }
    if (look->parsed()) {
        if (!watch.json.empty() && watch.json != "-" && once->count() == 0)
            throw std::invalid_argument("watch --json: a file holds one answer: add --once, or give - for a stream");
        return BridgeCommand{watch};
    }
    if (hold->parsed()) return BridgeCommand{pause};
    if (go->parsed()) return BridgeCommand{resume};
    if (one->parsed()) {
        choose_plc(maneuver_plc, maneuver.rig);
        return BridgeCommand{maneuver};
    }
    if (before->parsed()) {
        choose_plc(preflight_plc, preflight.rig);
        return BridgeCommand{preflight};
    }
    choose_plc(campaign_plc, campaign.rig);
    return BridgeCommand{campaign};
}

}  // namespace rig::bridge
