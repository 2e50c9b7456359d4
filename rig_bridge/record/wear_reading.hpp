/// Wear that a person read after a maneuver, by wear pin or gauge. One list of fields for options, ledger and exports.
#pragma once

#include <array>
#include <limits>
#include <string>

namespace rig::record {

/// Shares of what may wear: 0 new, 1 at the limit; a reading's error may bring it a little outside. NaN: not read.
struct WearReading {
    double lining = std::numeric_limits<double>::quiet_NaN();
    double tread = std::numeric_limits<double>::quiet_NaN();
    static constexpr double kMin = -0.1, kMax = 1.2;  ///< plausible
};

struct WearReadingField {
    const char* key;
    const char* option;
    const char* what;
    double WearReading::*value;
};
inline constexpr std::array kWearReadingFields{
    WearReadingField{"lining_worn", "--lining-worn", "worn share of the brake's lining: 0 new, 1 at its limit", &WearReading::lining},
    WearReadingField{"tread_worn", "--tread-worn", "worn share of the tyre's tread, likewise", &WearReading::tread},
};

/// The value of a note's text; "none" withdraws a reading (NaN). Throws std::invalid_argument that names `what` for any other text that is no
/// plausible number.
[[nodiscard]] double worn_share(const std::string& what, const std::string& text);

}  // namespace rig::record
