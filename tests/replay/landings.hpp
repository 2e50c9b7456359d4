/// Bus logs of landings, made in process.
#pragma once

#include <string>

#include "tests/replay/logs.hpp"
#include "tests/study/scenarios.hpp"

namespace replay_test {

/// Every frame of a landing in lockstep.
inline std::string landing(const plant_sim::StopOptions& options) {
    std::string log;
    (void)scenarios::run(options, study::Link::frames, {}, [&](const antiskid::can::Frame& frame) { log += line(frame); });
    return log;
}

}  // namespace replay_test
