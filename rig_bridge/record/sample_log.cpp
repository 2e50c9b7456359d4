#include "rig_bridge/record/sample_log.hpp"

#include <fmt/format.h>

#include <array>
#include <iterator>
#include <utility>

namespace rig::record {

namespace {

constexpr std::array<std::string_view, kMeasuredCount> kUnits{"", "", "", "", "", "", "_mps", "_m", "", "_N", "_N", "_N", "_Nm", "_C", "_Pa"};

}  // namespace

std::string sample_column(Measured quantity) {
    return std::string(name(quantity)) + std::string(kUnits[static_cast<std::size_t>(quantity)]);
}

SampleLog::SampleLog(std::unique_ptr<LineFile> file) : file_(std::move(file)) {
    std::string header = "time_s";
    for (std::size_t i = 0; i < kMeasuredCount; ++i) header += ',' + sample_column(static_cast<Measured>(i));
    file_->line(header);
}

void SampleLog::write(antiskid::can::Time wall_clock, const MeasuredValues& values) {
    fmt::memory_buffer row;
    const std::int64_t us = wall_clock.count() / 1000;
    fmt::format_to(std::back_inserter(row), "{}.{:06}", us / 1'000'000, us % 1'000'000);
    for (const double value : values) fmt::format_to(std::back_inserter(row), ",{}", value);
    file_->line({row.data(), row.size()});
}

}  // namespace rig::record
