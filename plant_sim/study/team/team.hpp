/// The processes that work on one study: those that mpirun started, or this one alone.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace study::team {

/// Calls come from one thread at a time. Where something of MPI fails, MPI ends all processes.
class Team {
  public:
    Team() = default;
    virtual ~Team() = default;
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;

    [[nodiscard]] virtual std::size_t rank() const = 0;  ///< 0 leads: it alone writes files and speaks
    [[nodiscard]] virtual std::size_t size() const = 0;
    /// The leader's text, in every process. All must call it.
    [[nodiscard]] virtual std::string from_leader(std::string text) = 0;
    /// To the leader, from another.
    virtual void to_leader(std::string_view text) = 0;
    /// For the leader: what another has sent. With `wait` it stays until something comes, else nullopt says that nothing has.
    [[nodiscard]] virtual std::optional<std::string> received(bool wait) = 0;
    /// Ends every process with this exit status.
    virtual void end_all(int status) = 0;
};

/// A team of one.
class Alone : public Team {
  public:
    [[nodiscard]] std::size_t rank() const override { return 0; }
    [[nodiscard]] std::size_t size() const override { return 1; }
    [[nodiscard]] std::string from_leader(std::string text) override { return text; }
    void to_leader(std::string_view) override {}
    [[nodiscard]] std::optional<std::string> received(bool) override { return std::nullopt; }
    void end_all(int status) override { std::exit(status); }
};

/// How many processes mpirun started, by the variables that Open MPI, MPICH and Slurm set; 1 without it.
[[nodiscard]] std::size_t started_by_mpirun();

/// Throws std::runtime_error where mpirun started several processes and this build has no MPI.
[[nodiscard]] std::unique_ptr<Team> join_team();

}  // namespace study::team
