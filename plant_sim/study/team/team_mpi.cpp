#include <mpi.h>

#include <limits>
#include <stdexcept>

#include "plant_sim/study/team/team.hpp"

namespace study::team {

namespace {

constexpr int kTag = 0;

int count_of(std::string_view text) {
    if (text.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
        throw std::length_error("a message between processes is above 2 GiB");
    return static_cast<int>(text.size());
}

class Processes : public Team {
  public:
    Processes() {
        int provided = 0;
        MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided);
        if (provided < MPI_THREAD_SERIALIZED) {
            MPI_Finalize();
            throw std::runtime_error("this MPI cannot be called from more than one thread");
        }
        MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
        MPI_Comm_size(MPI_COMM_WORLD, &size_);
    }
    ~Processes() override { MPI_Finalize(); }
    Processes(const Processes&) = delete;
    Processes& operator=(const Processes&) = delete;

    [[nodiscard]] std::size_t rank() const override { return static_cast<std::size_t>(rank_); }
    [[nodiscard]] std::size_t size() const override { return static_cast<std::size_t>(size_); }

    [[nodiscard]] std::string from_leader(std::string text) override {
        int count = count_of(text);
        MPI_Bcast(&count, 1, MPI_INT, 0, MPI_COMM_WORLD);
        text.resize(static_cast<std::size_t>(count));
        MPI_Bcast(text.data(), count, MPI_CHAR, 0, MPI_COMM_WORLD);
        return text;
    }

    void to_leader(std::string_view text) override { MPI_Send(text.data(), count_of(text), MPI_CHAR, 0, kTag, MPI_COMM_WORLD); }

    [[nodiscard]] std::optional<std::string> received(bool wait) override {
        int here = 1;
        MPI_Status status{};
        if (wait)
            MPI_Probe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &status);
        else
            MPI_Iprobe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &here, &status);
        if (here == 0) return std::nullopt;
        int count = 0;
        MPI_Get_count(&status, MPI_CHAR, &count);
        std::string text(static_cast<std::size_t>(count), '\0');
        MPI_Recv(text.data(), count, MPI_CHAR, status.MPI_SOURCE, kTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        return text;
    }

    void end_all(int status) override { MPI_Abort(MPI_COMM_WORLD, status); }

  private:
    int rank_ = 0;
    int size_ = 1;
};

}  // namespace

std::unique_ptr<Team> join_team() {
    // Without mpirun MPI is not started, since that takes longer than many a study.
    if (started_by_mpirun() > 1) return std::make_unique<Processes>();
    return std::make_unique<SingleProcess>();
}

}  // namespace study::team
