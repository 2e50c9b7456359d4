/// Tracks commands to the PLC: which is due, under which commit number, and whether it was applied. Pure: no link, no clock.
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
    pending,     ///< sent or due, and not yet confirmed by the PLC
    applied,     ///< the PLC has applied the newest command
    rejected,    ///< the PLC refused it; not sent again until it changes or the link is reopened
    unsendable,  ///< not sent: a value is NaN or out of range
};
[[nodiscard]] std::string_view name(CommandState state);

class CommandTracker {
  public:
    explicit CommandTracker(const RegisterMap& map);

    /// Sets the wanted command; its bridge_watchdog and commit are ignored.
    void want(const CommandedValues& wanted, ClockTime now);
    /// Call after the link was reopened, with the PLC's commit register: which commands the PLC has received is then unknown.
    void reconnected(std::uint16_t commit, ClockTime now);

    /// The command to send, with its commit number; none if nothing is due. Unchanged until sending() or want().
    [[nodiscard]] std::optional<RegisterImage> due();
    /// Call with the PLC's commit register before sending due(). A number that is neither one of ours nor 0 belongs to another client's command,
    /// which ours will replace: it is counted as foreign.
    void register_holds(std::uint16_t commit);
    /// Call when everything of due() but the commit number is written, and the number is sent now. want() may have changed meanwhile.
    void sending(const RegisterImage& image);
    /// Call with the PLC's registers. A change to a number that is not ours is a command of another client: it is counted as foreign, and ours is due
    /// again, completely. The first reading on a link is not compared.
    void seen(std::uint16_t applied, std::uint16_t rejected, ClockTime now);

    [[nodiscard]] CommandState state() const;
    [[nodiscard]] std::uint16_t commit() const { return commit_; }  ///< newest in use, 0 none
    /// Number of other clients' commands that the PLC applied or refused.
    [[nodiscard]] std::uint64_t foreign_commands() const { return foreign_; }
    [[nodiscard]] std::uint16_t foreign_commit() const { return foreign_commit_; }  ///< the newest of them
    /// How long state() has been pending.
    [[nodiscard]] double pending_s(ClockTime now) const;
    /// Which value is unsendable and why; "" if none.
    [[nodiscard]] const std::string& error() const { return error_; }

  private:
    [[nodiscard]] bool foreign(std::uint16_t number, std::uint16_t before) const;
    void expect(std::uint16_t number);
    void answered(std::uint16_t number);
    void count_foreign(std::uint16_t number);

    RegisterMap map_;
    RegisterImage wanted_;  // commit and watchdog 0
    RegisterImage last_;    // as last sent, likewise
    bool any_ = false;      // want() has been called
    bool resend_ = false;
    std::string error_;
    std::uint16_t next_ = 1;
    std::uint16_t commit_ = 0;
    std::uint16_t standing_ = 0;  // in the PLC's commit register, as last known
    bool looked_ = false;         // on this link
    std::uint16_t applied_ = 0;   // as last seen
    std::uint16_t rejected_ = 0;
    std::deque<std::uint16_t> unanswered_;  // numbers of ours, oldest first, that may still appear in applied_ and rejected_
    std::uint64_t foreign_ = 0;
    std::uint16_t foreign_commit_ = 0;
    CommandState answer_ = CommandState::none;  // to commit_
    ClockTime wished_at_{};                     // first wish that is not sent
    ClockTime newest_at_{};                     // last change of wanted_
    ClockTime unanswered_at_{};                 // the wish behind commit_
};

}  // namespace rig::modbus
