// MATLAB files from anywhere: read, or refused with the file's name.
#include "rig_bridge/replay/recording.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const fuzz::Input input(data, size);
    static const fuzz::File file("fuzz.mat");
    const std::filesystem::path& path = file.holding(input.text());
    for (const char* const wanted : {"p", "bench.p", "data:2"}) {
        try {
            const auto recording = rig::open_mat(path, {wanted});
            for (rig::RecordedRow row; recording->next(row);) fuzz::require(row.values.size() == 1);
        } catch (const std::runtime_error& error) {
            fuzz::require(std::string_view(error.what()).find("fuzz.mat") != std::string_view::npos);
        }
    }
    return 0;
}
