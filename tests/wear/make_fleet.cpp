/// Campaigns of a made-up fleet as CSV, to learn a population from and to test a forecast on: wear-fleet FIRST_SEED COUNT DIR.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>

#include "config/reader/atomic_file.hpp"
#include "tests/wear/fleet.hpp"

int main(int argc, char** argv) try {
    if (argc != 4) {
        fmt::print(stderr, "wear-fleet FIRST_SEED COUNT DIR\n");
        return 2;
    }
    const std::uint64_t first = std::stoull(argv[1]);
    const std::uint64_t count = std::stoull(argv[2]);
    const std::filesystem::path directory = argv[3];
    std::filesystem::create_directories(directory);
    for (std::uint64_t seed = first; seed < first + count; ++seed)
        settings::write_file(directory / fmt::format("brake_{:06}.csv", seed),
                             wear::to_csv(physical::worn_out(seed).campaign));
    return 0;
} catch (const std::exception& e) {
    fmt::print(stderr, "wear-fleet: {}\n", e.what());
    return 1;
}
