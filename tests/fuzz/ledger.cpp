// A ledger that was damaged, or is none: its campaigns are read, or it is refused with the file's name.
#include <stdexcept>

#include "rig_bridge/record/ledger.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const fuzz::Input input(data, size);
    static const fuzz::File file("fuzz.sqlite");
    const std::filesystem::path& path = file.holding(input.text());
    try {
        for (const rig::record::Campaign& campaign : rig::record::read_campaigns(path))
            static_cast<void>(rig::record::read_ledger(path, campaign.name));
    } catch (const std::runtime_error& error) {
        fuzz::require(std::string_view(error.what()).find("fuzz.sqlite") != std::string_view::npos);
    }
    return 0;
}
