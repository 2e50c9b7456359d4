/// The view on standard error: on a terminal a block that is redrawn in place; otherwise a plain line every second and at every new phase. Never
/// blocks: output that the reader has no room for is skipped.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rig_bridge/bridge/view.hpp"

namespace rig::bridge {

class Terminal {
  public:
    /// `descriptor`: output, e.g. STDERR_FILENO. `live`: redraw in place; none: only if it is a terminal.
    explicit Terminal(int descriptor, std::optional<bool> live = std::nullopt);

    /// Whether show() would draw now, to avoid building a ViewModel in vain.
    [[nodiscard]] bool due(double now_s, rig::Phase phase, rig::Abort abort) const;
    void show(const ViewModel& view, double now_s);
    /// Draws ready-made lines on a live terminal.
    void draw(const std::vector<std::string>& lines);
    /// Rings the terminal's bell; no effect elsewhere.
    void ring();
    /// Prints a line that stays above the block.
    void say(const std::string& text);
    /// Leaves the block on the screen; further output starts below it.
    void keep_block();

  private:
    /// Width of the terminal, else the environment's COLUMNS.
    [[nodiscard]] std::size_t columns() const;
    void write(const std::string& text);

    int descriptor_;
    bool live_;
    bool shown_ = false;
    double next_s_ = 0.0;
    rig::Phase phase_ = rig::Phase::idle;
    rig::Abort abort_ = rig::Abort::none;
    std::size_t height_ = 0;  // lines of the block on the screen
};

}  // namespace rig::bridge
