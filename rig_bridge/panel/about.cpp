#include "rig_bridge/panel/about.hpp"

#include "firmware/host/settings/json.hpp"
#include "rig_bridge/panel/live_feed.hpp"

namespace rig::panel {

std::string to_json(const About& about, const std::vector<std::string>& changes) {
    settings::Json json{{"title", about.title}, {"simulated", about.simulated},           {"views", about.views},
                        {"changes", changes},   {"emergency_stop", about.emergency_stop}, {"version", ANTISKID_VERSION}};
    json["channels"] = settings::Json::array();
    for (const Channel& c : kChannels)
        json["channels"].push_back({{"key", c.key}, {"label", c.label}, {"unit", c.unit}, {"chart", c.chart}, {"dashed", c.dashed}});
    json["what_if"] = settings::Json::array();
    for (const Field& f : about.what_if) {
        settings::Json field{{"key", f.key}, {"label", f.label}, {"unit", f.unit}, {"value", f.value}};
        if (f.words.empty())
            field.update({{"min", f.min}, {"max", f.max}, {"step", f.step}});
        else
            field["words"] = f.words;
        json["what_if"].push_back(std::move(field));
    }
    return settings::json_line(json);
}

}  // namespace rig::panel
