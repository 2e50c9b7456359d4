/// Text view of a running maneuver. Pure; terminal.hpp writes it to standard error.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rig_bridge/record/health.hpp"
#include "rig_bridge/rig/sequencer.hpp"

namespace rig::bridge {

struct CampaignView {
    std::int64_t number = 0;  ///< running now
    std::int64_t finished = 0;
    std::int64_t planned = 0;
    std::optional<double> left_s;  ///< unknown before the first has finished
    std::string regulation{};      ///< how wear is shared, one line; empty where it is not regulated
    std::string health{};          ///< of the brake, by health_text(); empty: not judged
    std::string landings_left{};   ///< with their interval and the model's name; empty: no forecast
};

struct ViewModel {
    std::string scenario;
    std::optional<CampaignView> campaign;
    rig::Phase phase = rig::Phase::idle;
    rig::Abort abort = rig::Abort::none;
    bool record_lost = false;     ///< the bridge requested `abort` because the record could not be written
    double time_s = 0.0;          ///< since the maneuver began
    double phase_s = 0.0;         ///< since the phase began
    double prescribed_mps = 0.0;  ///< speed at brake-on
    double rim_mps = 0.0;
    double wheel_mps = 0.0;  ///< rim of the braked wheel
    double slip = 0.0;
    double pressure_Pa = 0.0;
    double load_N = 0.0;
    double torque_Nm = 0.0;
    double temperature_C = 0.0;
    std::string_view controller;  ///< its state, "silent", or "rejected": heard, but no frame is good
    std::string_view plc;         ///< ready, tripped, silent, ...
    std::string_view bus;         ///< up or down
    std::vector<std::string> faults;
    std::uint64_t frames = 0;
    std::uint64_t dropped = 0;
    std::string note;  ///< what is waited for, or what went wrong
};

/// The live block, none of its lines wider than `columns`.
[[nodiscard]] std::vector<std::string> screen(const ViewModel& view, std::size_t columns);
/// The same as one line, for logs.
[[nodiscard]] std::string plain_line(const ViewModel& view);

/// "3 h 12 min", "4 min 05 s", "12 s".
[[nodiscard]] std::string duration_text(double seconds);
/// Their names with blanks between; "none".
[[nodiscard]] std::string fault_text(const std::vector<std::string>& faults);
/// "suspect (0.81 of its limit): friction has dropped".
[[nodiscard]] std::string health_text(const record::Health& health);
/// At most `columns` characters of UTF-8.
[[nodiscard]] std::string fit(std::string_view line, std::size_t columns);

}  // namespace rig::bridge
