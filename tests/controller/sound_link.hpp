/// A CAN interface with which nothing is wrong.
#pragma once

#include <string>

#include "firmware/controller/can_link.hpp"

namespace controller_test {

inline antiskid::controller::CanLink sound_link() {
    antiskid::controller::CanLink link;
    link.there = link.is_can = link.up = true;
    link.kind = std::string("can");
    link.queue_length = 64;
    link.bitrate = 1'000'000;
    link.state = 0;
    link.restart_ms = 100;
    return link;
}

}  // namespace controller_test
