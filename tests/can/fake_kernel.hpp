/// A kernel that does what the test says: the system calls of SocketCan end here (the linker's --wrap), so that every refusal and every
/// odd answer can be had without CAN and without rights. Without a FakeKernel the calls go to the real one.
#pragma once

#include <linux/can.h>
#include <net/if.h>
#include <net/if_arp.h>

#include <cerrno>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "firmware/can/frame.hpp"

namespace can_test {

class FakeKernel {
  public:
    using Time = antiskid::can::Time;

    struct Arrival {
        can_frame frame{};
        unsigned length = sizeof(can_frame);
        Time wall{};  ///< stamp
        std::optional<std::uint32_t> drops;
        bool stamped = true;
        bool foreign_note = false;  ///< a control message of another level comes first
    };

    /// One at a time.
    FakeKernel();
    ~FakeKernel();
    FakeKernel(const FakeKernel&) = delete;
    FakeKernel& operator=(const FakeKernel&) = delete;

    /// Each 0, or the error of that call. `option_errors` by the option's number at its level.
    int socket_error = 0;
    int index_error = 0;
    int address_error = 0;
    int flags_error = 0;
    int bind_error = 0;
    int send_error = 0;
    std::size_t room = SIZE_MAX;  ///< frames that one call of sendmmsg() may send
    std::uint32_t queued_bytes = 0;
    int memory_error = 0;
    int epoll_error = 0;
    int epoll_add_error = 0;
    int receive_error = EAGAIN;  ///< when nothing has arrived
    std::map<std::pair<int, int>, int> option_errors;

    unsigned short hardware = ARPHRD_CAN;
    short flags = IFF_UP;
    int index = 7;
    std::deque<Arrival> arrivals;
    int poll_answer = 1;
    /// How long each reading of both clocks takes, the wall clock being read at its beginning; 1 us when empty.
    std::deque<Time> reading_takes;
    Time monotonic{5'000'000'000};
    Time wall_ahead{1'000'000'000'000};

    /// What was asked of it.
    std::string looked_up;
    int bound_index = 0;
    std::map<std::pair<int, int>, std::vector<unsigned char>> options;
    std::vector<can_frame> sent;
    std::vector<Time> waited;
    std::vector<std::string> calls;  ///< those that a period may make, in order
    std::set<int> open;              ///< descriptors
    int readings = 0;                ///< of the wall clock
};

}  // namespace can_test
