#include "rig_bridge/bridge/terminal.hpp"

#include <fmt/core.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

namespace rig::bridge {

Terminal::Terminal(int descriptor, std::optional<bool> live) : descriptor_(descriptor), live_(live.value_or(::isatty(descriptor) == 1)) {}

std::size_t Terminal::columns() const {
    constexpr std::size_t kUsual = 100;
    winsize size{};
    if (ioctl(descriptor_, TIOCGWINSZ, &size) == 0 && size.ws_col != 0) return size.ws_col;
    const char* const said = std::getenv("COLUMNS");
    const int columns = said == nullptr ? 0 : std::atoi(said);
    return columns > 0 ? static_cast<std::size_t>(columns) : kUsual;
}

/// A pipe that can take anything takes PIPE_BUF bytes at once.
void Terminal::write(const std::string& text) {
    constexpr std::size_t kMax = 4096;
    pollfd descriptor{.fd = descriptor_, .events = POLLOUT, .revents = 0};
    if (poll(&descriptor, 1, 0) != 1 || (descriptor.revents & POLLOUT) == 0) return;
    const ssize_t written = ::write(descriptor_, text.data(), std::min(text.size(), kMax));
    (void)written;  // nobody to tell
}

bool Terminal::due(double now_s, rig::Phase phase, rig::Abort abort) const {
    return !shown_ || now_s >= next_s_ || phase != phase_ || abort != abort_;
}

void Terminal::show(const ViewModel& view, double now_s) {
    constexpr double kLive_s = 0.1;
    constexpr double kPlain_s = 1.0;
    shown_ = true;
    phase_ = view.phase;
    abort_ = view.abort;
    next_s_ = now_s + (live_ ? kLive_s : kPlain_s);
    if (!live_) {
        write(plain_line(view) + "\n");
        return;
    }
    draw(screen(view, columns()));
}

void Terminal::draw(const std::vector<std::string>& lines) {
    std::string text = height_ > 0 ? fmt::format("\x1b[{}A", height_) : std::string();
    const std::size_t width = columns();
    for (const std::string& line : lines) text += fmt::format("\r{}\x1b[K\n", fit(line, width));
    text += "\x1b[J";
    height_ = lines.size();
    write(text);
}

void Terminal::ring() {
    if (::isatty(descriptor_) == 1) write("\a");
}

void Terminal::say(const std::string& text) {
    std::string out = live_ && height_ > 0 ? fmt::format("\x1b[{}A\x1b[J", height_) : std::string();
    height_ = 0;
    write(out + text + "\n");
}

void Terminal::keep_block() {
    height_ = 0;
    shown_ = false;
}

}  // namespace rig::bridge
