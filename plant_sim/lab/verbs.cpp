#include "plant_sim/lab/verbs.hpp"

#include "firmware/host/settings/atomic_file.hpp"

namespace plant_sim::lab {

int run_parsed(std::span<const LabVerb> verbs) {
    for (const LabVerb& verb : verbs) {
        if (verb.app->parsed()) return verb.run();
    }
    return 2;
}

void keep_json(const std::filesystem::path& file, const std::string& json_file, std::string_view text) {
    settings::write_file(file, text);
    settings::deliver(json_file, text);
}

}  // namespace plant_sim::lab
