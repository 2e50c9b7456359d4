#include "plant_sim/wear/brake_state.hpp"

#include <fmt/format.h>

#include <array>
#include <system_error>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/input_file.hpp"
#include "firmware/host/settings/json.hpp"
#include "rig_bridge/wear/model_io.hpp"

namespace wear {

namespace {

using settings::Error;
using settings::Json;

std::string check_sum(const std::string& wear_hash, const BrakeState& s) {
    const std::string values = fmt::format("{} {} {} {}", wear_hash, s.seed, s.maneuvers, s.c_e_J);
    const std::string_view bytes = values;
    return settings::hash_bytes({&bytes, 1});
}

}  // namespace

std::string wear_hash(const BrakeWear& wear) {
    const std::string model = to_json(*wear.model);
    const std::string scale = fmt::format("{} {}", wear.scale.energy, wear.scale.friction);
    std::string law;
    if (const auto& l = wear.law)
        law = fmt::format("{} {} {} {} {} {} {} {} {} {} {}", l->plateau, l->run_in, l->run_in_J, l->loss, l->lining_J, l->core_loss, l->core_share,
                          l->per_temperature, l->memory, l->play, l->measurement);
    const std::array<std::string_view, 3> parts{model, scale, law};
    return settings::hash_bytes(parts);
}

std::string to_json(const BrakeState& state, const BrakeWear& wear) {
    const std::string hash = wear_hash(wear);
    const Json json{{"format", kBrakeStateFormat},
                    {"format_version", kBrakeStateFormatVersion},
                    {"wear_hash", hash},
                    {"seed", state.seed},
                    {"maneuvers", state.maneuvers},
                    {"cumulative_energy_J", state.c_e_J},
                    {"check_sum", check_sum(hash, state)}};
    return settings::json_page(json);
}

BrakeState brake_state_from_json(const std::string& name, std::string_view text, const BrakeWear& wear) {
    const Json json = settings::parsed_json(name, text);
    settings::JsonObject root(name, "", json);
    root.check_format(kBrakeStateFormat, kBrakeStateFormatVersion);
    const std::string hash = root.text("wear_hash");
    const BrakeState state{.seed = root.count("seed"), .maneuvers = root.count("maneuvers"), .c_e_J = root.number("cumulative_energy_J")};
    if (state.c_e_J < 0.0) root.fail("cumulative_energy_J", "must not be negative");
    const std::string sum = root.text("check_sum");
    root.finish();
    if (sum != check_sum(hash, state))
        throw Error(name, 0, "check_sum",
                    "does not fit the values: the file is damaged, or was edited; to start from another energy "
                    "use --brake MJ with a new file");
    if (hash != wear_hash(wear))
        throw Error(name, 0, "wear_hash",
                    fmt::format("this brake was kept with another wear model, law or scale than that of {}", wear.file.string()));
    return state;
}

std::optional<BrakeState> find_brake_state(const std::filesystem::path& file, const BrakeWear& wear) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return std::nullopt;
    return brake_state_from_json(file.string(), settings::read_file(file), wear);
}

void write_brake_state(const std::filesystem::path& file, const BrakeState& state, const BrakeWear& wear) {
    settings::write_file(file, to_json(state, wear));
}

}  // namespace wear
