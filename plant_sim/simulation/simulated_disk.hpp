/// A disk in memory with the failures of real disks: written data stay in a cache until they are synced, and a power cut keeps a part of them that is
/// drawn from a seed.
///
///     const auto disk = std::make_shared<SimulatedDisk>(seed);
///     disk->inject(37, DiskFault::power_cut);
///     ... write through it as settings::Storage, SQLite through sqlite_vfs() ...
///     if (!disk->runs()) disk->restart();   // now it holds what was left
///
/// A power cut keeps all synced data. Of the rest, each sector of each write, each truncation and each change of a directory is kept or lost
/// independently of its order; a sector may be torn, with only its first bytes new. Bytes that were not written do not change (SQLite's "powersafe
/// overwrite"). Only a sync of its directory keeps a name for certain. A failed sync discards a drawn part of the data, and the next sync does not
/// report that, as on Linux.
///
/// For one thread. SQLite opens files by the name of a VFS; each disk has its own.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "firmware/host/settings/storage.hpp"

namespace plant_sim::simulation {

/// `kill`: the program dies, the disk goes on.
enum class DiskFault : std::uint8_t { power_cut, kill, no_space, refused, short_write };
inline constexpr std::array<std::string_view, 5> kDiskFaultNames{"power_cut", "kill", "no_space", "refused", "short_write"};

/// Deviations of SQLite. `journal_name_unnoticed` is SQLite's own behaviour: its unix VFS ignores a refused sync of a new journal's directory, after
/// which a power cut in the same commit may damage the database. Without it that sync is never refused.
enum class SqliteDeviation : std::uint8_t { none, journal_name_unnoticed, removal_not_synced };

/// Called with a line for each operation that changes something.
using DiskTrace = std::function<void(const std::string& line)>;

class AllocationGate;
struct DiskState;

class SimulatedDisk final : public settings::Storage {
  public:
    explicit SimulatedDisk(std::uint64_t seed, DiskTrace trace = {}, SqliteDeviation deviation = SqliteDeviation::none);
    ~SimulatedDisk() override;

    /// Marks the disk's own allocations as the simulation's.
    void use(std::shared_ptr<AllocationGate> gate) const;

    /// Schedules a fault for the first operation that it can affect, from the `at`-th changing operation after the newest restart() on, counted from
    /// 1. `lasts`: number of operations affected by `no_space`.
    void inject(std::uint64_t at, DiskFault fault, std::uint64_t lasts = 1) const;
    /// The same, counted from the present operation.
    void inject_soon(std::uint64_t in, DiskFault fault, std::uint64_t lasts = 1) const;
    /// Kills the program now, outside of any operation.
    void kill() const;
    /// While paused, operations are not counted and no fault occurs.
    void pause(bool on) const;
    /// Removes pending faults and restarts the count of operations.
    void clear_faults() const;
    /// Number of faults that occurred, by kind.
    [[nodiscard]] const std::array<std::uint64_t, kDiskFaultNames.size()>& fault_counts() const;
    [[nodiscard]] std::uint64_t operations() const;  ///< since construction

    /// False after a power cut or a kill; every operation then fails.
    [[nodiscard]] bool runs() const;
    [[nodiscard]] bool power_cut() const;  ///< whether a power cut is the reason
    /// Lets the next program begin. Cuts the power first if the previous program has not ended by a fault.
    void restart() const;

    /// Present content of a file, without the copies that reading makes; valid until anything is changed. Empty: there is no such file.
    [[nodiscard]] std::string_view bytes(const std::filesystem::path& path) const;
    /// Version of that content: while it is the same, so are the bytes.
    [[nodiscard]] std::uint64_t version(const std::filesystem::path& path) const;

    [[nodiscard]] settings::OpenResult open(const std::filesystem::path& path) const override;
    [[nodiscard]] settings::OpenResult create(const std::filesystem::path& path) const override;
    [[nodiscard]] int make_directory(const std::filesystem::path& path) const override;
    [[nodiscard]] int sync_directory(const std::filesystem::path& path) const override;
    [[nodiscard]] int rename(const std::filesystem::path& from, const std::filesystem::path& to) const override;
    [[nodiscard]] int remove(const std::filesystem::path& path) const override;
    [[nodiscard]] std::filesystem::file_status status(const std::filesystem::path& path) const override;
    [[nodiscard]] std::filesystem::path canonical(const std::filesystem::path& path) const override { return path; }
    [[nodiscard]] std::variant<std::unique_ptr<settings::File>, settings::LockHolder> hold(const std::filesystem::path& path,
                                                                                           const std::string& who) const override;
    [[nodiscard]] std::optional<settings::LockHolder> held_by(const std::filesystem::path& path) const override;
    [[nodiscard]] const char* sqlite_vfs() const override;

  private:
    std::shared_ptr<DiskState> state_;
};

}  // namespace plant_sim::simulation
