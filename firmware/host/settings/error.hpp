/// An error in a file, with its place.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace settings {

/// `what()` reads "config/plant.toml:12: wheel.inertia_kgm2: 900 is out of range 0.01 to 100"; parts that do not apply are omitted.
class Error : public std::runtime_error {
  public:
    /// `line` counts from 1; 0 if no line applies. `key` is the full path from the root, empty if no key applies.
    Error(std::string file, std::uint32_t line, std::string key, std::string message);

    [[nodiscard]] const std::string& file() const { return file_; }
    [[nodiscard]] std::uint32_t line() const { return line_; }
    [[nodiscard]] const std::string& key() const { return key_; }
    [[nodiscard]] const std::string& message() const { return message_; }

  private:
    std::string file_;
    std::uint32_t line_;
    std::string key_;
    std::string message_;
};

}  // namespace settings
