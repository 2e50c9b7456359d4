/// What a panel is of, as its page asks first.
#pragma once

#include <string>
#include <vector>

namespace rig::panel {

/// Something to try: a word of several, or a number.
struct Field {
    std::string key, label, unit{};
    std::vector<std::string> words{};  ///< empty: a number
    double min = 0.0, max = 1.0, step = 0.01;
    std::string value;  ///< at first
};

struct About {
    std::string title;
    bool simulated = false;          ///< no rig moves
    std::vector<std::string> views;  ///< of the page: live, recorded, what_if
    std::string emergency_stop{};    ///< where it is; empty: nothing moves
    std::vector<Field> what_if{};
};

/// `changes`: names of what may be changed with the token.
[[nodiscard]] std::string to_json(const About& about, const std::vector<std::string>& changes);

}  // namespace rig::panel
