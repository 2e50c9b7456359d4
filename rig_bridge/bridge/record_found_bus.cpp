#include "rig_bridge/bridge/record_found_bus.hpp"

#include <chrono>
#include <stdexcept>

#include "rig_bridge/record/bus_log.hpp"
#include "rig_bridge/record/capture.hpp"
#include "rig_bridge/replay/log_meter.hpp"

namespace rig::bridge {

void record_found_bus(const BridgeSetup& setup, const std::filesystem::path& folder) {
    using std::chrono::steady_clock;
    const std::filesystem::path file = folder / replay::kFoundLog;
    if (std::filesystem::exists(file)) return;
    try {
        constexpr antiskid::can::Time kTurn{20'000'000};
        record::Capture capture(setup.options.interface);
        record::BusLog log(file, setup.options.interface);
        const auto end = steady_clock::now() + std::chrono::milliseconds(300);
        while (steady_clock::now() < end) {
            (void)capture.wait(kTurn);
            for (const record::CapturedFrame& frame : capture.receive()) log.write(frame);
        }
        if (!log.finish() || log.frames() == 0) std::filesystem::remove(file);
    } catch (const std::runtime_error&) {
        // The checks before the start name what is wrong with the interface.
    }
}

}  // namespace rig::bridge
