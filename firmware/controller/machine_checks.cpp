#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "firmware/controller/machine.hpp"

namespace antiskid::controller {

namespace {

/// Whether a list as "2-3,5" has the number.
bool lists(std::string_view list, int number) {
    while (!list.empty()) {
        const std::string_view item = list.substr(0, list.find(','));
        list.remove_prefix(std::min(list.size(), item.size() + 1));
        int from = 0;
        const char* const end = item.data() + item.size();
        const auto first = std::from_chars(item.data(), end, from);
        if (first.ec != std::errc()) continue;
        int to = from;
        if (first.ptr != end && *first.ptr == '-') std::from_chars(first.ptr + 1, end, to);
        if (from <= number && number <= to) return true;
    }
    return false;
}

std::string rights_command(const std::string& program) {
    return fmt::format("setcap cap_sys_nice,cap_ipc_lock+ep $(command -v {0}), or run it as the service {0}@", program);
}

std::string size_text(double bytes) {
    return bytes < 1e9 ? fmt::format("{:.0f} MB", bytes * 1e-6) : fmt::format("{:.1f} GB", bytes * 1e-9);
}

Check kernel_check(const MachineFacts& facts) {
    const bool says_so = facts.kernel.find("PREEMPT_RT") != std::string::npos;
    const bool preempts = facts.kernel.find("PREEMPT") != std::string::npos;
    const bool realtime = facts.realtime_kernel || says_so;
    return judged("kernel preemption", realtime,
                  {.measured = realtime   ? "PREEMPT_RT"
                               : preempts ? "preemptible, not PREEMPT_RT"
                                          : "none: a system call of any program delays the loop",
                   .required = "PREEMPT_RT",
                   .remedy = "apt-get install linux-image-rt-amd64, then boot it"},
                  preempts ? CheckResult::warn : CheckResult::fail);
}

Check memory_check(const MachineFacts& facts, const MachineNeeds& needs) {
    return judged("memory lock", facts.memory_locked,
                  {.measured = facts.memory_locked ? "granted" : "refused: a page fault can delay the loop",
                   .required = "mlockall",
                   .remedy = rights_command(needs.program)});
}

Check processor_check(const MachineFacts& facts, const MachineNeeds& needs) {
    if (!needs.cpu)
        return {.name = "processor of the loop",
                .verdict = CheckResult::warn,
                .measured = "not pinned: it may move between processors",
                .required = "--cpu N, one that does nothing else",
                .remedy = "give --cpu, e.g. --cpu 1",
                .figures = {}};
    return judged(
        "processor of the loop", facts.pinned,
        {.measured = facts.pinned ? fmt::format("pinned to {}", *needs.cpu) : fmt::format("{} does not exist or is not allowed", *needs.cpu),
         .required = fmt::format("processor {}", *needs.cpu),
         .remedy = "give --cpu one of `taskset -cp $$`"});
}

Check isolation_check(const MachineFacts& facts, const MachineNeeds& needs) {
    const std::string required = "the loop's processor does nothing else";
    if (!needs.cpu) return skipped("core isolation", "the loop has no processor of its own", required);
    const int cpu = *needs.cpu;
    return judged("core isolation", lists(facts.isolated, cpu),
                  {.measured = facts.isolated.empty() ? "none" : "isolated: " + facts.isolated,
                   .required = fmt::format("isolcpus has {}", cpu),
                   .remedy = fmt::format("add `isolcpus={0} nohz_full={0} irqaffinity=0` to the kernel's command line and boot", cpu)},
                  CheckResult::warn);
}

Check governor_check(const MachineFacts& facts) {
    const std::string required = "performance";
    if (facts.governors.empty()) return skipped("frequency governor", "this kernel scales no frequency here", required);
    const auto slow = std::find_if(facts.governors.begin(), facts.governors.end(), [&](const auto& governor) { return governor.name != required; });
    const bool good = slow == facts.governors.end();
    return judged("frequency governor", good,
                  {.measured = good ? required : fmt::format("{} on processor {}", slow->name, slow->cpu),
                   .required = required,
                   .remedy = "cpupower frequency-set -g performance"});
}

}  // namespace

Check scheduler_check(const MachineFacts& facts, const MachineNeeds& needs) {
    const std::string required = fmt::format("SCHED_FIFO {}", needs.priority);
    if (needs.priority == 0)
        return {.name = "scheduler rights",
                .verdict = CheckResult::warn,
                .measured = "ordinary scheduling was asked for",
                .required = "SCHED_FIFO",
                .remedy = "give --priority 1 to 99",
                .figures = {}};
    return judged("scheduler rights", facts.fifo_granted,
                  {.measured = facts.fifo_granted ? "granted" : fmt::format("refused; RLIMIT_RTPRIO {}", facts.rtprio_limit),
                   .required = required,
                   .remedy = rights_command(needs.program)});
}

Checks real_time_checks(const MachineFacts& facts, const MachineNeeds& needs) {
    return {kernel_check(facts),           scheduler_check(facts, needs), memory_check(facts, needs),
            processor_check(facts, needs), isolation_check(facts, needs), governor_check(facts)};
}

Checks clock_checks(const MachineFacts& facts) {
    constexpr double kFine_s = 1e-6;
    // Read through the chipset they cost microseconds each, and the loop reads one in every period.
    const bool slow = facts.clock_source == "hpet" || facts.clock_source == "acpi_pm" || facts.clock_source.find("jiffies") != std::string::npos;
    return {judged("monotonic clock", !slow && facts.clock_resolution_s <= kFine_s,
                   {.measured = fmt::format("{}, {:.3g} ns", facts.clock_source, facts.clock_resolution_s * 1e9),
                    .required = "a processor's counter, 1000 ns or finer",
                    .remedy = "boot with clocksource=tsc tsc=reliable"}),
            judged("wall clock", facts.clock_synchronised,
                   {.measured = facts.clock_synchronised ? "synchronised" : "not synchronised",
                    .required = "synchronised: records carry its time",
                    .remedy = "timedatectl set-ntp true"},
                   CheckResult::warn)};
}

Check record_check(const MachineFacts& facts, const MachineNeeds& needs) {
    const std::string required = fmt::format("{} free in {}", size_text(needs.record_bytes), needs.record.string());
    if (!facts.record_rejection.empty())
        return judged(
            "disk of the record", false,
            {.measured = facts.record_rejection, .required = required, .remedy = "give a folder that is yours to write, or `chown` this one"});
    Check check = judged("disk of the record", facts.record_free_bytes >= needs.record_bytes,
                         {.measured = size_text(facts.record_free_bytes) + " free",
                          .required = required,
                          .remedy = "move old records away: du -xh " + needs.record.string() + " | sort -h"});
    check.figures = {{"free_bytes", facts.record_free_bytes}};
    return check;
}

}  // namespace antiskid::controller
