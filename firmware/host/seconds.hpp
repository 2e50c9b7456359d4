/// Time as a number, for figures and files; the loop's own arithmetic is in single precision (control/arithmetic.hpp).
#pragma once

#include "firmware/control/types.hpp"

namespace antiskid::host {

[[nodiscard]] constexpr double seconds(control::Time time) {
    return static_cast<double>(time.count()) * 1e-9;
}

}  // namespace antiskid::host
