/// Bus logs as text, and files to keep them in.
#pragma once

#include <zlib.h>

#include <array>
#include <string>
#include <vector>

#include "firmware/can/candump.hpp"
#include "rig_bridge/replay/log_reader.hpp"
#include "tests/can/layouts.hpp"

namespace replay_test {

using can_test::TempDir;

inline std::string line(const antiskid::can::Frame& frame, const std::string& interface = "vcan0") {
    std::array<char, antiskid::can::kCandumpLineMax> text{};
    return std::string(text.data(), antiskid::can::format_candump(frame.received, interface, frame, text)) + "\n";
}

inline std::filesystem::path write_gzip(const std::filesystem::path& path, const std::string& text) {
    gzFile file = gzopen(path.c_str(), "wb");
    gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
    gzclose(file);
    return path;
}

inline std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t end = text.find('\n', from);
        lines.push_back(text.substr(from, end + 1 - from));
        from = end + 1;
    }
    return lines;
}

/// A log and all that reading it said.
struct Reading {
    std::vector<rig::replay::LogFrame> frames;
    std::vector<std::string> said;
    rig::replay::LogWarnings warnings{"bus.log", [this](const std::string& text) { said.push_back(text); }};

    explicit Reading(const std::filesystem::path& file, const rig::replay::LogOptions& options = {}) {
        rig::replay::LogReader log(file, options, warnings);
        for (rig::replay::LogFrame f; log.next(f);) frames.push_back(f);
    }
};

}  // namespace replay_test
