#include "plant_sim/simulation/simulated_disk.hpp"

#include <cerrno>
#include <memory>
#include <set>
#include <string>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/input_file.hpp"
#include "tests/catch.hpp"

using plant_sim::simulation::DiskFault;
using plant_sim::simulation::SimulatedDisk;

namespace {

std::string content(const SimulatedDisk& disk, const std::string& path) {
    return settings::read_file(path, settings::kMaxSettings, disk);
}

bool there(const SimulatedDisk& disk, const std::string& path) {
    return std::filesystem::exists(disk.status(path));
}

std::unique_ptr<settings::File> new_file(const SimulatedDisk& disk, const std::string& path) {
    settings::OpenResult opened = disk.create(path);
    REQUIRE(opened.file);
    return std::move(opened.file);
}

}  // namespace

TEST_CASE("a power cut keeps what was synced, name and bytes, and draws for the rest", "[BRG-700]") {
    const std::string synced(3000, 's');
    const std::string later(9000, 'l');
    std::set<std::string> left;
    std::set<bool> unsynced_name;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        const SimulatedDisk disk(seed);
        const auto file = new_file(disk, "/kept");
        CHECK(file->append(synced) == 3000);
        CHECK(file->sync() == 0);
        CHECK(disk.sync_directory("/") == 0);
        CHECK(file->append(later) == 9000);
        (void)new_file(disk, "/unsynced");
        CHECK(content(disk, "/kept") == synced + later);
        disk.restart();
        const std::string bytes = content(disk, "/kept");
        CHECK(bytes.starts_with(synced));
        CHECK(bytes.find_first_not_of(std::string("l\0", 2), synced.size()) == std::string::npos);
        left.insert(bytes);
        unsynced_name.insert(there(disk, "/unsynced"));
    }
    CHECK(left.contains(synced));
    CHECK(left.contains(synced + later));
    CHECK(left.size() > 50);
    CHECK(unsynced_name.size() == 2);
}

TEST_CASE("a file written whole is all of the old bytes or all of the new, wherever the power is cut", "[BRG-700]") {
    const std::string before(5000, 'o');
    const std::string after(7000, 'n');
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        for (std::uint64_t at = 1;; ++at) {
            const SimulatedDisk disk(seed);
            settings::write_file("/runs/summary", before, disk);
            disk.clear_faults();
            disk.inject(at, DiskFault::power_cut);
            bool said = true;
            try {
                settings::write_file("/runs/summary", after, disk);
            } catch (const settings::Error&) {
                said = false;
            }
            if (disk.runs()) break;
            disk.restart();
            const std::string bytes = content(disk, "/runs/summary");
            CHECK((bytes == after || (!said && bytes == before)));
        }
    }
}

TEST_CASE("a disk that is full, refuses or takes a part says so once, where it was asked to", "[BRG-700]") {
    const SimulatedDisk disk(3);
    const auto file = new_file(disk, "/file");
    disk.clear_faults();
    disk.inject(1, DiskFault::no_space, 2);
    disk.inject(3, DiskFault::short_write);
    disk.inject(4, DiskFault::refused);
    CHECK(file->append("abc") == -ENOSPC);
    CHECK(disk.create("/other").error == ENOSPC);
    const std::int64_t part = file->append("abcdefgh");
    CHECK(part > 0);
    CHECK(part < 8);
    CHECK(file->sync() == EIO);
    CHECK(file->sync() == 0);
    CHECK(disk.sync_directory("/") == 0);
    CHECK(content(disk, "/file").size() == static_cast<std::size_t>(part));
    CHECK(disk.fault_counts() == std::array<std::uint64_t, 5>{0, 0, 2, 1, 1});
    disk.inject(1, DiskFault::power_cut);
    CHECK(file->append("x") == -EIO);
    CHECK_FALSE(disk.runs());
    CHECK(disk.open("/file").error == EIO);
    disk.restart();
    CHECK(there(disk, "/file"));
}

TEST_CASE("a killed program loses nothing that it wrote, until the power is cut", "[BRG-700]") {
    std::set<std::string> left;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const SimulatedDisk disk(seed);
        const auto file = new_file(disk, "/file");
        CHECK(disk.sync_directory("/") == 0);
        CHECK(file->append("abc") == 3);
        disk.clear_faults();
        disk.inject(1, DiskFault::kill);
        CHECK(file->sync() == EIO);
        CHECK_FALSE(disk.runs());
        disk.restart();
        CHECK(content(disk, "/file") == "abc");
        disk.restart();
        left.insert(content(disk, "/file"));
    }
    CHECK(left.size() > 2);
}

TEST_CASE("while a file's version is the same, so are its bytes", "[BRG-700]") {
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        const SimulatedDisk disk(seed);
        const auto file = new_file(disk, "/log");
        REQUIRE(disk.sync_directory("/") == 0);
        std::uint64_t version = disk.version("/log");
        std::string bytes;
        const auto same_bytes_if_same_version = [&] {
            if (disk.version("/log") == version) CHECK(disk.bytes("/log") == bytes);
            version = disk.version("/log");
            bytes = disk.bytes("/log");
        };
        for (const char c : {'a', 'b', 'c'}) {
            CHECK(file->append(std::string(5000, c)) == 5000);
            CHECK(disk.version("/log") != version);
            same_bytes_if_same_version();
            if (c == 'a') CHECK(file->sync() == 0);
            CHECK(disk.version("/log") == version);
        }
        CHECK(file->truncate(12000) == 0);
        same_bytes_if_same_version();
        disk.restart();
        same_bytes_if_same_version();
    }
}
