/// A CAN interface with which nothing is wrong.
#pragma once

#include <string>

#include "firmware/preflight/can_link.hpp"

namespace preflight_test {

inline antiskid::preflight::CanLink sound_link() {
    antiskid::preflight::CanLink link;
    link.there = link.is_can = link.up = true;
    link.kind = std::string("can");
    link.queue_length = 64;
    link.bitrate = 1'000'000;
    link.state = 0;
    link.restart_ms = 100;
    return link;
}

}  // namespace preflight_test
