// A DBC from anywhere is read or refused with its line; a binding whose first message is in it finds the others, or says what is missing.
#include "firmware/can/dbc.hpp"
#include "firmware/can/load_layout.hpp"
#include "firmware/host/settings/error.hpp"
#include "tests/fuzz/input.hpp"

namespace {

/// None: no binding would get beyond its first message.
const char* binding_of(std::string_view dbc) {
    if (dbc.find(" WheelEncoder:") != std::string_view::npos) return "config/antiskid_binding.toml";
    if (dbc.find(" WHEEL_SPEED:") != std::string_view::npos) return "config/foreign_binding.toml";
    return nullptr;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace antiskid;
    const fuzz::Input input(data, size);
    static const fuzz::File file("fuzz.dbc");
    try {
        if (const char* const binding = binding_of(input.text())) {
            static_cast<void>(can::load_layout(file.holding(input.text()), binding));
            return 0;
        }
        const can::Dbc dbc = can::parse_dbc(input.text(), "fuzz.dbc");
        for (const can::DbcMessage& message : dbc.messages) {
            for (const can::DbcSignal& signal : message.signals) fuzz::require(signal.bits > 0 && !signal.name.empty());
        }
    } catch (const settings::Error& error) {
        fuzz::require(error.line() >= 1);
    }
    return 0;
}
