// A DBC from anywhere is read or refused with its line; the shipped binding then finds its messages in it or says what is missing.
#include "firmware/can/dbc.hpp"
#include "config/reader/error.hpp"
#include "firmware/can/load_layout.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const fuzz::Input input(data, size);
    try {
        const antiskid::can::Dbc dbc = antiskid::can::parse_dbc(input.text(), "fuzz.dbc");
        for (const antiskid::can::DbcMessage& message : dbc.messages) {
            for (const antiskid::can::DbcSignal& signal : message.signals)
                fuzz::require(signal.bits > 0 && !signal.name.empty());
        }
    } catch (const settings::Error& error) {
        fuzz::require(error.line() >= 1);
        return 0;
    }
    static const fuzz::File file("fuzz.dbc");
    try {
        static_cast<void>(
            antiskid::can::load_layout(file.holding(input.text()), "config/antiskid_binding.toml"));
    } catch (const settings::Error&) {
    }
    return 0;
}
