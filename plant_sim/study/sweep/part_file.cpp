#include "plant_sim/study/sweep/part_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace sweep {

namespace {

int opened(const std::filesystem::path& path) {
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
    constexpr mode_t kPermissions = 0666;
    return ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, kPermissions);
}

[[noreturn]] void fail(const std::filesystem::path& path) {
    throw std::runtime_error(fmt::format("{}: {}", path.string(), std::strerror(errno)));
}

std::string text_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) fail(path);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Checks that the rows are of this sweep.
void check(const StopsTable& found, const SweepPlan& plan) {
    const std::string differs = difference(found.identity, identity_of(plan));
    if (!differs.empty())
        throw settings::Error(found.name, 1, "", fmt::format("left by another sweep: {}; remove it to begin anew, or give another --out", differs));
    for (const SweptStop& row : found.rows) {
        if (row.stop != plan.stop(row.stop.number))
            throw settings::Error(found.name, 0, "stop",
                                  fmt::format("{} is another stop in this sweep; remove the file to begin anew", row.stop.number));
    }
}

}  // namespace

PartFile::PartFile(std::filesystem::path path, const SweepPlan& plan) : path_(std::move(path)), file_(opened(path_)) {
    if (!file_.is_open()) fail(path_);
    if (::flock(file_.get(), LOCK_EX | LOCK_NB) != 0) throw std::runtime_error(path_.string() + ": another sweep is at work on it");
    const std::string first_lines = head(identity_of(plan));
    const std::string there = text_of(path_);
    // A program that was killed before its first lines were complete has not begun.
    const bool begun = !there.empty() && !(there.size() < first_lines.size() && first_lines.starts_with(there));
    StopsTable found;
    if (begun) {
        found = parse_stops(path_.string(), there);
        check(found, plan);
    }
    if (::ftruncate(file_.get(), static_cast<off_t>(found.whole)) != 0) fail(path_);
    rows_ = std::move(found.rows);
    if (!begun) append(first_lines);
}

void PartFile::append(std::string_view lines) {
    while (!lines.empty()) {
        const ssize_t written = ::write(file_.get(), lines.data(), lines.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail(path_);
        lines.remove_prefix(static_cast<std::size_t>(written));
    }
}

}  // namespace sweep
