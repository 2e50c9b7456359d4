/// A team of one.
#pragma once

#include <cstdlib>

#include "plant_sim/study/team/team.hpp"

namespace study::team {

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

}  // namespace study::team
