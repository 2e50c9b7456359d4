#include "plant_sim/wear/landing_mix.hpp"

#include <fmt/format.h>

#include <limits>
#include <stdexcept>
#include <string_view>

#include "firmware/host/settings/near_miss.hpp"
#include "firmware/host/settings/number_in.hpp"
#include "plant_sim/model/brake.hpp"
#include "rig_bridge/rig/load_rig.hpp"

namespace wear {

namespace {

double share_of(std::string_view text) {
    const auto share = settings::number_in<double>(text);
    if (!share || !(*share > 0.0 && *share <= 1e6))
        throw std::invalid_argument(fmt::format("--mix: '{}' is no share; expected e.g. light=0.5,medium=0.3,heavy=0.2", settings::printable(text)));
    return *share;
}

/// The maneuver of that name, or those whose names go on with _a, _b, ...
std::vector<std::string> maneuvers_named(std::string_view wanted, const std::vector<std::string>& known) {
    std::vector<std::string> out;
    for (const std::string& name : known) {
        if (name == wanted || (name.starts_with(wanted) && name.substr(wanted.size()).starts_with('_'))) out.push_back(name);
    }
    if (out.empty())
        throw std::invalid_argument(
            fmt::format("--mix: no maneuver '{}' in maneuvers.toml; there are {}", settings::printable(wanted), fmt::join(known, ", ")));
    return out;
}

}  // namespace

ConfiguredMix configured_mix(const std::filesystem::path& config, const std::string& text, double slip) {
    const std::vector<std::string> known = rig::maneuver_names(config);
    ConfiguredMix out;
    double sum = 0.0;
    for (std::string_view rest = text; !rest.empty();) {
        const auto comma = rest.find(',');
        const std::string_view entry = rest.substr(0, comma);
        rest.remove_prefix(comma == std::string_view::npos ? rest.size() : comma + 1);
        const auto equals = entry.find('=');
        const double share = share_of(equals == std::string_view::npos ? std::string_view() : entry.substr(equals + 1));
        const std::vector<std::string> named = maneuvers_named(entry.substr(0, equals), known);
        for (const std::string& name : named) {
            rig::ManeuverChoice choice;
            choice.maneuver = name;
            const rig::LoadedRig rig = rig::load_rig(config, choice);
            const double energy_J = 0.5 * rig.rig.wheel.mass_kg * rig.rig.brake_on_mps * rig.rig.brake_on_mps * (1.0 - slip);
            out.mix.push_back({name, share / static_cast<double>(named.size()), energy_J / rig.wear.scale.energy, 0.0});
            out.files = rig.files;
        }
        sum += share;
    }
    if (out.mix.empty()) throw std::invalid_argument("--mix: is empty; expected e.g. light=0.5,medium=0.3,heavy=0.2");
    for (LandingKind& kind : out.mix) kind.share /= sum;
    return out;
}

ReserveLimit reserve_limit(const std::filesystem::path& config) {
    const rig::LoadedRig loaded = rig::load_rig(config, {});
    const rig::RigParameters& rig = loaded.rig;
    const double mu_max = rig::peak(rig.surface).mu;
    constexpr int kSpeeds = 400;
    struct Scarcest {
        double reserve_Nm = std::numeric_limits<double>::infinity();
        double torque_Nm = 0.0;
        double speed_mps = 0.0;
    };
    const auto scarcest = [&](double friction) {
        const plant::BrakeTorque brake(rig.brake, rig.friction_curve, friction, rig.brake_on_mps);
        Scarcest out;
        for (int i = 0; i <= kSpeeds; ++i) {
            const double v_mps = loaded.drop_out_mps + (rig.brake_on_mps - loaded.drop_out_mps) * i / kSpeeds;
            const double F_z = rig.load.base_N - rig.load.lift_Ns2pm2 * v_mps * v_mps;
            const double wanted_Nm = mu_max * F_z * (rig.wheel.free_radius_m - F_z / rig.wheel.stiffness_Npm);
            const double reserve_Nm = rig.clamping.net_Pa(loaded.full_pressure_Pa) * brake.gain(v_mps).k_b - wanted_Nm;
            if (reserve_Nm < out.reserve_Nm) out = {reserve_Nm, wanted_Nm, v_mps};
        }
        return out;
    };
    double low = 1e-3;
    double high = 1.5;
    constexpr int kHalvings = 50;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        (scarcest(middle).reserve_Nm < 0.0 ? low : high) = middle;
    }
    const Scarcest s = scarcest(high);
    return {high / loaded.wear.scale.friction, s.torque_Nm, s.speed_mps, loaded.files};
}

}  // namespace wear
