// What surrounds the loop: command line, checks before the start, rights, signals.
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <thread>
#include <variant>

#include "firmware/controller/controller_setup.hpp"
#include "firmware/controller/options.hpp"
#include "firmware/host/realtime.hpp"
#include "firmware/host/stop_signals.hpp"
#include "tests/catch.hpp"

using namespace antiskid;
using namespace std::chrono_literals;
using controller::Options;

namespace {

template <typename... Arguments>
std::variant<Options, int> parse(const Arguments... arguments) {
    const std::array<const char*, sizeof...(arguments) + 1> argv{"antiskid-controller", arguments...};
    return controller::parse_options(static_cast<int>(argv.size()), argv.data());
}

}  // namespace

TEST_CASE("options are what was typed, or their defaults", "[RT-080]") {
    const auto plain = std::get<Options>(parse("--can", "can0"));
    CHECK(plain.interface == "can0");
    CHECK(plain.clock == controller::ClockSource::sensors);
    CHECK(plain.controller == "config/controller.toml");
    CHECK(plain.json.empty());
    CHECK_FALSE(plain.realtime.cpu);
    CHECK(plain.realtime.priority == 80);
    CHECK(plain.log_level == spdlog::level::info);

    const auto full = std::get<Options>(parse("--can", "vcan1", "--clock", "sync", "--sync-timeout", "250", "--config", "tests", "--dbc",
                                              "config/antiskid.dbc", "--binding", "config/foreign_binding.toml", "--json", "d", "--cpu", "1",
                                              "--priority", "0", "--log-level", "warning"));
    CHECK(full.clock == controller::ClockSource::sync);
    CHECK(std::get<Options>(parse("--can", "can0", "--clock", "timer")).clock == controller::ClockSource::timer);
    CHECK(full.sync_timeout_ms == 250);
    CHECK(full.controller == "tests/controller.toml");
    CHECK(full.layout.dbc == "config/antiskid.dbc");
    CHECK(full.layout.binding == "config/foreign_binding.toml");
    CHECK(full.json == "d");
    CHECK(full.realtime.cpu == 1);
    CHECK(full.realtime.priority == 0);
    CHECK(full.log_level == spdlog::level::warn);
}

TEST_CASE("a mistake on the command line is status 2, help is 0", "[RT-080]") {
    CHECK(std::get<int>(parse("--help")) == 0);
    CHECK(std::get<int>(parse("--version")) == 0);
    CHECK(std::get<int>(parse()) == 2);
    CHECK(std::get<int>(parse("--can")) == 2);
    CHECK(std::get<int>(parse("--can", "can0", "--clock", "wall")) == 2);
    CHECK(std::get<int>(parse("--can", "can0", "--priority", "100")) == 2);
    CHECK(std::get<int>(parse("--can", "can0", "--cpu", "-1")) == 2);
    CHECK(std::get<int>(parse("--can", "can0", "--sync-timeout", "0")) == 2);
    CHECK(std::get<int>(parse("--can", "can0", "--nonsense")) == 2);
    CHECK(std::get<int>(parse("--can", "can0", "surplus")) == 2);
}

TEST_CASE("--check comes with options of its own, which are mistakes without it", "[RT-080]") {
    CHECK_FALSE(std::get<Options>(parse("--can", "can0")).check);
    const auto plain = std::get<Options>(parse("--can", "can0", "--check"));
    REQUIRE(plain.check);
    CHECK(plain.check->timing_s == 10);
    CHECK_FALSE(plain.check->valve_step);
    CHECK(plain.check->bitrate == 1'000'000);
    const auto full = std::get<Options>(
        parse("--can", "can0", "--check", "--timing-s", "60", "--valve-step", "--bitrate", "500000", "--expect-hash", "abc", "--json", "-"));
    CHECK(full.check->timing_s == 60);
    CHECK(full.check->valve_step);
    CHECK(full.check->bitrate == 500'000);
    CHECK(full.check->expect_hash == "abc");
    CHECK(full.json == "-");
    CHECK(std::get<int>(parse("--can", "can0", "--valve-step")) == 2);
    CHECK(std::get<int>(parse("--can", "can0", "--timing-s", "10")) == 2);
    CHECK(std::get<int>(parse("--can", "can0", "--check", "--timing-s", "0")) == 2);
    CHECK(std::get<int>(parse("--can", "can0", "--check", "--clock", "sync")) == 2);
}

TEST_CASE("a layout that cannot serve lockstep is refused with the binding's name", "[RT-080]") {
    const controller::ControllerSetup setup = controller::load_setup({});
    CHECK(setup.period == 1ms);
    CHECK_NOTHROW(controller::check_layout(setup.layout, controller::ClockSource::sync, 1ms, "b.toml"));
    CHECK_NOTHROW(controller::check_layout(setup.layout, controller::ClockSource::sync, 5ms, "b.toml"));

    can::Layout deaf = setup.layout;
    deaf[can::Role::sync].bound = false;
    CHECK_THROWS_WITH(controller::check_layout(deaf, controller::ClockSource::sync, 1ms, "b.toml"), ContainsSubstring("b.toml: sync:"));
    CHECK_NOTHROW(controller::check_layout(deaf, controller::ClockSource::timer, 1ms, "b.toml"));

    can::Layout slow = setup.layout;
    slow[can::Role::valve].period = 2ms;
    CHECK_THROWS_WITH(controller::check_layout(slow, controller::ClockSource::sync, 1ms, "b.toml"), ContainsSubstring("b.toml: valve:"));
    CHECK_NOTHROW(controller::check_layout(slow, controller::ClockSource::timer, 1ms, "b.toml"));
    CHECK_NOTHROW(controller::check_layout(slow, controller::ClockSource::sync, 2ms, "b.toml"));
}

TEST_CASE("configuration files that are not there are named", "[RT-080]") {
    Options options;
    options.controller = "config/no_such.toml";
    CHECK_THROWS_WITH(controller::load_setup(options), ContainsSubstring("config/no_such.toml"));
    options = {};
    options.layout.dbc = "config/no_such.dbc";
    CHECK_THROWS_WITH(controller::load_setup(options), ContainsSubstring("config/no_such.dbc"));
    options = {};
    options.layout.binding = "config/no_such_binding.toml";
    CHECK_THROWS_WITH(controller::load_setup(options), ContainsSubstring("config/no_such_binding.toml"));
}

TEST_CASE("a right that is refused comes back as a sentence with its cure", "[RT-103]") {
    std::vector<std::string> rejected;
    std::thread([&] { rejected = host::enter_realtime({.priority = 0, .cpu = 1'000'000}); }).join();
    REQUIRE(rejected.size() == 1);
    CHECK_THAT(rejected[0], ContainsSubstring("processor 1000000") && ContainsSubstring("--cpu 0 to"));

    // Out of SCHED_FIFO's range: refused to everybody, root or not.
    std::thread([&] { rejected = host::enter_realtime({.priority = 1000, .cpu = {}}); }).join();
    REQUIRE(rejected.size() == 1);
    CHECK_THAT(rejected[0], ContainsSubstring("SCHED_FIFO priority 1000") && ContainsSubstring("setcap") && ContainsSubstring("LimitRTPRIO"));

    std::thread([&] { rejected = host::enter_realtime({.priority = 0, .cpu = {}}); }).join();
    CHECK(rejected.empty());
}

TEST_CASE("signals become a flag, whoever is asleep", "[RT-032]") {
    sigset_t before;
    pthread_sigmask(SIG_SETMASK, nullptr, &before);
    const int number = GENERATE(SIGINT, SIGTERM, SIGHUP);
    {
        host::StopSignals signals;
        CHECK_FALSE(signals.stop());
        CHECK(signals.number() == 0);
        kill(getpid(), number);
        while (!signals.stop()) std::this_thread::yield();
        CHECK(signals.number() == number);
    }
    { const host::StopSignals unused; }  // ends without a signal, too
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    std::signal(SIGPIPE, SIG_DFL);
}
