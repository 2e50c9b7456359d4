/// What was wrong in a recording, with its place; of each kind few are said, all are counted.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace rig::replay {

class ImportNotes {
  public:
    using Sink = std::function<void(const std::string&)>;
    ImportNotes(std::string file, Sink sink) : file_(std::move(file)), sink_(std::move(sink)) {}

    void add(const std::string& kind, std::uint64_t row, const std::string& text) {
        constexpr std::uint64_t kSaid = 5;
        const std::uint64_t n = ++counts_[kind];
        if (n > kSaid || !sink_) return;
        sink_(file_ + ":" + std::to_string(row) + ": " + kind + ": " + text + (n == kSaid ? " (more of this kind are only counted)" : ""));
    }
    [[nodiscard]] const std::map<std::string, std::uint64_t>& counts() const { return counts_; }

  private:
    std::string file_;
    Sink sink_;
    std::map<std::string, std::uint64_t> counts_;
};

}  // namespace rig::replay
