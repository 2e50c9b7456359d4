/// A received frame with its flags.
#pragma once

#include "firmware/can/frame.hpp"

namespace rig::record {

struct CapturedFrame {
    antiskid::can::Frame frame;  ///< `received`: the kernel's stamp, wall clock since 1970; id without flags
    bool extended = false;       ///< 29-bit identifier
    bool remote = false;
    bool error = false;  ///< error frame: the id is its class, see linux/can/error.h

    /// Whether it is a data frame with an 11-bit identifier, the only kind in layouts.
    [[nodiscard]] bool plain() const { return !extended && !remote && !error; }
};

}  // namespace rig::record
