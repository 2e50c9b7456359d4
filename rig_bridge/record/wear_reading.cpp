#include "rig_bridge/record/wear_reading.hpp"

#include <fmt/format.h>

#include <limits>
#include <stdexcept>

#include "firmware/host/settings/number_in.hpp"

namespace rig::record {

double worn_share(const std::string& what, const std::string& text) {
    if (text == "none") return std::numeric_limits<double>::quiet_NaN();
    const auto value = settings::number_in<double>(text);
    if (value && *value >= WearReading::kMin && *value <= WearReading::kMax) return *value;
    throw std::invalid_argument(
        fmt::format("{}: '{}' is no worn share: 0 new, 1 at its limit ({} to {} with the reading's error); none withdraws one", what, text,
                    WearReading::kMin, WearReading::kMax));
}

}  // namespace rig::record
