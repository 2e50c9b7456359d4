// TOML from anywhere: bound to the shipped DBC, and read as a configuration of the controller. A layout that is accepted can be used.
#include <array>

#include "config/reader/error.hpp"
#include "firmware/can/load_layout.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/linux/controller_config.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace antiskid;
    const fuzz::Input input(data, size);
    static const fuzz::File file("fuzz.toml");
    const std::filesystem::path& path = file.holding(input.text());
    try {
        const can::Layout layout = can::load_layout("config/foreign.dbc", path);
        can::RigPort rig(layout, control::Time{1'000'000});
        std::array<can::Frame, can::RigPort::kMostFrames> frames;
        for (int i = 0; i < 20; ++i) static_cast<void>(rig.due_frames({}, frames));
    } catch (const settings::Error&) {
    }
    try {
        const control::Config config = load_controller_config(path);
        fuzz::require(config.valve.points >= 2 && config.valve.points <= control::ValveConfig::kMostPoints);
    } catch (const settings::Error&) {
    }
    return 0;
}
