#include "rig_bridge/bridge/hold.hpp"

#include <array>
#include <cstddef>
#include <fstream>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/json.hpp"

namespace rig::bridge {

std::optional<Hold> read_hold(const std::filesystem::path& campaign) {
    const std::filesystem::path file = hold_file(campaign);
    std::error_code ignored;
    if (!std::filesystem::exists(std::filesystem::symlink_status(file, ignored))) return std::nullopt;
    std::ifstream in(file, std::ios::binary);
    const auto json = settings::Json::parse(in, nullptr, false);
    const auto text = [&json](const char* key) {
        return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : std::string();
    };
    Hold hold{.who = text("who"), .since = text("since"), .why = text("why")};
    if (hold.who.empty()) hold.who = "somebody (" + file.string() + " does not say who)";
    return hold;
}

void write_hold(const std::filesystem::path& campaign, const Hold& hold) {
    const settings::Json json{{"who", hold.who}, {"since", hold.since}, {"why", hold.why}};
    settings::write_file(hold_file(campaign), settings::json_page(json));
}

bool remove_hold(const std::filesystem::path& campaign) {
    return std::filesystem::remove(hold_file(campaign));
}

std::string_view name(HoldStatus status) {
    constexpr std::array<std::string_view, 3> kNames{"runs", "waits", "held"};
    return kNames[static_cast<std::size_t>(status)];
}

HoldStatus hold_status(const std::filesystem::path& campaign, bool begun) {
    if (!read_hold(campaign)) return HoldStatus::runs;
    return begun ? HoldStatus::held : HoldStatus::waits;
}

std::string to_text(const Hold& hold) {
    return "held by " + hold.who + (hold.since.empty() ? "" : " since " + hold.since) + (hold.why.empty() ? "" : ": " + hold.why);
}

}  // namespace rig::bridge
