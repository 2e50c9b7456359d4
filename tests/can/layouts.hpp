/// The two layouts that the tests run on, and small things they share.
#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "firmware/can/frame.hpp"
#include "firmware/can/load_layout.hpp"

namespace can_test {

using namespace std::chrono_literals;

inline const antiskid::can::Layout& ours() {
    static const auto layout = antiskid::can::load_layout("config/antiskid.dbc", "config/antiskid_binding.toml");
    return layout;
}

inline const antiskid::can::Layout& foreign() {
    static const auto layout = antiskid::can::load_layout("config/foreign.dbc", "config/foreign_binding.toml");
    return layout;
}

inline std::string contents(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
}

/// A directory of its own that goes when the test goes.
class TempDir {
  public:
    TempDir() {
        std::string name = (std::filesystem::temp_directory_path() / "antiskid_can_XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary directory");
        path_ = name;
    }
    TempDir(const TempDir&) = delete;
    TempDir& operator=(const TempDir&) = delete;
    ~TempDir() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    std::filesystem::path write(const std::string& name, const std::string& text) const {
        std::ofstream(path_ / name, std::ios::binary) << text;
        return path_ / name;
    }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    if (at == std::string::npos) throw std::runtime_error("the test's text to replace is not there: " + from);
    return text.replace(at, from.size(), to);
}

}  // namespace can_test
