#include "plant_sim/lab/controller_gains.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace plant_sim {

namespace {

/// The shortest text that is this number, with a point: TOML takes "6" for an integer.
std::string number(double value) {
    std::string text = fmt::format("{}", value);
    return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

}  // namespace

std::string gains_as_toml(const std::vector<Gain>& gains, const std::string& head) {
    std::string text = fmt::format("# {}\n[slip]\n", head);
    for (const Gain& g : gains) text += fmt::format("{} = {}\n", g.key, number(g.value));
    return text;
}

std::string with_gains_written(const std::string& toml, const std::vector<Gain>& gains) {
    std::string written = toml;
    const std::size_t table = toml.find("\n[slip]\n");
    for (const Gain& g : gains) {
        const std::size_t end = std::min(written.find("\n[", table + 1), written.size());
        const std::size_t line = written.find("\n" + g.key + " = ", table);
        if (table == std::string::npos || line >= end)
            throw std::invalid_argument("no line '" + g.key + " = ...' below [slip]");
        const std::size_t value = line + g.key.size() + 4;
        written.replace(value, written.find_first_of(" #\r\n", value) - value, number(g.value));
    }
    return written;
}

}  // namespace plant_sim
