/// The campaign ledger: an SQLite file with a row for every maneuver. What begin() and finish() have returned from survives SIGKILL, a power cut at
/// any write and a full disk, where the disk keeps what it says that it has stored. One case is open, SQLite's own: the disk refuses the sync of
/// the directory with a new journal, and the power is cut in the same commit. The ledger may then be damaged, and whoever opens it says so.
///
///     Ledger ledger("runs/campaign.sqlite");
///     ledger.open_campaign(campaign, IfChanged::refuse);      // new, or resumed; settles what a killed bridge left
///     while (auto number = ledger.next_number()) {            // none: the campaign is complete
///         const Attempt attempt = ledger.begin(*number, started);
///         ... run it, record into attempt.folder, write_summary(attempt.folder / "summary.json", summary) ...
///         ledger.finish(summary);
///     }
///
/// One row is one attempt at one maneuver. `running` from begin() to finish(); a bridge that dies in between leaves it so, and
/// the next open_campaign() makes it `finished` (or `aborted`) when its folder holds the whole summary.json of that maneuver,
/// else `unfinished`: its number is then run again as a new attempt in a folder of its own, and what its log says was braked counts.
/// No number can be finished twice.
///
/// Nothing that was entered is ever overwritten. What a maneuver adds to the cumulative energy is amended by rows of their own, with who,
/// when and why, and its serial numbers, operator and notes by notes; readers see the amended sums and texts.
///
/// Rows are written in transactions with synchronous = EXTRA. One process at a time holds a ledger (a lock beside it, freed by the
/// kernel when the process dies); readers are free to look (read_ledger(), sqlite3).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/host/settings/storage.hpp"
#include "rig_bridge/record/health.hpp"
#include "rig_bridge/record/summary.hpp"

namespace rig::record {

/// The ledger could not be read or written: disk full, held by somebody else, damaged. `what()` names the file. Nothing of the
/// operation is in the ledger then, but for LedgerInDoubt.
class LedgerError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The disk refused the last step, which makes that the rest survives a power cut: the operation may be in the ledger or not.
class LedgerInDoubt : public LedgerError {
  public:
    using LedgerError::LedgerError;
};

struct Campaign {
    std::string name;
    std::string scenario;
    std::uint64_t seed = 0;    ///< below 2^63
    std::int64_t planned = 0;  ///< maneuvers
    std::string config_hash;
    std::string version;
    std::string created;  ///< wall clock, ISO 8601 UTC
    Specimen specimen{};  ///< of the maneuvers from now on
};

/// What to do when a campaign is resumed with another scenario, seed, config hash, brake or disc.
enum class IfChanged : std::uint8_t { reject, go_on };

struct Attempt {
    std::int64_t number = 0;
    std::int64_t attempt = 0;      ///< from 1
    std::filesystem::path folder;  ///< not made yet; CAMPAIGN/0001 beside the ledger, CAMPAIGN/0001.2 for the second attempt
};

enum class RowState : std::uint8_t { running, finished, aborted, unfinished };

/// What a person said that a maneuver adds to the cumulative energy.
struct Amendment {
    double counted_J = 0.0;
    std::string who;
    std::string made;  ///< wall clock, ISO 8601 UTC
    std::string why;
};

/// What a person said afterwards of a maneuver's specimen.
struct Note {
    std::string field;  ///< key of kSpecimenFields
    std::string text;   ///< instead of what the row says; of `notes`: besides it
    std::string who;
    std::string made{};  ///< wall clock, ISO 8601 UTC
};

struct LedgerRow {
    RowState state = RowState::running;
    Attempt attempt;
    /// Until it has figures only what was known at its begin; cumulative energy as amended, specimen as noted.
    Summary summary;
    bool has_figures = false;           ///< finished, aborted, or unfinished with a log
    double counted_J = 0.0;             ///< its part of the cumulative energy, as amended
    std::vector<Amendment> amendments;  ///< oldest first
    std::vector<Note> notes;            ///< oldest first
    Specimen recorded;                  ///< as it was begun
    Health health;                      ///< unknown unless it finished and was judged
    /// In force; NaN: another law than slip, or a maneuver of a ledger that did not keep it.
    double slip_reference = std::numeric_limits<double>::quiet_NaN();
};

struct LedgerOptions {
    /// False: commits are not waited for (a run in process that can be repeated). SIGKILL does no harm even then; a power cut may.
    bool durable = true;
    int busy_timeout_ms = 5000;  ///< how long a reader may be in the way
    std::shared_ptr<const settings::Storage> storage = std::make_shared<settings::PosixStorage>();
};

/// What the log of an attempt's folder says: outcome, figures and warnings; none when there is no braking in it.
using MeterLog = std::function<std::optional<Summary>(const Attempt&)>;

/// What open_campaign() found.
struct Resumed {
    bool created = false;                  ///< no such campaign so far
    std::vector<std::int64_t> adopted;     ///< numbers that were finished but not entered
    std::vector<std::int64_t> unfinished;  ///< numbers that a dead bridge had left
    std::vector<std::string> changed;      ///< "seed was 1, is 2": only with IfChanged::go_on
};

class Ledger {
  public:
    /// Opens `path`, or makes it; a ledger of an older schema is brought to this one, all of its rows kept. Throws settings::Error when the
    /// file is something else or of a newer schema, LedgerError when it is held, damaged or cannot be written.
    explicit Ledger(const std::filesystem::path& path, const LedgerOptions& options = {});
    ~Ledger();
    Ledger(const Ledger&) = delete;
    Ledger& operator=(const Ledger&) = delete;

    /// Chooses the campaign for everything below. An old one takes over `planned` (and with go_on the rest) from `campaign`; what that does not
    /// say of the specimen stays. Throws
    /// settings::Error when it differs and `changed` refuses. `meter`: for what a dead bridge has left.
    Resumed open_campaign(const Campaign& campaign, IfChanged changed, const MeterLog& meter = {});

    /// Chooses a campaign as it is: nothing is settled. Throws settings::Error when there is none of that name.
    void choose(const std::string& campaign);

    /// The lowest number that is not finished; none when all that are planned are. An aborted maneuver is run again.
    [[nodiscard]] std::optional<std::int64_t> next_number() const;
    /// Brake energy of all rows with figures, as amended.
    [[nodiscard]] double cumulative_energy_J() const;
    [[nodiscard]] std::int64_t finished_count() const;

    /// `started`: wall clock, ISO 8601 UTC. `slip_reference`: that of the slip law. Throws LedgerError when one is running.
    [[nodiscard]] Attempt begin(std::int64_t number, const std::string& started, std::optional<double> slip_reference = {});
    /// The same of another specimen than the campaign's.
    [[nodiscard]] Attempt begin(std::int64_t number, const std::string& started, std::optional<double> slip_reference, const Specimen& specimen);
    /// Of the maneuvers that begin from now on.
    [[nodiscard]] const Specimen& specimen() const;
    /// Enters the running maneuver of that number: `finished` when that is the outcome, else `aborted`. Throws LedgerError when
    /// none is running, or campaign or number is another.
    void finish(const Summary& summary);
    /// What is thought of the brake after a finished maneuver. Throws LedgerError when no such maneuver is finished.
    void judge(std::int64_t number, const Health& health);
    /// The running maneuver ended without a whole record; what is known of it counts nevertheless.
    void mark_unfinished(const std::optional<Summary>& known = {});
    /// From now on this attempt adds `amendment.counted_J` to the cumulative energy. Throws LedgerError when it has not ended, or `who`
    /// or `why` is empty.
    void amend(std::int64_t number, std::int64_t attempt, const Amendment& amendment);
    /// From now on readers see this text. Throws LedgerError when there is no such attempt, no such field, or `who` or `text` is empty.
    void note(std::int64_t number, std::int64_t attempt, const Note& note);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Every row of a campaign, oldest first, without taking the lock; a ledger of an older schema is read and left as it is. Throws
/// settings::Error when the file is no ledger, is of a newer schema or has no such campaign.
[[nodiscard]] std::vector<LedgerRow> read_ledger(const std::filesystem::path& path, const std::string& campaign, const LedgerOptions& options = {});
/// The campaigns of a ledger, oldest first.
[[nodiscard]] std::vector<Campaign> read_campaigns(const std::filesystem::path& path, const LedgerOptions& options = {});

/// Whether a bridge has this ledger open for writing. Leaves no trace.
[[nodiscard]] bool is_held(const std::filesystem::path& path);
/// Who has this ledger open for writing, or why nobody can; none: it is free.
[[nodiscard]] std::optional<std::string> held_by_another(const std::filesystem::path& path);

[[nodiscard]] const char* name(RowState state);

}  // namespace rig::record
