#include "rig_bridge/panel/about.hpp"

#include <nlohmann/json.hpp>

#include "rig_bridge/panel/live_feed.hpp"

namespace rig::panel {

std::string to_json(const About& about, const std::vector<std::string>& changes) {
    nlohmann::ordered_json json{{"title", about.title}, {"simulated", about.simulated},           {"views", about.views},
                                {"changes", changes},   {"emergency_stop", about.emergency_stop}, {"version", ANTISKID_VERSION}};
    json["channels"] = nlohmann::ordered_json::array();
    for (const Channel& c : kChannels)
        json["channels"].push_back({{"key", c.key}, {"label", c.label}, {"unit", c.unit}, {"chart", c.chart}, {"dashed", c.dashed}});
    json["what_if"] = nlohmann::ordered_json::array();
    for (const Field& f : about.what_if) {
        nlohmann::ordered_json field{{"key", f.key}, {"label", f.label}, {"unit", f.unit}, {"value", f.value}};
        if (f.words.empty())
            field.update({{"min", f.min}, {"max", f.max}, {"step", f.step}});
        else
            field["words"] = f.words;
        json["what_if"].push_back(std::move(field));
    }
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace rig::panel
