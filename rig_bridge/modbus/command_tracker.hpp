/// Which command is to be sent under which commit number, and what became of it. No link and no clock of its own.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "rig_bridge/rig/register_codec.hpp"
#include "rig_bridge/rig/register_map.hpp"

namespace rig::modbus {

using ClockTime = std::chrono::nanoseconds;

enum class CommandState : std::uint8_t {
    none,        ///< nothing has been commanded yet
    pending,     ///< on its way, or not yet confirmed by the PLC
    applied,     ///< the PLC took the newest command over
    rejected,    ///< the PLC refused it: not sent again until it changes or the link is opened anew
    unsendable,  ///< it was not sent, because a value is NaN or out of its range
};
[[nodiscard]] std::string_view name(CommandState state);

class CommandTracker {
  public:
    explicit CommandTracker(const RegisterMap& map);

    /// The newest wish; bridge_watchdog and commit of it are ignored.
    void want(const CommandedValues& wanted, ClockTime now);
    /// The link was opened anew and the PLC's commit register holds `commit`: what it knows of us is uncertain.
    void reconnected(std::uint16_t commit, ClockTime now);

    /// The command to send, commit number included, if there is one; goes on being the same until sending() or a new wish.
    [[nodiscard]] std::optional<RegisterImage> due();
    /// The PLC's commit register, read before due() goes out. A number that is neither our newest, nor known, nor 0 is somebody else's command,
    /// which ours is about to replace: it is counted.
    void standing(std::uint16_t commit);
    /// All of what due() gave is written but its commit number, which goes out now. There may be a newer wish already.
    void sending(const RegisterImage& image);
    /// Registers of the PLC. A number that has changed to one that is none of ours means that somebody else commands: it is counted, and ours
    /// is due again, whole. The first reading on a link is taken as it is.
    void seen(std::uint16_t applied, std::uint16_t rejected, ClockTime now);

    [[nodiscard]] CommandState state() const;
    [[nodiscard]] std::uint16_t commit() const { return commit_; }  ///< newest in use, 0 none
    /// Of commands that were not ours, whether the PLC took them over or refused them.
    [[nodiscard]] std::uint64_t foreign_commands() const { return foreign_; }
    [[nodiscard]] std::uint16_t foreign_commit() const { return foreign_commit_; }  ///< the newest of them
    /// How long state() has been pending.
    [[nodiscard]] double pending_s(ClockTime now) const;
    /// Which value is unsendable, and why; "" otherwise.
    [[nodiscard]] const std::string& error() const { return error_; }

  private:
    [[nodiscard]] bool foreign(std::uint16_t number, std::uint16_t before) const;
    void expect(std::uint16_t number);
    void answered(std::uint16_t number);
    void count_foreign(std::uint16_t number);

    RegisterMap map_;
    RegisterImage wanted_;  // commit and watchdog 0
    RegisterImage last_;    // as last sent, likewise
    bool any_ = false;      // wanted_ is somebody's wish
    bool resend_ = false;
    std::string error_;
    std::uint16_t next_ = 1;
    std::uint16_t commit_ = 0;
    std::uint16_t standing_ = 0;  // in the PLC's commit register, as last known
    bool looked_ = false;         // on this link
    std::uint16_t applied_ = 0;   // as last seen
    std::uint16_t rejected_ = 0;
    std::deque<std::uint16_t> unanswered_;  // known, oldest first: what may appear in these two
    std::uint64_t foreign_ = 0;
    std::uint16_t foreign_commit_ = 0;
    CommandState answer_ = CommandState::none;  // to commit_
    ClockTime wished_at_{};                     // first wish that is not sent
    ClockTime newest_at_{};                     // last change of wanted_
    ClockTime unanswered_at_{};                 // the wish behind commit_
};

}  // namespace rig::modbus
