/// A search for a mixture that is small enough for a test.
#pragma once

#include <cstddef>

#include "rig_bridge/wear/fit.hpp"

/// Up to `most` components, each order from `starts` starts; all else as shipped.
inline wear::FitSettings small(std::size_t max, int starts) {
    wear::FitSettings s;
    s.max_components = max;
    s.starts = starts;
    return s;
}
