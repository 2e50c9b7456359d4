#include "plant_sim/lab/verbs.hpp"

#include <fmt/core.h>

#include "config/reader/atomic_file.hpp"

namespace plant_sim {

int run_parsed(std::span<const LabVerb> verbs) {
    for (const LabVerb& verb : verbs) {
        if (verb.app->parsed()) return verb.run();
    }
    return 2;
}

void deliver(const std::string& where, std::string_view text) {
    if (where == "-")
        fmt::print("{}", text);
    else
        settings::write_file(where, text);
}

}  // namespace plant_sim
