/// Which identifiers to play, spelled as for candump.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rig_bridge/replay/log_reader.hpp"

namespace rig::replay {

/// A frame passes when any rule lets it; without rules every frame passes.
class IdFilter {
  public:
    /// `110`: that identifier; `100:7F0`: those that agree with 100 in the bits of 7F0; hexadecimal. Three digits are an 11-bit
    /// identifier, eight a 29-bit one. Throws std::invalid_argument saying what would be right.
    void add(std::string_view rule);

    [[nodiscard]] bool passes(const LogFrame& frame) const;

  private:
    struct Rule {
        std::uint32_t id;
        std::uint32_t mask;
        bool extended;
    };
    std::vector<Rule> rules_;
};

}  // namespace rig::replay
