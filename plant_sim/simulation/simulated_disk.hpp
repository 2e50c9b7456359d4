/// A disk in memory that does what disks do to programs: what was written stays in a cache until it is synced, and a power cut leaves of the rest
/// what a seed draws.
///
///     const auto disk = std::make_shared<SimulatedDisk>(seed);
///     disk->strike(37, DiskFault::power_cut);
///     ... write through it as settings::Storage, SQLite through sqlite_vfs() ...
///     if (!disk->runs()) disk->restart();   // now it holds what was left
///
/// A cut keeps all that was synced. Of what was not, each sector of each write, each truncation and each change of a directory is there or not,
/// whatever came before it; a sector may be torn: its first bytes are new. A byte that nobody wrote is never touched (SQLite's "powersafe
/// overwrite"). A name is kept for certain by a sync of its directory alone. A failed sync throws away a drawn part of what it should have
/// stored, and the next one says nothing of it, as Linux does.
///
/// One thread. SQLite opens files by the name of a VFS: two disks at a time need two names, which they have.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "firmware/host/settings/storage.hpp"

namespace plant_sim::simulation {

/// `kill`: the program dies, and the disk goes on.
enum class DiskFault : std::uint8_t { power_cut, kill, no_space, refused, short_write };
inline constexpr std::array<std::string_view, 5> kDiskFaultNames{"power_cut", "kill", "no_space", "refused", "short_write"};

/// What SQLite does otherwise than asked. `journal_name_unnoticed` is no mistake of ours: its unix VFS lets it be when the sync of a new journal's
/// directory is refused, and a power cut in the same commit may then damage the database. Else that sync is not refused.
enum class SqliteLapse : std::uint8_t { none, journal_name_unnoticed, removal_not_synced };

/// Takes a line for each operation that changes something.
using DiskTrace = std::function<void(const std::string& line)>;

class AllocationGate;
struct DiskState;

class SimulatedDisk final : public settings::Storage {
  public:
    explicit SimulatedDisk(std::uint64_t seed, DiskTrace trace = {}, SqliteLapse lapse = SqliteLapse::none);
    ~SimulatedDisk() override;

    /// What the disk itself allocates is the simulation's.
    void use(std::shared_ptr<AllocationGate> gate) const;

    /// From the `at`-th changing operation since the newest restart(), counted from 1, the first that `fault` can befall. Of `no_space`: for
    /// `lasts` of them.
    void strike(std::uint64_t at, DiskFault fault, std::uint64_t lasts = 1) const;
    /// The same, counted from now on.
    void strike_soon(std::uint64_t in, DiskFault fault, std::uint64_t lasts = 1) const;
    /// The program dies now, and not by an operation of the disk.
    void kill() const;
    /// Meanwhile nothing strikes, and no operation counts.
    void pause(bool on) const;
    /// Takes back what has not struck yet, and counts operations from here.
    void calm() const;
    /// What has struck, by kind.
    [[nodiscard]] const std::array<std::uint64_t, kDiskFaultNames.size()>& struck() const;
    [[nodiscard]] std::uint64_t operations() const;  ///< of its whole life

    /// False after a power cut or a kill: every operation fails.
    [[nodiscard]] bool runs() const;
    [[nodiscard]] bool power_cut() const;  ///< that is why
    /// The next program can begin. Cuts the power first where no strike has ended the one before.
    void restart() const;

    /// Of a file as a program reads it now, without the copies that reading makes; until anything is changed. Empty: there is none.
    [[nodiscard]] std::string_view bytes(const std::filesystem::path& path) const;

    [[nodiscard]] settings::Opened open(const std::filesystem::path& path) const override;
    [[nodiscard]] settings::Opened create(const std::filesystem::path& path) const override;
    [[nodiscard]] int make_directory(const std::filesystem::path& path) const override;
    [[nodiscard]] int sync_directory(const std::filesystem::path& path) const override;
    [[nodiscard]] int rename(const std::filesystem::path& from, const std::filesystem::path& to) const override;
    [[nodiscard]] int remove(const std::filesystem::path& path) const override;
    [[nodiscard]] std::filesystem::file_status status(const std::filesystem::path& path) const override;
    [[nodiscard]] std::filesystem::path canonical(const std::filesystem::path& path) const override { return path; }
    [[nodiscard]] std::variant<std::unique_ptr<settings::File>, settings::HeldBy> hold(const std::filesystem::path& path,
                                                                                       const std::string& who) const override;
    [[nodiscard]] std::optional<settings::HeldBy> held_by(const std::filesystem::path& path) const override;
    [[nodiscard]] const char* sqlite_vfs() const override;

  private:
    std::shared_ptr<DiskState> state_;
};

}  // namespace plant_sim::simulation
