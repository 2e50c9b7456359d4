/// Description of a panel, which its page reads first.
#pragma once

#include <string>
#include <vector>

namespace rig::panel {

/// An input that the user can change: one of several words, or a number.
struct Field {
    std::string key, label, unit{};
    std::vector<std::string> words{};  ///< empty: a number
    double min = 0.0, max = 1.0, step = 0.01;
    std::string value;  ///< initial value
};

struct About {
    std::string title;
    bool simulated = false;          ///< no real rig moves
    std::vector<std::string> views;  ///< views of the page: live, recorded, what_if
    std::string emergency_stop{};    ///< location of the emergency stop; empty: nothing moves
    std::vector<Field> what_if{};
};

/// `changes`: names of the changes that the token permits.
[[nodiscard]] std::string to_json(const About& about, const std::vector<std::string>& changes);

}  // namespace rig::panel
