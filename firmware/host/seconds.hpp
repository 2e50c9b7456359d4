/// Time in seconds, double precision, for figures and files; the controller uses single precision (control/arithmetic.hpp).
#pragma once

#include "firmware/control/types.hpp"

namespace antiskid::host {

[[nodiscard]] constexpr double seconds(control::Time time) {
    return static_cast<double>(time.count()) * 1e-9;
}

}  // namespace antiskid::host
