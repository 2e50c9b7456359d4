// MATLAB files from anywhere: read, or refused with the file's name.
#include "rig_bridge/replay/mat_structure.hpp"
#include "rig_bridge/replay/recording.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const fuzz::Input input(data, size);
    static const fuzz::File file("fuzz.mat");
    const auto names_the_file = [](const std::runtime_error& error) {
        return std::string_view(error.what()).find("fuzz.mat") != std::string_view::npos;
    };
    try {
        // What open_mat() begins with: most end here, and need no file.
        rig::replay::check_mat_structure("fuzz.mat", input.rest());
    } catch (const std::runtime_error& error) {
        fuzz::require(names_the_file(error));
        return 0;
    }
    const std::filesystem::path& path = file.holding(input.text());
    for (const char* const wanted : {"p", "bench.p", "data:2"}) {
        try {
            const auto recording = rig::replay::open_mat(path, {wanted});
            for (rig::replay::RecordedRow row; recording->next(row);) fuzz::require(row.values.size() == 1);
        } catch (const std::runtime_error& error) {
            fuzz::require(names_the_file(error));
        }
    }
    return 0;
}
