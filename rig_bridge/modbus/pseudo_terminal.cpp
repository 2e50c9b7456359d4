#include "rig_bridge/modbus/pseudo_terminal.hpp"

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>

namespace rig::modbus {
namespace {

[[noreturn]] void fail(const char* step) {
    throw std::runtime_error(std::string("pseudo-terminal for Modbus RTU: ") + step + ": " + std::generic_category().message(errno));
}

std::string slave_path(int master) {
    if (master < 0) fail("open /dev/ptmx");
    if (::grantpt(master) != 0) fail("grantpt");
    if (::unlockpt(master) != 0) fail("unlockpt");
    std::array<char, 64> path{};
    errno = ::ptsname_r(master, path.data(), path.size());
    if (errno != 0) fail("ptsname");
    return path.data();
}

}  // namespace

PseudoTerminal::PseudoTerminal()
    : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK)),
      path_(slave_path(master_.get())),
      slave_(::open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    if (!slave_.is_open()) fail(path_.c_str());
    termios line{};
    if (::tcgetattr(slave_.get(), &line) != 0) fail("tcgetattr");
    ::cfmakeraw(&line);
    if (::tcsetattr(slave_.get(), TCSANOW, &line) != 0) fail("tcsetattr");
}

void PseudoTerminal::drain() const {
    std::array<char, 4096> bytes{};
    static_cast<void>(!::read(master_.get(), bytes.data(), bytes.size()));
}

}  // namespace rig::modbus
