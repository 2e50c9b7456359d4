#include "rig_bridge/record/bus_log.hpp"

#include <array>
#include <chrono>
#include <utility>

#include "firmware/can/candump.hpp"
#include "rig_bridge/record/append_file.hpp"

namespace rig::record {

BusLog::BusLog(std::unique_ptr<LineFile> file, std::string interface) : file_(std::move(file)), interface_(std::move(interface)) {}

BusLog::BusLog(const std::filesystem::path& path, std::string interface) : BusLog(std::make_unique<AppendFile>(path), std::move(interface)) {}

void BusLog::write(const CapturedFrame& frame) {
    std::array<char, antiskid::can::kCandumpLineMax> line{};
    const std::size_t length = antiskid::can::format_candump({.time = frame.frame.received,
                                                              .interface = interface_,
                                                              .frame = frame.frame,
                                                              .extended = frame.extended,
                                                              .remote = frame.remote,
                                                              .error = frame.error},
                                                             line);
    if (length == 0) {
        ++unwritable_;
        return;
    }
    file_->line({line.data(), length});
    const auto since = frame.frame.received - flushed_;
    if (since >= std::chrono::seconds(1) || since < antiskid::can::Time{}) {
        file_->flush();
        flushed_ = frame.frame.received;
    }
}

bool BusLog::finish() {
    const bool whole = file_->finish();
    return whole && unwritable_ == 0;
}

std::string BusLog::error() const {
    std::string text = file_->error();
    if (unwritable_ == 0) return text;
    if (!text.empty()) text += "; ";
    return text + std::to_string(unwritable_) + (unwritable_ == 1 ? " frame has" : " frames have") +
           " a time stamp that no log can have (below 0 or above 9e9 s)";
}

}  // namespace rig::record
