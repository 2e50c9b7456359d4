// TOML from anywhere, bound to the shipped DBC. A layout that is accepted can be used.
#include <array>

#include "firmware/can/load_layout.hpp"
#include "firmware/can/rig_port.hpp"
#include "firmware/host/settings/settings.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace antiskid;
    const fuzz::Input input(data, size);
    static const fuzz::File file("fuzz.toml");
    try {
        // What the layout is read for first: most end here, and need no DBC.
        const settings::Document document = settings::Document::parse(std::string(input.text()), "fuzz.toml");
        static_cast<void>(document.root().table("wheel").text("message"));
        const can::Layout layout = can::load_layout("config/foreign.dbc", file.holding(input.text()));
        can::RigPort rig(layout, control::Time{1'000'000});
        std::array<can::Frame, can::RigPort::kMaxFrames> frames;
        for (int i = 0; i < 20; ++i) static_cast<void>(rig.due_frames({}, frames));
    } catch (const settings::Error&) {
    }
    return 0;
}
