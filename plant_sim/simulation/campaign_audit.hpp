/// Compares what the programs of a campaign were told and have reported with the contents of a disk.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/can/frame.hpp"
#include "firmware/host/settings/file_descriptor.hpp"
#include "plant_sim/simulation/simulated_disk.hpp"
#include "rig_bridge/record/ledger.hpp"

namespace plant_sim::simulation {

/// Name of a simulated campaign, and path of its ledger.
inline constexpr const char* kSimulatedCampaign = "endurance";
inline constexpr const char* kSimulatedLedger = "/runs/brake7/campaign.sqlite";

/// Result of reading a bus.log.
struct ReadLog {
    std::uint64_t frames = 0;
    std::uint64_t in_order = 0;  ///< number of leading frames that are those written, in their order
    std::uint64_t steps_back = 0;
    bool damage_named = false;
};

/// A file in memory with a path, for the log reader, which opens its logs itself.
class MemoryFile {
  public:
    /// Throws std::system_error if there is no memory for it.
    explicit MemoryFile(std::string_view bytes);
    [[nodiscard]] std::string path() const;

  private:
    settings::FileDescriptor file_;
};

class CampaignAudit {
  public:
    /// Replaces the result of reading a log.
    using Reading = std::function<ReadLog(ReadLog)>;

    explicit CampaignAudit(std::shared_ptr<const SimulatedDisk> disk, Reading reading = {});

    /// Known facts of one attempt. Reports of a program whose disk has stopped do not count.
    struct Known {
        std::vector<antiskid::can::Frame> frames{};  ///< recorded
        std::uint64_t synced = 0;                    ///< number of them on the disk, as reported to the recorder
        bool begun = false;                          ///< the ledger has confirmed it
        bool finished = false;                       ///< reported as finished
        bool entry_refused = false;                  ///< the ledger has rejected the maneuver's end
        double finished_J = 0.0;                     ///< energy in that report
        std::set<double> measured_J{};               ///< every energy measured, live or from its log
        std::optional<std::uint64_t> log_version{};  ///< of the contents when they were read last
        ReadLog log{};                               ///< result of that reading
    };
    [[nodiscard]] Known& of(const rig::record::Attempt& attempt) { return known_[attempt.folder.string()]; }
    void begun(const rig::record::Attempt& attempt) { of(attempt).begun = disk_->runs(); }
    void synced(const rig::record::Attempt& attempt);
    void finished(const rig::record::Attempt& attempt, double counted_J);
    void refused(const rig::record::Attempt& attempt) { of(attempt).entry_refused = disk_->runs(); }

    [[nodiscard]] ReadLog read(const rig::record::Attempt& attempt);

    /// Violations of the invariants by the disk's present contents, which are read without the tested programs' storage.
    [[nodiscard]] std::vector<std::string> check();
    /// Rows that the last check() read.
    [[nodiscard]] const std::vector<rig::record::LedgerRow>& rows() const { return rows_; }
    [[nodiscard]] std::uint64_t damaged() const { return damaged_; }  ///< number of readings of logs that reported damage

  private:
    [[nodiscard]] bool read_rows();
    void check_rows();
    void check_folder(const rig::record::LedgerRow& row, const std::string& what);
    void check_known(const std::string& folder, Known& known);
    void violated(std::string what) { violations_.push_back(std::move(what)); }

    std::shared_ptr<const SimulatedDisk> disk_;
    Reading reading_;
    std::map<std::string, Known> known_;  // by folder
    std::vector<rig::record::LedgerRow> rows_;
    std::vector<std::string> violations_;
    std::uint64_t damaged_ = 0;
};

}  // namespace plant_sim::simulation
