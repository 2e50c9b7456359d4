#include "plant_sim/simulation/simulated_line.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace plant_sim::simulation {

using rig::modbus::kTcpHeader;

namespace {

std::array<settings::FileDescriptor, 2> socket_pair() {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
        throw std::system_error(errno, std::generic_category(), "a pair of sockets");
    return {settings::FileDescriptor(ends[0]), settings::FileDescriptor(ends[1])};
}

}  // namespace

SimulatedLine::SimulatedLine(rig::modbus::RegisterBank& bank, const rig::LinkTimes& times, LineState& state, wear::Generator& draw)
    : bank_(bank), times_(times), state_(state), draw_(draw), context_(modbus_new_tcp("127.0.0.1", 0)), pair_(socket_pair()) {
    modbus_set_socket(context_.get(), pair_[0].get());
    modbus_set_response_timeout(context_.get(), 0, 1);  // libmodbus waits for it before it sends some of its exceptions
}

bool SimulatedLine::occurs(RequestFault fault) {
    const auto i = static_cast<std::size_t>(fault);
    if (state_.shares.at(i) == 0.0 || wear::uniform(draw_) >= state_.shares.at(i)) return false;
    ++state_.fault_counts.at(i);
    return true;
}

int SimulatedLine::open() {
    arrived_.clear();
    if (state_.reachable) return 0;
    state_.busy_until = state_.now + times_.connect_timeout;
    return ETIMEDOUT;
}

void SimulatedLine::answer(std::span<const std::uint8_t> request) {
    constexpr std::size_t kChecksum = 0;
    (void)bank_.answer(context_.get(), request, kTcpHeader, kChecksum, false);
    std::vector<std::uint8_t> bytes(kMaxFrame);
    const auto got = ::recv(pair_[1].get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (got <= 0) return;
    bytes.resize(static_cast<std::size_t>(got));
    if (occurs(RequestFault::answer_damaged)) {
        const std::uint64_t bit = draw_() % (8 * (kTcpHeader + 1));
        bytes.at(bit / 8) ^= static_cast<std::uint8_t>(1U << (bit % 8));
    }
    if (!occurs(RequestFault::answer_lost)) arrived_.push_back(std::move(bytes));
}

int SimulatedLine::send(std::span<const std::uint8_t> frame) {
    if (!state_.reachable || occurs(RequestFault::request_lost)) return 0;
    answer(frame);
    if (occurs(RequestFault::request_doubled)) answer(frame);
    return 0;
}

int SimulatedLine::receive(std::span<std::uint8_t, kMaxFrame> frame, std::size_t& size) {
    if (arrived_.empty()) {
        state_.busy_until = state_.now + times_.response_timeout;
        return ETIMEDOUT;
    }
    size = arrived_.front().size();
    std::copy(arrived_.front().begin(), arrived_.front().end(), frame.begin());
    arrived_.pop_front();
    return 0;
}

}  // namespace plant_sim::simulation
