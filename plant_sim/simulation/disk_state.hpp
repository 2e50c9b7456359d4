/// State shared by SimulatedDisk and its SQLite VFS: files, names, cache and pending faults.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "plant_sim/simulation/allocation_gate.hpp"
#include "plant_sim/simulation/simulated_disk.hpp"
#include "rig_bridge/wear/draw.hpp"

namespace plant_sim::simulation {

/// A write to a file, or, if `cuts`, its truncation to `offset`.
struct FileChange {
    std::size_t offset = 0;
    std::string bytes{};
    bool cuts = false;
};

struct Node {
    bool directory = false;
    std::string now{};     // content that programs see
    std::string stored{};  // content on the disk
    std::vector<FileChange> cached{};
    std::uint64_t version = 0;  // of `now`, one for each content of any of the disk's files; 0: new and empty
};
using NodePointer = std::shared_ptr<Node>;

/// A change of a directory; `removed` and `added` are names in it and may be empty.
struct NameChange {
    std::string directory;
    std::string removed{};
    std::string added{};
    NodePointer node{};
};

struct PendingFault {
    std::uint64_t at;
    DiskFault fault;
    std::uint64_t lasts;
};

struct DiskState {
    DiskState(std::uint64_t seed, DiskTrace sink);

    [[nodiscard]] NodePointer find(const std::string& path) const;
    /// Returns the number of bytes written, or a negative errno.
    std::int64_t write(Node& node, const std::string& path, std::size_t offset, std::string_view bytes);
    int truncate(Node& node, const std::string& path, std::size_t size);
    int sync(Node& node, const std::string& path);
    int make(const std::string& path, bool directory);
    int remove(const std::string& path);
    int rename(const std::string& from, const std::string& to);
    /// `refusable`: whether the operation may be refused; otherwise only a power cut or a kill affects it.
    int sync_directory(const std::string& path, bool refusable = true);
    void restart();
    void kill();
    [[nodiscard]] bool killed() const { return killed_; }

    wear::Generator generator;
    DiskTrace trace;
    std::size_t sector;
    bool runs = true;
    bool paused = false;
    SqliteDeviation deviation = SqliteDeviation::none;
    std::uint64_t operations = 0;
    std::uint64_t since_restart = 0;
    std::vector<PendingFault> pending{};
    std::array<std::uint64_t, kDiskFaultNames.size()> fault_counts{};
    std::map<std::string, NodePointer> names{};
    std::set<std::string> held{};
    std::shared_ptr<AllocationGate> gate = std::make_shared<AllocationGate>();

  private:
    enum class Kind : std::uint8_t { write, create, sync, must_not_fail, other };
    /// The fault that affects this operation, if any.
    std::optional<DiskFault> next(Kind kind);
    int said(std::string_view what, const std::string& path, int error) const;
    /// Creates, renames or removes.
    int change_name(Kind kind, std::string_view what, const NameChange& change);
    void change(Node& node, FileChange by);
    void apply(const NameChange& change, std::map<std::string, NodePointer>& to) const;
    void keep_some(Node& node, double share);
    void lose_cache();
    bool happens(double chance) { return wear::uniform(generator) < chance; }

    bool killed_ = false;
    std::uint64_t versions_ = 0;
    std::map<std::string, NodePointer> stored_names_{};
    std::vector<NameChange> cached_names_{};
    std::vector<NodePointer> nodes_{};  // oldest first: a power cut draws for them in a reproducible order
};

/// Registers the disk's VFS with SQLite as `name`, for its lifetime.
class DiskVfs {
  public:
    DiskVfs(DiskState& state, std::string name);
    ~DiskVfs();
    DiskVfs(const DiskVfs&) = delete;
    DiskVfs& operator=(const DiskVfs&) = delete;
    [[nodiscard]] const char* name() const { return name_.c_str(); }

  private:
    struct Registered;
    std::string name_;
    std::unique_ptr<Registered> registered_;
};

}  // namespace plant_sim::simulation
