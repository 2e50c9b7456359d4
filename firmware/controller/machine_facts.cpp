#include <fcntl.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <sys/timex.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <fstream>
#include <string_view>
#include <system_error>
#include <thread>

#include "firmware/controller/machine.hpp"
#include "firmware/host/realtime.hpp"
#include "firmware/host/settings/number_in.hpp"

namespace antiskid::controller {

namespace {

std::string first_line(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    return line;
}

std::vector<MachineFacts::Governor> governors(const std::filesystem::path& processors, std::optional<int> only) {
    constexpr std::string_view kPrefix = "cpu";
    std::vector<MachineFacts::Governor> found;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(processors, none)) {
        const std::string folder = entry.path().filename().string();
        if (!folder.starts_with(kPrefix)) continue;
        const auto number = settings::number_in<int>(std::string_view(folder).substr(kPrefix.size()));
        if (!number || (only && *number != *only)) continue;
        std::string governor = first_line(entry.path() / "cpufreq/scaling_governor");
        if (!governor.empty()) found.push_back({*number, std::move(governor)});
    }
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.cpu < b.cpu; });
    return found;
}

/// The nearest folder above that is there: what is to be written will be made in it.
std::filesystem::path standing(const std::filesystem::path& place) {
    std::error_code error;
    std::filesystem::path path = std::filesystem::absolute(place, error);
    while (!std::filesystem::exists(path, error) && path.has_relative_path()) path = path.parent_path();
    return path;
}

void look_at_clock(MachineFacts& facts, const std::filesystem::path& root) {
    facts.clock_source = first_line(root / "sys/devices/system/clocksource/clocksource0/current_clocksource");
    timespec resolution{};
    clock_getres(CLOCK_MONOTONIC, &resolution);
    facts.clock_resolution_s = static_cast<double>(resolution.tv_sec) + 1e-9 * static_cast<double>(resolution.tv_nsec);
    timex wall{};
    facts.clock_synchronised = adjtimex(&wall) != TIME_ERROR && (wall.status & STA_UNSYNC) == 0;
}

/// Asks for a right on a thread of its own, so that it ends with it.
bool granted(const host::RealtimeRequest& request) {
    bool rejected = true;
    std::thread([&] { rejected = !host::enter_realtime(request).empty(); }).join();
    return !rejected;
}

}  // namespace

void look_at_record(MachineFacts& facts, const std::filesystem::path& record) {
    const std::filesystem::path place = standing(record);
    struct statvfs disk {};
    if (!std::filesystem::is_directory(place))
        facts.record_rejection = place.string() + " is no directory";
    else if (access(place.c_str(), W_OK | X_OK) != 0 || statvfs(place.c_str(), &disk) != 0)
        facts.record_rejection = place.string() + ": " + std::generic_category().message(errno);
    facts.record_free_bytes = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize);
}

MachineFacts machine_facts(const MachineNeeds& needs, const std::filesystem::path& root) {
    MachineFacts facts;
    facts.kernel = first_line(root / "proc/sys/kernel/version");
    facts.realtime_kernel = first_line(root / "sys/kernel/realtime") == "1";
    facts.fifo_granted = needs.priority > 0 && granted({.priority = needs.priority, .cpu = {}});
    rlimit limit{};
    if (getrlimit(RLIMIT_RTPRIO, &limit) == 0) facts.rtprio_limit = limit.rlim_cur;
    facts.memory_locked = !host::lock_memory();
    facts.pinned = needs.cpu && granted({.priority = 0, .cpu = needs.cpu});
    facts.governors = governors(root / "sys/devices/system/cpu", needs.cpu);
    facts.isolated = first_line(root / "sys/devices/system/cpu/isolated");
    look_at_clock(facts, root);
    look_at_record(facts, needs.record);
    return facts;
}

}  // namespace antiskid::controller
