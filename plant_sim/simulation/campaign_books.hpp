/// What the programs of a campaign were told and have said, held against what a disk has of it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/can/frame.hpp"
#include "firmware/host/settings/file_descriptor.hpp"
#include "plant_sim/simulation/simulated_disk.hpp"
#include "rig_bridge/record/ledger.hpp"

namespace plant_sim::simulation {

/// Of a simulated campaign, and where its ledger is.
inline constexpr const char* kSimulatedCampaign = "endurance";
inline constexpr const char* kSimulatedLedger = "/runs/brake7/campaign.sqlite";

/// What the log reader says of a bus.log.
struct ReadLog {
    std::uint64_t frames = 0;
    std::uint64_t in_order = 0;  ///< from the first on, as they were written
    std::uint64_t steps_back = 0;
    bool damage_named = false;
};

/// A file in memory with a path: the log reader opens its logs by itself.
class PassingFile {
  public:
    /// Throws std::system_error when there is no memory for it.
    explicit PassingFile(std::string_view bytes);
    [[nodiscard]] std::string path() const;

  private:
    settings::FileDescriptor file_;
};

class CampaignBooks {
  public:
    /// What is believed of a log.
    using Reading = std::function<ReadLog(ReadLog)>;

    explicit CampaignBooks(std::shared_ptr<const SimulatedDisk> disk, Reading reading = {});

    /// Of one attempt. What a program does once its disk no longer runs, it does not do.
    struct Known {
        std::vector<antiskid::can::Frame> frames{};  ///< recorded
        std::uint64_t synced = 0;                    ///< of them on the disk, as the recorder was told
        bool begun = false;                          ///< the ledger said so
        bool finished = false;                       ///< said to be finished
        bool entry_refused = false;                  ///< the ledger refused its finish
        double finished_J = 0.0;                     ///< with so much
        std::set<double> measured_J{};               ///< by whoever measured it, live or from its log
        bool log_read = false;
        std::string log_bytes{};  ///< as they were then
        ReadLog log{};            ///< what was found
    };
    [[nodiscard]] Known& of(const rig::record::Attempt& attempt) { return known_[attempt.folder.string()]; }
    void begun(const rig::record::Attempt& attempt) { of(attempt).begun = disk_->runs(); }
    void synced(const rig::record::Attempt& attempt);
    void finished(const rig::record::Attempt& attempt, double counted_J);
    void refused(const rig::record::Attempt& attempt) { of(attempt).entry_refused = disk_->runs(); }

    [[nodiscard]] ReadLog read(const rig::record::Attempt& attempt);

    /// What does not hold, by the disk as it is now and nobody's storage in between.
    [[nodiscard]] std::vector<std::string> check();
    /// As check() last found them.
    [[nodiscard]] const std::vector<rig::record::LedgerRow>& rows() const { return rows_; }
    [[nodiscard]] std::uint64_t damaged() const { return damaged_; }  ///< logs of which the reader says so, each time that it looked

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
