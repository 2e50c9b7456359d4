// Whose rig: one bridge at a time on a CAN interface and a PLC.
#include "rig_bridge/bridge/rig_hold.hpp"

#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"

namespace {

constexpr std::uint64_t kHere = 4026531840;

struct Ways {
    std::string interface = "can0";
    std::string plc = "192.168.1.10:502";
    unsigned unit = 1;
    std::uint64_t netns = kHere;
};

std::vector<rig::bridge::HoldPlace> places(const TemporaryDirectory& directory, const Ways& ways = {}) {
    return rig::bridge::hold_places(directory.path(), ways.interface, rig::modbus::parse_plc_address(ways.plc), ways.unit, ways.netns);
}

}  // namespace

TEST_CASE("A second bridge on the interface or on the PLC is refused, and told whose rig it is", "[BRG-460]") {
    const TemporaryDirectory directory;
    const rig::bridge::RigHold first(places(directory), rig::bridge::holder_text("campaign", "/srv/runs/brake7"));
    const std::string holder = "rig-bridge campaign, process " + std::to_string(getpid()) + ", since 20";
    for (const auto& [what, ways] :
         {std::pair{"CAN interface can0 is held by ", Ways{}}, std::pair{"CAN interface can0 is held by ", Ways{.plc = "10.0.0.9:502"}},
          std::pair{"Modbus TCP 192.168.1.10:502, unit 1 is held by ", Ways{.interface = "can1"}}}) {
        CAPTURE(what);
        CHECK_THROWS_WITH(rig::bridge::RigHold(places(directory, ways), "second"),
                          ContainsSubstring(what + holder) && ContainsSubstring("records in /srv/runs/brake7. Next: "));
        CHECK_THAT(rig::bridge::rig_held(places(directory, ways)).value_or(""), ContainsSubstring(what + holder));
    }
}

TEST_CASE("Another interface with another PLC, unit, or the same names in another namespace, is another rig", "[BRG-460]") {
    const TemporaryDirectory directory;
    const rig::bridge::RigHold first(places(directory), "first");
    for (const Ways& other : {Ways{.interface = "can1", .plc = "192.168.1.11:502"}, Ways{.interface = "can1", .plc = "192.168.1.10:503"},
                              Ways{.interface = "can1", .unit = 2}, Ways{.netns = kHere + 1}}) {
        CAPTURE(other.interface, other.plc, other.unit, other.netns);
        CHECK_FALSE(rig::bridge::rig_held(places(directory, other)));
        CHECK_NOTHROW(rig::bridge::RigHold(places(directory, other), "second"));
    }
}

TEST_CASE("A rig that could not be had whole is let go of", "[BRG-460]") {
    const TemporaryDirectory directory;
    const rig::bridge::RigHold first(places(directory, {.interface = "can1"}), "first");
    CHECK_THROWS_AS(rig::bridge::RigHold(places(directory), "second"), rig::bridge::RigHeld);  // can0 free, its PLC not
    CHECK_NOTHROW(rig::bridge::RigHold(places(directory, {.plc = "10.0.0.9:502"}), "third"));
}

TEST_CASE("A serial line is held by whatever name it has", "[BRG-460]") {
    const TemporaryDirectory directory;
    int master = -1;
    int slave = -1;
    char name[64] = {};
    REQUIRE(openpty(&master, &slave, name, nullptr, nullptr) == 0);
    const std::filesystem::path other_name = directory / "ttyRig";
    std::filesystem::create_symlink(name, other_name);
    {
        const rig::bridge::RigHold first(places(directory, {.plc = name}), "first");
        CHECK_THROWS_WITH(rig::bridge::RigHold(places(directory, {.interface = "can1", .plc = other_name, .unit = 2}), "second"),
                          ContainsSubstring("Modbus RTU " + other_name.string() + " is held by first"));
        CHECK_THROWS_AS(rig::bridge::RigHold(places(directory, {.interface = "can1", .plc = name, .netns = 1}), "second"), rig::bridge::RigHeld);
        CHECK_NOTHROW(rig::bridge::RigHold(places(directory, {.interface = "can1", .plc = "/dev/none"}), "second"));
    }
    close(slave);
    close(master);
}

TEST_CASE("A bridge that was killed holds nothing", "[BRG-460]") {
    const TemporaryDirectory directory;
    int told[2] = {-1, -1};
    REQUIRE(pipe(told) == 0);
    const pid_t child = fork();
    if (child == 0) {
        const rig::bridge::RigHold first(places(directory), "the child");
        static_cast<void>(write(told[1], "x", 1) == 1);
        for (;;) pause();
    }
    char byte = 0;
    REQUIRE(read(told[0], &byte, 1) == 1);
    CHECK_THROWS_WITH(rig::bridge::RigHold(places(directory), "second"), ContainsSubstring("held by the child"));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    CHECK_NOTHROW(rig::bridge::RigHold(places(directory), "second"));
    close(told[0]);
    close(told[1]);
}

TEST_CASE("A place of the lock that is a link, or cannot be had, is refused by name", "[BRG-460]") {
    const TemporaryDirectory directory;
    const auto wanted = places(directory);
    std::filesystem::create_symlink(directory / "elsewhere", wanted[0].file);
    CHECK_THROWS_WITH(rig::bridge::RigHold(wanted, "first"), ContainsSubstring(wanted[0].file.string()));
    CHECK_FALSE(std::filesystem::exists(directory / "elsewhere"));
}
