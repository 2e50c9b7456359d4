#include "plant_sim/study/team/shared_work.hpp"

#include <cstdint>
#include <numeric>
#include <optional>
#include <utility>

#include "rig_bridge/rig/random.hpp"

namespace study::team {

std::vector<std::size_t> order_of_work(std::size_t pieces) {
    constexpr std::uint64_t kShuffle = 1;
    rig::Random random(kShuffle);
    std::vector<std::size_t> numbers(pieces);
    std::iota(numbers.begin(), numbers.end(), std::size_t{0});
    // Fisher and Yates; std::shuffle differs between standard libraries. The bias of % does not matter here.
    for (std::size_t i = pieces; i > 1; --i) std::swap(numbers[i - 1], numbers[static_cast<std::size_t>(random.bits() % i)]);
    return numbers;
}

std::vector<std::size_t> share_of(std::span<const std::size_t> pending, const Team& team) {
    std::vector<std::size_t> ours;
    for (std::size_t i = team.rank(); i < pending.size(); i += team.size()) ours.push_back(pending[i]);
    return ours;
}

void work_together(Team& team, const std::function<void(const PieceDone&)>& work, const std::function<void(std::string_view piece)>& take) {
    if (team.rank() != 0) {
        work([&team](const std::string& piece) { team.to_leader(piece); });
        team.to_leader({});
        return;
    }
    std::size_t at_work = team.size() - 1;
    const auto hear = [&](bool wait) {
        const std::optional<std::string> piece = team.received(wait);
        if (piece && piece->empty()) --at_work;
        if (piece && !piece->empty()) take(*piece);
        return piece.has_value();
    };
    work([&](const std::string& piece) {
        take(piece);
        while (at_work > 0 && hear(false)) {
        }
    });
    while (at_work > 0) (void)hear(true);
}

}  // namespace study::team
