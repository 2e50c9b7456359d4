/// One frame as the recorder has it.
#pragma once

#include "firmware/can/frame.hpp"

namespace rig::record {

struct CapturedFrame {
    antiskid::can::Frame frame;  ///< `received`: the kernel's stamp, wall clock since 1970; id without flags
    bool extended = false;       ///< 29-bit identifier
    bool remote = false;
    bool error = false;  ///< error frame: the id is its class, see linux/can/error.h

    /// A data frame with an 11-bit identifier: what layouts are made of.
    [[nodiscard]] bool plain() const { return !extended && !remote && !error; }
};

}  // namespace rig::record
