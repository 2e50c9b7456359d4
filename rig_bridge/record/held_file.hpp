/// A file that one program at a time holds, by flock(2): the kernel lets go of it when the process dies, however it dies. The file stays,
/// its lock does not.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "firmware/host/settings/file_descriptor.hpp"

namespace rig::record {

class HeldFile {
  public:
    /// Held from here to the end of the object.
    explicit HeldFile(int descriptor) : file_(descriptor) {}

  private:
    settings::FileDescriptor file_;
};

/// Who has it instead: what that program wrote there, empty where it wrote nothing.
struct HeldBy {
    std::string who;
};

/// Takes `path`, which is made where it is not there, and writes `who` into it, one line for whoever comes second. Throws
/// std::system_error naming the file where it cannot be opened.
[[nodiscard]] std::variant<std::unique_ptr<HeldFile>, HeldBy> hold(const std::filesystem::path& path, const std::string& who);

/// Whether somebody has it now, and who: for those who only look. Nothing where the file is not there or cannot be read.
[[nodiscard]] std::optional<HeldBy> held_by(const std::filesystem::path& path);

}  // namespace rig::record
