/// A pseudo-terminal as serial line without hardware.
#pragma once

#include <string>

#include "firmware/host/settings/file_descriptor.hpp"

namespace rig::modbus {

class PseudoTerminal {
  public:
    /// Opens it in raw mode. Throws std::runtime_error with the reason.
    PseudoTerminal();

    [[nodiscard]] int master() const { return master_.get(); }       ///< does not block
    [[nodiscard]] const std::string& path() const { return path_; }  ///< of the other end

    /// Discards what the other end has written.
    void drain() const;

  private:
    settings::FileDescriptor master_;
    std::string path_;
    settings::FileDescriptor slave_;  // held open: without any slave the master reads errors
};

}  // namespace rig::modbus
