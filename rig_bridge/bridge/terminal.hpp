/// The view on standard error: a block that is drawn over itself on a terminal; elsewhere a plain line a second and one for every new
/// phase. Never waits for whoever reads: what does not fit now is left out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rig_bridge/bridge/view.hpp"

namespace rig::bridge {

class Terminal {
  public:
    /// `descriptor`: where to, e.g. STDERR_FILENO. `live`: whatever it is.
    explicit Terminal(int descriptor, std::optional<bool> live = std::nullopt);

    /// Whether show() would draw now: building a ViewModel costs.
    [[nodiscard]] bool due(double now_s, rig::Phase phase, rig::Abort abort) const;
    void show(const ViewModel& view, double now_s);
    /// The same of lines that are made already, on a terminal that is live.
    void draw(const std::vector<std::string>& lines);
    /// The terminal's bell; nothing elsewhere.
    void ring();
    /// A line that stays.
    void say(const std::string& text);
    /// The block stays as it is; what comes next starts below it.
    void leave();

  private:
    /// Of the terminal, else of the environment's COLUMNS.
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
