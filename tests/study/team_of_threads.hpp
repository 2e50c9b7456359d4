/// A team of threads: messages through a queue instead of MPI.
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "plant_sim/study/team/team.hpp"

namespace threads {

struct Wire {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<std::string> to_leader;
    std::optional<std::string> from_leader;
};

class Member : public study::team::Team {
  public:
    Member(Wire& wire, std::size_t rank, std::size_t size) : wire_(wire), rank_(rank), size_(size) {}
    [[nodiscard]] std::size_t rank() const override { return rank_; }
    [[nodiscard]] std::size_t size() const override { return size_; }
    [[nodiscard]] std::string from_leader(std::string text) override {
        std::unique_lock lock(wire_.mutex);
        if (rank_ == 0) wire_.from_leader = text;
        wire_.changed.notify_all();
        wire_.changed.wait(lock, [this] { return wire_.from_leader.has_value(); });
        return *wire_.from_leader;
    }
    void to_leader(std::string_view text) override {
        const std::scoped_lock lock(wire_.mutex);
        wire_.to_leader.emplace_back(text);
        wire_.changed.notify_all();
    }
    [[nodiscard]] std::optional<std::string> received(bool wait) override {
        std::unique_lock lock(wire_.mutex);
        if (wait) wire_.changed.wait(lock, [this] { return !wire_.to_leader.empty(); });
        if (wire_.to_leader.empty()) return std::nullopt;
        std::string text = std::move(wire_.to_leader.front());
        wire_.to_leader.pop_front();
        return text;
    }
    void end_all(int) override {}

  private:
    Wire& wire_;
    std::size_t rank_;
    std::size_t size_;
};

}  // namespace threads
