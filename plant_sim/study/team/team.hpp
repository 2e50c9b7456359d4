/// The processes that work on one study: those started by mpirun, or only this one.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace study::team {

/// For one thread at a time. An error of MPI ends all processes.
class Team {
  public:
    Team() = default;
    virtual ~Team() = default;
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;

    [[nodiscard]] virtual std::size_t rank() const = 0;  ///< 0: the leader, which alone writes files and prints
    [[nodiscard]] virtual std::size_t size() const = 0;
    /// Returns the leader's `text` in every process. Every process must call it.
    [[nodiscard]] virtual std::string from_leader(std::string text) = 0;
    /// Sends `text` to the leader; not for the leader.
    virtual void to_leader(std::string_view text) = 0;
    /// For the leader: the next text sent by another process. `wait`: waits for one; otherwise none means that none has arrived.
    [[nodiscard]] virtual std::optional<std::string> received(bool wait) = 0;
    /// Ends every process with the exit status `status`.
    virtual void end_all(int status) = 0;
};

/// A team of one process.
class SingleProcess : public Team {
  public:
    [[nodiscard]] std::size_t rank() const override { return 0; }
    [[nodiscard]] std::size_t size() const override { return 1; }
    [[nodiscard]] std::string from_leader(std::string text) override { return text; }
    void to_leader(std::string_view) override {}
    [[nodiscard]] std::optional<std::string> received(bool) override { return std::nullopt; }
    void end_all(int status) override { std::exit(status); }
};

/// Number of processes started by mpirun, by the variables of Open MPI, MPICH and Slurm; 1 without mpirun.
[[nodiscard]] std::size_t started_by_mpirun();

/// Throws std::runtime_error if mpirun started several processes and this build has no MPI.
[[nodiscard]] std::unique_ptr<Team> join_team();

}  // namespace study::team
