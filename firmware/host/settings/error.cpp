#include "firmware/host/settings/error.hpp"

#include <utility>

namespace settings {

namespace {

std::string composed(const std::string& file, std::uint32_t line, const std::string& key, const std::string& message) {
    std::string what = file;
    if (line != 0) what.append(":").append(std::to_string(line));
    what += ": ";
    if (!key.empty()) what += key + ": ";
    return what + message;
}

}  // namespace

Error::Error(std::string file, std::uint32_t line, std::string key, std::string message)
    : std::runtime_error(composed(file, line, key, message)),
      file_(std::move(file)),
      line_(line),
      key_(std::move(key)),
      message_(std::move(message)) {}

}  // namespace settings
