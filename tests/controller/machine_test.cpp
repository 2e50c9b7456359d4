// A machine that is bad in one respect fails the check of that respect, and no other.
#include "firmware/controller/machine.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "tests/controller/results.hpp"

using namespace controller_test;
using controller::MachineFacts;
using controller::MachineNeeds;

namespace {

MachineNeeds loop_needs() {
    return {.program = "antiskid-controller", .priority = 80, .cpu = 3, .record = ".", .record_bytes = 1e9};
}

MachineFacts good_machine() {
    MachineFacts facts;
    facts.kernel = "#1 SMP PREEMPT_RT Debian 6.1.0";
    facts.realtime_kernel = true;
    facts.fifo_granted = true;
    facts.rtprio_limit = 99;
    facts.memory_locked = true;
    facts.pinned = true;
    facts.governors = {{3, "performance"}};
    facts.isolated = "1,3-4";
    facts.clock_source = "tsc";
    facts.clock_resolution_s = 1e-9;
    facts.clock_synchronised = true;
    facts.record_free_bytes = 2e9;
    return facts;
}

controller::Checks all(const MachineFacts& facts, const MachineNeeds& needs = loop_needs()) {
    controller::Checks checks = real_time_checks(facts, needs);
    append(checks, clock_checks(facts));
    checks.push_back(record_check(facts, needs));
    return checks;
}

struct Bad {
    std::function<void(MachineFacts&)> how;
    Wrong expected;
};

/// A folder with the files given, gone with the object.
class Tree {
  public:
    Tree() : root_(std::filesystem::temp_directory_path() / ("machine_" + std::to_string(getpid()))) { std::filesystem::remove_all(root_); }
    ~Tree() { std::filesystem::remove_all(root_); }
    Tree(const Tree&) = delete;
    Tree& operator=(const Tree&) = delete;
    void write(const std::string& file, const std::string& text) const {
        std::filesystem::create_directories((root_ / file).parent_path());
        std::ofstream(root_ / file) << text << "\n";
    }
    [[nodiscard]] const std::filesystem::path& root() const { return root_; }

  private:
    std::filesystem::path root_;
};

}  // namespace

TEST_CASE("a machine that is good in every respect passes every check", "[RT-130]") {
    for (const controller::Check& check : all(good_machine())) {
        CAPTURE(check.name, check.measured);
        CHECK(check.verdict == controller::CheckResult::pass);
    }
}

TEST_CASE("a machine that is bad in one respect fails that check alone", "[RT-130]") {
    const std::vector<Bad> machines{
        {[](auto& m) { m.realtime_kernel = false, m.kernel = "#1 SMP PREEMPT_DYNAMIC"; }, {"kernel preemption: warn"}},
        {[](auto& m) { m.realtime_kernel = false, m.kernel = "#1 SMP"; }, {"kernel preemption: fail"}},
        {[](auto& m) { m.fifo_granted = false; }, {"scheduler rights: fail"}},
        {[](auto& m) { m.memory_locked = false; }, {"memory lock: fail"}},
        {[](auto& m) { m.pinned = false; }, {"processor of the loop: fail"}},
        {[](auto& m) { m.isolated = "1-2,4"; }, {"core isolation: warn"}},
        {[](auto& m) { m.isolated = ""; }, {"core isolation: warn"}},
        {[](auto& m) {
             m.governors = {{3, "powersave"}};
         },
         {"frequency governor: fail"}},
        {[](auto& m) {
             m.governors = {{0, "performance"}, {3, "schedutil"}};
         },
         {"frequency governor: fail"}},
        {[](auto& m) { m.clock_source = "hpet"; }, {"monotonic clock: fail"}},
        {[](auto& m) { m.clock_source = "refined-jiffies"; }, {"monotonic clock: fail"}},
        {[](auto& m) { m.clock_resolution_s = 4e-3; }, {"monotonic clock: fail"}},
        {[](auto& m) { m.clock_synchronised = false; }, {"wall clock: warn"}},
        {[](auto& m) { m.record_free_bytes = 0.9e9; }, {"disk of the record: fail"}},
        {[](auto& m) { m.record_rejection = "/r: Read-only file system"; }, {"disk of the record: fail"}},
    };
    for (const Bad& bad : machines) {
        MachineFacts facts = good_machine();
        bad.how(facts);
        CHECK(wrong(all(facts)) == bad.expected);
    }
}

TEST_CASE("what cannot be looked at is skipped, and says so", "[RT-130]") {
    MachineFacts facts = good_machine();
    facts.governors.clear();
    CHECK(named(all(facts), "frequency governor").verdict == controller::CheckResult::skipped);

    MachineNeeds needs = loop_needs();
    needs.cpu.reset();
    needs.priority = 0;
    const auto checks = all(good_machine(), needs);
    CHECK(wrong(checks) == Wrong{"scheduler rights: warn", "processor of the loop: warn"});
    CHECK(named(checks, "core isolation").verdict == controller::CheckResult::skipped);
}

TEST_CASE("facts are read where the kernel keeps them", "[RT-130]") {
    const Tree tree;
    tree.write("proc/sys/kernel/version", "#7 SMP PREEMPT_RT test");
    tree.write("sys/kernel/realtime", "1");
    tree.write("sys/devices/system/cpu/isolated", "1");
    tree.write("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "powersave");
    tree.write("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "performance");
    tree.write("sys/devices/system/cpu/cpufreq/policy0/scaling_governor", "none of these");
    tree.write("sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet");
    MachineNeeds needs;
    needs.record = tree.root() / "not/there/yet";
    MachineFacts facts = machine_facts(needs, tree.root());
    CHECK(facts.kernel == "#7 SMP PREEMPT_RT test");
    CHECK(facts.realtime_kernel);
    CHECK(facts.isolated == "1");
    CHECK(facts.clock_source == "hpet");
    REQUIRE(facts.governors.size() == 2);
    CHECK(facts.governors[0].name == "powersave");
    CHECK(facts.governors[1].cpu == 1);
    CHECK(facts.record_rejection.empty());
    CHECK(facts.record_free_bytes > 0.0);
    CHECK(facts.clock_resolution_s > 0.0);

    needs.cpu = 1;
    needs.record = tree.root() / "proc/sys/kernel/version/record";
    facts = machine_facts(needs, tree.root());
    REQUIRE(facts.governors.size() == 1);
    CHECK(facts.governors[0].name == "performance");
    CHECK_THAT(facts.record_rejection, ContainsSubstring("is no directory"));
}

TEST_CASE("this machine is looked at to an end, and a right that nobody has is not granted", "[RT-130]") {
    MachineNeeds needs = loop_needs();
    needs.priority = 1000;  // out of SCHED_FIFO's range
    needs.cpu = 1'000'000;
    const MachineFacts facts = controller::machine_facts(needs);
    CHECK_FALSE(facts.fifo_granted);
    CHECK_FALSE(facts.pinned);
    const auto checks = all(facts, needs);
    CHECK(named(checks, "scheduler rights").verdict == controller::CheckResult::fail);
    CHECK(named(checks, "processor of the loop").verdict == controller::CheckResult::fail);
}
