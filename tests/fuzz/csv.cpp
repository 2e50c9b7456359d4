// Recordings and tables of other systems as text: read, or refused with the file's name.
#include <cmath>

#include "rig_bridge/replay/recording.hpp"
#include "rig_bridge/wear/wear_campaign.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input input(data, size);
    const auto how = input.take<std::uint8_t>();
    rig::replay::ImportMap map;
    if ((how & 1U) != 0) map.separator = ';';
    if ((how & 2U) != 0) map.decimal = ',';
    if ((how & 4U) != 0) {
        map.unit_row = 2;
        map.first_data_row = 3;
    }
    static const fuzz::File file("fuzz.csv");
    try {
        const auto recording = rig::replay::open_recording(file.holding(input.text()), map, {"t", "p"});
        for (rig::replay::RecordedRow row; recording->next(row);) {
            fuzz::require(row.values.size() == 2);
            std::size_t none = 0;
            for (const double value : row.values) none += std::isnan(value) ? 1 : 0;
            fuzz::require(row.unreadable.size() == none);
        }
    } catch (const std::runtime_error& error) {
        fuzz::require(std::string_view(error.what()).find("fuzz.csv") != std::string_view::npos);
    }
    try {
        static_cast<void>(wear::parse_campaign("fuzz.csv", input.text()));
    } catch (const std::runtime_error& error) {
        fuzz::require(std::string_view(error.what()).find("fuzz.csv") != std::string_view::npos);
    }
    return 0;
}
