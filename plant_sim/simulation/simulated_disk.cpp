#include "plant_sim/simulation/simulated_disk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "plant_sim/simulation/disk_state.hpp"

namespace plant_sim::simulation {

namespace fs = std::filesystem;

namespace {

struct DiskWithVfs : DiskState {
    DiskWithVfs(std::uint64_t seed, DiskTrace sink) : DiskState(seed, std::move(sink)) {}
    DiskVfs vfs{*this, fmt::format("simulated disk {}", static_cast<const void*>(this))};
};

class SimulatedFile final : public settings::File {
  public:
    SimulatedFile(std::shared_ptr<DiskState> disk, NodePointer node, std::string path)
        : disk_(std::move(disk)), node_(std::move(node)), path_(std::move(path)) {}

    std::int64_t read(std::span<char> bytes) override {
        if (!disk_->runs) return -EIO;
        if (node_->directory) return -EISDIR;
        const std::size_t count = std::min(bytes.size(), node_->now.size() - read_);
        std::copy_n(node_->now.data() + read_, count, bytes.data());
        read_ += count;
        return static_cast<std::int64_t>(count);
    }
    std::int64_t append(std::string_view bytes) override {
        const auto scope = disk_->gate->simulation();
        return disk_->write(*node_, path_, node_->now.size(), bytes);
    }
    int truncate(std::int64_t size) override {
        const auto scope = disk_->gate->simulation();
        return disk_->truncate(*node_, path_, static_cast<std::size_t>(size));
    }
    int sync() override {
        const auto scope = disk_->gate->simulation();
        return disk_->sync(*node_, path_);
    }
    int close() override { return disk_->runs ? 0 : EIO; }

  private:
    std::shared_ptr<DiskState> disk_;
    NodePointer node_;
    std::string path_;
    std::size_t read_ = 0;
};

class Hold final : public settings::File {
  public:
    Hold(std::shared_ptr<DiskState> disk, std::string path) : disk_(std::move(disk)), path_(std::move(path)) {}
    ~Hold() override { disk_->held.erase(path_); }
    std::int64_t read(std::span<char> /*bytes*/) override { return -EBADF; }
    std::int64_t append(std::string_view /*bytes*/) override { return -EBADF; }
    int truncate(std::int64_t /*size*/) override { return EBADF; }
    int sync() override { return 0; }
    int close() override { return 0; }

  private:
    std::shared_ptr<DiskState> disk_;
    std::string path_;
};

}  // namespace

SimulatedDisk::SimulatedDisk(std::uint64_t seed, DiskTrace trace, SqliteDeviation deviation)
    : state_(std::make_shared<DiskWithVfs>(seed, std::move(trace))) {
    state_->deviation = deviation;
}
SimulatedDisk::~SimulatedDisk() = default;

void SimulatedDisk::use(std::shared_ptr<AllocationGate> gate) const {
    state_->gate = std::move(gate);
}

void SimulatedDisk::inject(std::uint64_t at, DiskFault fault, std::uint64_t lasts) const {
    state_->pending.push_back({.at = at, .fault = fault, .lasts = lasts});
}

void SimulatedDisk::inject_soon(std::uint64_t in, DiskFault fault, std::uint64_t lasts) const {
    inject(state_->since_restart + in, fault, lasts);
}

void SimulatedDisk::kill() const {
    state_->kill();
}

void SimulatedDisk::pause(bool on) const {
    state_->paused = on;
}

void SimulatedDisk::clear_faults() const {
    state_->pending.clear();
    state_->since_restart = 0;
}

const std::array<std::uint64_t, kDiskFaultNames.size()>& SimulatedDisk::fault_counts() const {
    return state_->fault_counts;
}

std::uint64_t SimulatedDisk::operations() const {
    return state_->operations;
}

bool SimulatedDisk::runs() const {
    return state_->runs;
}

bool SimulatedDisk::power_cut() const {
    return !state_->runs && !state_->killed();
}

void SimulatedDisk::restart() const {
    state_->restart();
}

std::string_view SimulatedDisk::bytes(const fs::path& path) const {
    const NodePointer node = state_->find(path.string());
    return node ? std::string_view(node->now) : std::string_view();
}

std::uint64_t SimulatedDisk::version(const fs::path& path) const {
    const NodePointer node = state_->find(path.string());
    return node ? node->version : 0;
}

settings::OpenResult SimulatedDisk::open(const fs::path& path) const {
    const auto scope = state_->gate->simulation();
    if (!state_->runs) return {.file = nullptr, .error = EIO};
    const NodePointer node = state_->find(path.string());
    if (!node) return {.file = nullptr, .error = ENOENT};
    return {.file = std::make_unique<SimulatedFile>(state_, node, path.string())};
}

settings::OpenResult SimulatedDisk::create(const fs::path& path) const {
    const auto scope = state_->gate->simulation();
    if (const int error = state_->make(path.string(), false); error != 0) return {.file = nullptr, .error = error};
    return open(path);
}

int SimulatedDisk::make_directory(const fs::path& path) const {
    const auto scope = state_->gate->simulation();
    return state_->make(path.string(), true);
}

int SimulatedDisk::sync_directory(const fs::path& path) const {
    const auto scope = state_->gate->simulation();
    return state_->sync_directory(path.string());
}

int SimulatedDisk::rename(const fs::path& from, const fs::path& to) const {
    const auto scope = state_->gate->simulation();
    return state_->rename(from.string(), to.string());
}

int SimulatedDisk::remove(const fs::path& path) const {
    const auto scope = state_->gate->simulation();
    return state_->remove(path.string());
}

fs::file_status SimulatedDisk::status(const fs::path& path) const {
    const auto scope = state_->gate->simulation();
    const NodePointer node = state_->find(path.string());
    return fs::file_status(!node ? fs::file_type::not_found : node->directory ? fs::file_type::directory : fs::file_type::regular);
}

std::variant<std::unique_ptr<settings::File>, settings::LockHolder> SimulatedDisk::hold(const fs::path& path, const std::string& /*who*/) const {
    const auto scope = state_->gate->simulation();
    if (!state_->runs) throw std::system_error(EIO, std::generic_category(), path.string());
    if (!state_->held.insert(path.string()).second) return settings::LockHolder{};
    return std::make_unique<Hold>(state_, path.string());
}

std::optional<settings::LockHolder> SimulatedDisk::held_by(const fs::path& path) const {
    const auto scope = state_->gate->simulation();
    return state_->held.contains(path.string()) ? std::optional(settings::LockHolder{}) : std::nullopt;
}

const char* SimulatedDisk::sqlite_vfs() const {
    return static_cast<const DiskWithVfs&>(*state_).vfs.name();
}

}  // namespace plant_sim::simulation
