/// Gains of the slip law as text of a controller's TOML file.
#pragma once

#include <string>
#include <vector>

namespace plant_sim {

struct Gain {
    std::string key;  ///< of [slip]
    double value = 0.0;
};

/// [slip] with one line a gain, in their order; `head` stands above as a comment.
[[nodiscard]] std::string gains_as_toml(const std::vector<Gain>& gains, const std::string& head);

/// `toml` with these values in the place of those that it has; comments and everything else stay. Throws std::invalid_argument naming a key
/// that is not there, on a line of its own below [slip].
[[nodiscard]] std::string with_gains_written(const std::string& toml, const std::vector<Gain>& gains);

}  // namespace plant_sim
