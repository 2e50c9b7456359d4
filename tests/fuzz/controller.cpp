// TOML from anywhere as the controller's configuration.
#include "firmware/host/controller_config.hpp"
#include "firmware/host/settings/error.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace antiskid;
    const fuzz::Input input(data, size);
    static const fuzz::File file("fuzz.toml");
    try {
        const control::Config config = load_controller_config(file.holding(input.text()));
        fuzz::require(config.valve.points >= 2 && config.valve.points <= control::ValveConfig::kMaxPoints);
    } catch (const settings::Error&) {
    }
    return 0;
}
