#include "rig_bridge/replay/plausibility.hpp"

#include <algorithm>
#include <array>

namespace rig::replay {

using antiskid::can::Quantity;

namespace {

// Limits for lively signals: slower than any maneuver, softer than any braking. Temperature has none: the brake may be cold.
constexpr std::array<PlausibleRange, kChannelCount> kRanges{{{-5.0, 600.0, 20.0},
                                                             {-1.0, 120.0, 5.0},
                                                             {-5e5, 4e7, 2e5},
                                                             {-2e4, 6e5, 1e3},
                                                             {-3e5, 3e5, 100.0},
                                                             {-5e3, 5e4, 50.0},
                                                             {-1.0, 1000.0, 3.0},
                                                             {-60.0, 2000.0, -60.0}}};

}  // namespace

const PlausibleRange& plausible(Channel channel) {
    return kRanges[static_cast<std::size_t>(channel)];
}

double factor_of(Channel channel, const antiskid::can::Unit& unit, double radius_m) {
    const bool shaft = channel == Channel::flywheel_speed && unit.quantity == Quantity::angular_speed;
    return shaft ? unit.factor * radius_m : unit.factor;
}

bool ChannelSurvey::add(double recorded) {
    const PlausibleRange& range = plausible(channel_);
    lowest_ = count_ == 0 ? recorded : std::min(lowest_, recorded);
    highest_ = count_ == 0 ? recorded : std::max(highest_, recorded);
    ++count_;
    const double value = recorded * factor_;
    const bool inside = value >= range.lowest && value <= range.highest;
    if (!inside) ++outside_;
    return inside;
}

bool ChannelSurvey::wrong_unit() const {
    constexpr double kMany = 0.01;
    if (count_ == 0) return false;
    return static_cast<double>(outside_) > kMany * static_cast<double>(count_) || std::max(highest_, -lowest_) * factor_ < plausible(channel_).lively;
}

namespace {

/// The units that fit, except `but`.
template <typename Fits>
std::string list_units(std::initializer_list<Quantity> quantities, const std::string& but, Fits fits) {
    std::string list;
    for (const Quantity quantity : quantities) {
        const std::string all = antiskid::can::units_of(quantity);
        for (std::size_t from = 0; from < all.size();) {
            const std::size_t end = std::min(all.find(", ", from), all.size());
            const std::string unit = all.substr(from, end - from);
            from = end + 2;
            if (unit == but || !fits(*antiskid::can::find_unit(unit))) continue;
            list.append(list.empty() ? "" : ", ").append(unit);
        }
    }
    return list;
}

}  // namespace

std::string ChannelSurvey::likely_units(const ImportColumn& column, double radius_m) const {
    const PlausibleRange& range = plausible(channel_);
    const auto fits = [&](const antiskid::can::Unit& unit) {
        const double factor = factor_of(channel_, unit, radius_m);
        return lowest_ * factor >= range.lowest && highest_ * factor <= range.highest && std::max(highest_, -lowest_) * factor >= range.lively;
    };
    if (channel_ == Channel::flywheel_speed) return list_units({Quantity::speed, Quantity::angular_speed}, column.unit_name, fits);
    return list_units({column.unit.quantity}, column.unit_name, fits);
}

std::string pressure_units_at_ratio(const ImportColumn& column, double ratio) {
    constexpr double kNear = 2.0;
    const double wanted = ratio * column.unit.factor;
    return list_units({Quantity::pressure}, column.unit_name,
                      [&](const antiskid::can::Unit& unit) { return unit.factor > wanted / kNear && unit.factor < wanted * kNear; });
}

std::string units_at_ratio(const ImportColumn& column, double ratio, double radius_m) {
    constexpr double kNear = 1.2;
    const double wanted = ratio * factor_of(Channel::flywheel_speed, column.unit, radius_m);
    return list_units({Quantity::speed, Quantity::angular_speed}, column.unit_name, [&](const antiskid::can::Unit& unit) {
        const double factor = factor_of(Channel::flywheel_speed, unit, radius_m);
        return factor > wanted / kNear && factor < wanted * kNear;
    });
}

}  // namespace rig::replay
