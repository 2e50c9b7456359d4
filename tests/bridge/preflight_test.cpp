// rig-bridge preflight: a rig that is bad in one respect fails the check of that respect, and no other.
#include "rig_bridge/bridge/preflight.hpp"

#include <unistd.h>

#include <limits>

#include "tests/bridge/fakes.hpp"
#include "tests/controller/results.hpp"
#include "tests/controller/sound_link.hpp"
#include "tests/settings/refusal.hpp"

using namespace std::chrono_literals;
using antiskid::can::Role;
using controller_test::named;
using controller_test::wrong;
using controller_test::Wrong;

namespace {

namespace controller = antiskid::controller;

rig::bridge::PreflightCommand heavy() {
    rig::bridge::PreflightCommand command;
    command.rig.scenario = "config/scenarios/heavy.toml";
    command.rig.interface = std::string("can0");  // GCC 12 warns falsely of text that is assigned
    command.rig.plc = std::string("192.168.1.10:502");
    command.rig.out = "runs/brake7";
    return command;
}

const rig::bridge::BridgeSetup& heavy_setup() {
    static const rig::bridge::BridgeSetup setup = rig::bridge::load_setup(heavy().rig);
    return setup;
}

rig::bridge::BusReception sound_bus() {
    rig::bridge::BusReception reception;
    reception.until = 10s;
    reception.view = bridge_test::good_bus(reception.until).view;
    for (const Role role : {Role::wheel, Role::flywheel, Role::pressure, Role::status})
        reception.stats[static_cast<std::size_t>(role)].accepted = 1000;
    return reception;
}

controller::MachineFacts sound_computer() {
    controller::MachineFacts facts;
    facts.fifo_granted = facts.clock_synchronised = true;
    facts.clock_source = std::string("tsc");
    facts.clock_resolution_s = 1e-9;
    facts.record_free_bytes = 1e9;
    return facts;
}

struct PreflightBench {
    controller::Report run() {
        return preflight_report(command, {.machine = [this](const auto&) { return machine; },
                                          .link = [this](const auto&) { return link; },
                                          .ledger = [this](const auto&) { return ledger; },
                                          .plc = [this](const auto&) { return plc; },
                                          .bus = [this](const auto&) { return bus; },
                                          .holder = [this](const auto&) { return holder; }});
    }
    [[nodiscard]] Wrong wrongs() { return wrong(run().checks); }

    rig::bridge::PreflightCommand command = heavy();
    controller::MachineFacts machine = sound_computer();
    controller::CanLink link = controller_test::sound_link();
    rig::bridge::LedgerFacts ledger;
    rig::modbus::Snapshot plc = bridge_test::good_plc();
    rig::bridge::BusReception bus = sound_bus();
    std::string holder;
};

void set(PreflightBench& bench, rig::Measured q, double value) {
    rig::at(bench.plc.values, q) = value;
}

/// A folder of the test's own, gone with the object.
class Folder {
  public:
    Folder() : path_(std::filesystem::temp_directory_path() / ("preflight_" + std::to_string(getpid()))) {
        std::filesystem::create_directories(path_);
    }
    ~Folder() { std::filesystem::remove_all(path_); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    [[nodiscard]] std::filesystem::path ledger() const { return path_ / "campaign.sqlite"; }

  private:
    std::filesystem::path path_;
};

}  // namespace

TEST_CASE("a scenario's law that the bus has no code for is refused by name", "[CTL-330]") {
    const TemporaryDirectory directory;
    std::string text = content_of("config/scenarios/heavy.toml");
    text.resize(text.find("law = \"slip\""));
    rig::bridge::RigOptions options = heavy().rig;
    options.scenario = directory / "heavy.toml";
    put(directory / "heavy.toml", text + "law = \"peak_slip\"\n");
    CHECK(rig::bridge::load_setup(options).scenario.mean.law == rig::BrakeLaw::peak_slip);
    put(directory / "heavy.toml", text + "law = \"pressure_bias\"\n");
    CHECK(rig::bridge::load_setup(options).scenario.mean.law == rig::BrakeLaw::pressure_bias);
    options.dbc = "config/foreign.dbc";
    options.binding = "config/foreign_binding.toml";
    CHECK_THROWS_WITH(rig::bridge::load_setup(options), ContainsSubstring("foreign.dbc: the law's field is too narrow"));
}

TEST_CASE("Load cells that read more than the bus can carry are refused, not saturated", "[BRG-120]") {
    const TemporaryDirectory directory;
    rig::bridge::RigOptions options = heavy().rig;
    options.registers = directory / "registers.toml";
    const std::string map = content_of("config/registers.toml");
    put(options.registers,
        replaced(map, "range = [-5.0e3, 65.5e3]\ncomment = \"vertical load cell", "range = [-5.0e3, 100.0e3]\ncomment = \"vertical load cell"));
    CHECK_THROWS_WITH(rig::bridge::load_setup(options), ContainsSubstring("antiskid_binding.toml") &&
                                                            ContainsSubstring("load_cells.vertical.signal") &&
                                                            ContainsSubstring("it must reach 100000 N"));
    put(options.registers, map);
    CHECK_NOTHROW(rig::bridge::load_setup(options));
}

TEST_CASE("A bridge starts with no rig whose teeth the controller has otherwise, or whose load its registers cannot carry", "[BRG-120]") {
    const auto rejected = [](const char* file, const std::string& from, const std::string& to) {
        const TemporaryDirectory directory;
        rig::bridge::RigOptions options = heavy().rig;
        options.config = directory / "config";
        std::filesystem::copy("config", options.config, std::filesystem::copy_options::recursive);
        put(options.config / file, replaced(content_of(options.config / file), from, to));
        return std::string(rejection_of([&] { return rig::bridge::load_setup(options); }).what());
    };
    CHECK_THAT(rejected("controller.toml", "teeth = 60", "teeth = 48"), ContainsSubstring("wheel.encoder.teeth: is 48; expected 60"));
    CHECK_THAT(rejected("registers.toml", "range = [0.0, 100.0e3]", "range = [0.0, 30.0e3]"), ContainsSubstring("holding.load_base.range"));
}

TEST_CASE("Lockstep needs a PLC that waits and a SYNC with a number", "[BRG-465]") {
    const TemporaryDirectory directory;
    rig::bridge::RigOptions options = heavy().rig;
    options.lockstep = true;
    CHECK_NOTHROW(rig::bridge::load_setup(options));
    const std::string map = content_of("config/registers.toml");
    put(directory / "registers.toml", map.substr(0, map.find("[virtual.bridge_turn]")));
    options.registers = directory / "registers.toml";
    CHECK_THROWS_WITH(rig::bridge::load_setup(options), ContainsSubstring("[virtual.bridge_turn] is missing"));
    options.lockstep = false;
    CHECK_NOTHROW(rig::bridge::load_setup(options));
    options.lockstep = true;
    options.registers.clear();
    const std::string binding = content_of("config/antiskid_binding.toml");
    const std::size_t number = binding.find("number = \"SyncNumber\"");
    put(directory / "binding.toml", binding.substr(0, number) + binding.substr(binding.find('\n', number)));
    options.binding = directory / "binding.toml";
    CHECK_THROWS_WITH(rig::bridge::load_setup(options), ContainsSubstring("[sync] has no number"));
}

TEST_CASE("A rig that is good in every respect passes every check but what nobody tells", "[BRG-150]") {
    PreflightBench bench;
    const controller::Report report = bench.run();
    CHECK(wrong(report.checks).empty());
    CHECK(passed(report));
    CHECK(report.config_hash == heavy_setup().config_hash);
    for (const controller::Check& check : report.checks) {
        CAPTURE(check.name, check.measured);
        CHECK((check.verdict == controller::CheckResult::pass || check.name == "CAN error counters"));
    }
}

TEST_CASE("A PLC that is bad in one respect fails that check alone", "[BRG-150]") {
    PreflightBench bench;
    SECTION("silent") {
        bench.plc.link = rig::modbus::LinkState::lost;
        bench.plc.error = std::string("connect: Connection refused");
        const auto checks = bench.run().checks;
        CHECK(wrong(checks) == Wrong{"PLC link: fail"});
        CHECK(named(checks, "PLC link").measured == "connect: Connection refused");
        CHECK(named(checks, "PLC register map").verdict == controller::CheckResult::skipped);
    }
    SECTION("another map") {
        bench.plc.link = rig::modbus::LinkState::map_rejected;
        bench.plc.error = std::string("the PLC has version 7");
        CHECK(bench.wrongs() == Wrong{"PLC register map: fail"});
    }
    SECTION("a program that stands still") {
        bench.plc.plc_watchdog_age_s = std::numeric_limits<double>::infinity();
        CHECK(bench.wrongs() == Wrong{"PLC heartbeat: fail"});
    }
    SECTION("a sensor that says what cannot be") {
        bench.plc.quality[static_cast<std::size_t>(rig::Measured::brake_temperature_C)] = rig::ValueQuality::implausible;
        const auto checks = bench.run().checks;
        CHECK(wrong(checks) == Wrong{"PLC registers: fail"});
        CHECK_THAT(named(checks, "PLC registers").measured, ContainsSubstring("brake_temperature implausible"));
    }
    SECTION("a register that is old") {
        bench.plc.age_s[static_cast<std::size_t>(rig::Measured::vertical_load_N)] = 9.0;
        CHECK(bench.wrongs() == Wrong{"PLC registers: fail"});
    }
    SECTION("tripped, and nobody may reset it but by hand") {
        set(bench, rig::Measured::plc_state, 1.0);
        CHECK(bench.wrongs().empty());
        bench.command.rig.reset = false;
        CHECK(bench.wrongs() == Wrong{"PLC state: fail"});
    }
    SECTION("a flywheel that turns") {
        set(bench, rig::Measured::flywheel_speed_mps, 3.0);
        CHECK(bench.wrongs() == Wrong{"rig at rest: fail"});
    }
    SECTION("a wheel on the rim") {
        set(bench, rig::Measured::wheel_on_rim, 1.0);
        CHECK(bench.wrongs() == Wrong{"rig at rest: fail"});
    }
}

TEST_CASE("Each interlock that is open is named", "[BRG-150]") {
    for (std::size_t i = 0; i < rig::kInterlockCount; ++i) {
        PreflightBench bench;
        set(bench, rig::Measured::interlocks, 15.0 - static_cast<double>(1U << i));
        const std::string name(rig::name(static_cast<rig::Interlock>(i)));
        CHECK(bench.wrongs() == Wrong{"interlock " + name + ": fail"});
    }
}

TEST_CASE("A bus that is bad in one respect fails that check alone", "[BRG-150]") {
    PreflightBench bench;
    auto& stats = bench.bus.stats;
    const auto of = [&](Role role) -> auto& {
        return stats[static_cast<std::size_t>(role)];
    };
    SECTION("not to be opened") {
        bench.bus.rejection = std::string("CAN interface 'can0' is down");
        CHECK(bench.wrongs() == Wrong{"CAN socket: fail"});
    }
    SECTION("no wheel") {
        bench.bus.view.wheel.received = antiskid::control::kNever;
        of(Role::wheel).accepted = 0;
        CHECK(bench.wrongs() == Wrong{"wheel frames: fail"});
    }
    SECTION("a flywheel that fell silent") {
        bench.bus.view.flywheel.received = bench.bus.until - 400ms;
        CHECK(bench.wrongs() == Wrong{"flywheel frames: fail"});
    }
    SECTION("a pressure that is damaged now and then") {
        of(Role::pressure).wrong_crc = 1;
        CHECK(bench.wrongs() == Wrong{"pressure frames: fail"});
    }
    SECTION("no controller") {
        bench.bus.view.controller = {};
        of(Role::status).accepted = 0;
        CHECK(bench.wrongs() == Wrong{"status frames: fail"});
    }
    SECTION("a controller in its safe state") {
        bench.bus.view.controller.state = antiskid::control::State::safe;
        bench.bus.view.controller.faults.insert(antiskid::control::Fault::wheel_lost);
        const auto checks = bench.run().checks;
        CHECK(wrong(checks) == Wrong{"controller state: fail"});
        CHECK(named(checks, "controller state").measured == "safe: wheel_lost");
    }
    SECTION("another bridge") {
        of(Role::maneuver).accepted = 50;
        CHECK(bench.wrongs() == Wrong{"only bridge: fail"});
    }
    SECTION("two controllers") {
        bench.bus.two_controllers = std::string("counter; two senders of 0x180");
        CHECK(bench.wrongs() == Wrong{"only controller: fail"});
    }
    SECTION("a bridge of this computer") {
        bench.holder = std::string("CAN interface can0 is held by rig-bridge campaign, process 4711");
        CHECK(bench.wrongs() == Wrong{"rig free: fail"});
    }
    SECTION("an interface at another bit rate") {
        bench.link.bitrate = 500'000;
        CHECK(bench.wrongs() == Wrong{"CAN bit rate: fail"});
    }
}

TEST_CASE("A computer, a ledger or a configuration that will not do fails its own check", "[BRG-150]") {
    PreflightBench bench;
    SECTION("no real-time right") {
        bench.machine.fifo_granted = false;
        CHECK(bench.wrongs() == Wrong{"scheduler rights: fail"});
    }
    SECTION("a disk too small for the campaign") {
        bench.machine.record_free_bytes = 0.4e9;
        CHECK(bench.wrongs().empty());
        bench.command.maneuvers = 50;
        CHECK(bench.wrongs() == Wrong{"disk of the record: fail"});
    }
    SECTION("a ledger that is held or damaged") {
        bench.ledger = {.there = true, .rejection = "is held by another program", .campaigns = {}};
        CHECK(bench.wrongs() == Wrong{"ledger: fail"});
    }
    SECTION("a campaign of another configuration") {
        rig::record::Campaign campaign;
        campaign.name = std::string("heavy");
        campaign.config_hash = std::string("0");
        bench.ledger = {.there = true, .rejection = {}, .campaigns = {campaign}};
        CHECK(bench.wrongs() == Wrong{"campaign's configuration: warn"});
        bench.ledger.campaigns[0].config_hash = heavy_setup().config_hash;
        CHECK(bench.wrongs().empty());
        bench.ledger.campaigns[0] = {};
        CHECK(bench.wrongs().empty());
    }
    SECTION("no place of a record given") {
        bench.command.rig.out.clear();
        CHECK(named(bench.run().checks, "ledger").verdict == controller::CheckResult::skipped);
    }
    SECTION("a scenario that is not there") {
        bench.command.rig.scenario = "config/scenarios/no_such.toml";
        const controller::Report report = bench.run();
        CHECK(wrong(report.checks) == Wrong{"configuration: fail"});
        CHECK_FALSE(passed(report));
        CHECK(report.config_hash.empty());
    }
}

TEST_CASE("A ledger says whether another program holds it", "[BRG-150]") {
    const Folder folder;
    {
        const rig::record::Ledger ledger(folder.ledger());
        REQUIRE(rig::record::held_by_another(folder.ledger()));
        CHECK_THAT(*rig::record::held_by_another(folder.ledger()), ContainsSubstring("is held by another program"));
    }
    CHECK_FALSE(rig::record::held_by_another(folder.ledger()));
    CHECK(rig::record::held_by_another("/proc/none/campaign.sqlite"));
}
