/// The campaign ledger: an SQLite file with a row for every maneuver. Changes made by begin() and finish(), once they return, survive SIGKILL, a
/// power cut at any write and a full disk, if the disk keeps what it reports as stored. One case is not covered (in SQLite itself): the disk refuses
/// the sync of the directory with a new journal, and power is cut in the same commit. The ledger may then be damaged, which is reported when it is
/// opened.
///
///     Ledger ledger("runs/campaign.sqlite");
///     ledger.open_campaign(campaign, IfChanged::reject);      // new, or resumed; settles what a killed bridge left
///     while (auto number = ledger.next_number()) {            // none: the campaign is complete
///         const Attempt attempt = ledger.begin(*number, started);
///         ... run it, record into attempt.folder, write_summary(attempt.folder / "summary.json", summary) ...
///         ledger.finish(summary);
///     }
///
/// One row is one attempt at one maneuver. It is `running` from begin() to finish(). If the bridge dies in between, the next open_campaign() makes it
/// `finished` (or `aborted`) if its folder holds the maneuver's complete summary.json, else `unfinished`: its number is then run again as a new
/// attempt in its own folder, and the braking in its log still counts. No number can be finished twice.
///
/// Entries are never overwritten. A maneuver's contribution to the cumulative energy is corrected by amendments, with who, when and why; its serial
/// numbers, operator and notes by notes. Readers see the corrected sums and texts.
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
#include <tuple>
#include <vector>

#include "firmware/host/settings/storage.hpp"
#include "rig_bridge/record/health.hpp"
#include "rig_bridge/record/summary.hpp"
#include "rig_bridge/record/wear_reading.hpp"

namespace rig::record {

/// The ledger could not be read or written: disk full, held by another process, damaged. `what()` names the file. The operation has then changed
/// nothing, except for LedgerInDoubt.
class LedgerError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The last sync of a commit failed: the operation may or may not be in the ledger.
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
    Specimen specimen{};  ///< for maneuvers begun from now on
};

/// What to do when a campaign is resumed with another scenario, seed, config hash, brake or disc.
enum class IfChanged : std::uint8_t { reject, go_on };

struct Attempt {
    std::int64_t number = 0;
    std::int64_t attempt = 0;      ///< from 1
    std::filesystem::path folder;  ///< not created yet; CAMPAIGN/0001 beside the ledger, CAMPAIGN/0001.2 for the second attempt

    friend bool operator==(const Attempt& a, const Attempt& b) { return a.number == b.number && a.attempt == b.attempt; }
    friend bool operator<(const Attempt& a, const Attempt& b) { return std::tie(a.number, a.attempt) < std::tie(b.number, b.attempt); }
};

enum class RowState : std::uint8_t { running, finished, aborted, unfinished };

/// A person's correction of a maneuver's contribution to the cumulative energy.
struct Amendment {
    double counted_J = 0.0;
    std::string who;
    std::string made;  ///< wall clock, ISO 8601 UTC
    std::string why;
};

/// A person's later note on a maneuver's specimen, or the wear that was read after it.
struct Note {
    std::string field;  ///< key of kSpecimenFields or kWearReadingFields
    std::string text;   ///< replaces what was there; for `notes`: added to it
    std::string who;
    std::string made{};  ///< wall clock, ISO 8601 UTC
};

struct LedgerRow {
    RowState state = RowState::running;
    Attempt attempt;
    /// Without figures only what was known at begin(). Cumulative energy as amended, specimen as noted.
    Summary summary;
    bool has_figures = false;           ///< finished, aborted, or unfinished with a log
    double counted_J = 0.0;             ///< its contribution to the cumulative energy, as amended
    std::vector<Amendment> amendments;  ///< oldest first
    std::vector<Note> notes;            ///< oldest first
    Specimen recorded;                  ///< as given to begin()
    WearReading worn;                   ///< after it, as noted
    Health health;                      ///< unknown unless it finished and was judged
    /// Slip reference of the maneuver; NaN: another law, or a ledger from before it was stored.
    double slip_reference = std::numeric_limits<double>::quiet_NaN();
};

struct LedgerOptions {
    /// False: commits do not wait for the disk (for repeatable in-process runs). Safe against SIGKILL, not against a power cut.
    bool durable = true;
    int busy_timeout_ms = 5000;  ///< longest wait for a reader's lock
    std::shared_ptr<const settings::Storage> storage = std::make_shared<settings::PosixStorage>();
};

/// Reads outcome, figures and warnings from the log in an attempt's folder; none if it has no braking.
using MeterLog = std::function<std::optional<Summary>(const Attempt&)>;

/// Result of open_campaign().
struct Resumed {
    bool created = false;                  ///< the campaign is new
    std::vector<std::int64_t> adopted;     ///< numbers whose summary.json existed but was not entered
    std::vector<std::int64_t> unfinished;  ///< numbers left by a bridge that died
    std::vector<std::string> changed;      ///< "seed was 1, is 2": only with IfChanged::go_on
};

class Ledger {
  public:
    /// Opens or creates `path`; an older schema is upgraded, keeping all rows. Throws settings::Error if the file is not a ledger or has a newer
    /// schema, LedgerError if it is held, damaged or not writable.
    explicit Ledger(const std::filesystem::path& path, const LedgerOptions& options = {});
    ~Ledger();
    Ledger(const Ledger&) = delete;
    Ledger& operator=(const Ledger&) = delete;

    /// Selects the campaign for the functions below. An existing one takes `planned` (with go_on also the rest) from `campaign`; specimen fields that
    /// are empty there are kept. Throws settings::Error if it differs and `changed` is `reject`. `meter`: reads the log of an attempt that a dead
    /// bridge left.
    Resumed open_campaign(const Campaign& campaign, IfChanged changed, const MeterLog& meter = {});

    /// Selects a campaign without settling running attempts. Throws settings::Error if there is none of that name.
    void choose(const std::string& campaign);

    /// The lowest number that is not finished; none if all planned ones are. An aborted maneuver is run again.
    [[nodiscard]] std::optional<std::int64_t> next_number() const;
    /// Brake energy of all rows with figures, as amended.
    [[nodiscard]] double cumulative_energy_J() const;
    [[nodiscard]] std::int64_t finished_count() const;

    /// `started`: wall clock, ISO 8601 UTC. `slip_reference`: of the slip law. Throws LedgerError if a maneuver is running.
    [[nodiscard]] Attempt begin(std::int64_t number, const std::string& started, std::optional<double> slip_reference = {});
    /// The same with another specimen than the campaign's.
    [[nodiscard]] Attempt begin(std::int64_t number, const std::string& started, std::optional<double> slip_reference, const Specimen& specimen);
    /// Specimen for maneuvers begun from now on.
    [[nodiscard]] const Specimen& specimen() const;
    /// Enters the running maneuver: `finished` if that is the outcome, else `aborted`. Throws LedgerError if none is running, or its campaign or
    /// number differs.
    void finish(const Summary& summary);
    /// Enters the brake's health after a finished maneuver. Throws LedgerError if no such maneuver is finished.
    void judge(std::int64_t number, const Health& health);
    /// The running maneuver ended with an incomplete record; what is known of it still counts.
    void mark_unfinished(const std::optional<Summary>& known = {});
    /// Sets the attempt's contribution to the cumulative energy to `amendment.counted_J`. Throws LedgerError if the attempt has not ended, or `who`
    /// or `why` is empty.
    void amend(std::int64_t number, std::int64_t attempt, const Amendment& amendment);
    /// Adds a note, which readers see from now on. Throws LedgerError if there is no such attempt or field, or `who` or `text` is empty;
    /// std::invalid_argument for a text that is none of its field.
    void note(std::int64_t number, std::int64_t attempt, const Note& note);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Every row of a campaign, oldest first, without taking the lock; an older schema is read and not changed. Throws settings::Error if the file is not
/// a ledger, has a newer schema or no such campaign.
[[nodiscard]] std::vector<LedgerRow> read_ledger(const std::filesystem::path& path, const std::string& campaign, const LedgerOptions& options = {});
/// The row of this attempt; null: there is none.
[[nodiscard]] const LedgerRow* row_of(const std::vector<LedgerRow>& rows, const Attempt& attempt);
/// The campaigns of a ledger, oldest first.
[[nodiscard]] std::vector<Campaign> read_campaigns(const std::filesystem::path& path, const LedgerOptions& options = {});

/// Whether a process has this ledger open for writing. Changes nothing.
[[nodiscard]] bool is_held(const std::filesystem::path& path);
/// Who has this ledger open for writing, or why it cannot be opened; none: it is free.
[[nodiscard]] std::optional<std::string> held_by_another(const std::filesystem::path& path);

[[nodiscard]] const char* name(RowState state);

}  // namespace rig::record
