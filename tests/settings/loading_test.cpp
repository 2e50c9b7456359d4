#include "firmware/host/settings/input_file.hpp"

#include "tests/settings/refusal.hpp"

TEST_CASE("a file is loaded with its path in every message", "[CFG-021]") {
    const TemporaryDirectory directory;
    const auto path = directory / "plant.toml";
    const std::string text = "\xEF\xBB\xBF[wheel]\r\ninertia_kgm2 = 900\r\n";
    put(path, text);
    const auto doc = settings::Document::load(path);
    CHECK(doc.bytes() == text);
    CHECK(rejection_of([&] { return doc.root().table("wheel").number("inertia_kgm2", {.min = 0.01, .max = 100.0}); }).what() ==
          path.string() + ":2: wheel.inertia_kgm2: 900 is out of range 0.01 to 100");

    put(path, "");
    CHECK_NOTHROW(settings::Document::load(path).finish());
}

TEST_CASE("a file that cannot be read is named, with the reason", "[CFG-021]") {
    const TemporaryDirectory directory;
    const auto rejected = [](const std::filesystem::path& path) {
        const auto error = rejection_of([&] { return settings::Document::load(path); });
        CHECK(error.file() == path.string());
        CHECK(error.line() == 0);
        return error.message();
    };
    CHECK(rejected(directory / "absent.toml") == "cannot be opened: No such file or directory");
    CHECK(rejected(directory.path()) == "is a directory, not a file");
    CHECK(rejected("") == "cannot be opened: No such file or directory");
    put(directory / "file", "x");
    CHECK(rejected(directory / "file/below.toml") == "cannot be opened: Not a directory");
    // Opens, then fails to read, also for root, who may read whatever permissions forbid.
    CHECK(rejected("/proc/self/mem") == "cannot be read: Input/output error");
    CHECK(rejected("/dev/zero") == "is larger than 16 MiB");
}

TEST_CASE("the bytes of a file are read as they are", "[CFG-021]") {
    const TemporaryDirectory directory;
    std::string bytes;
    for (int i = 0; i < 200000; ++i) bytes += static_cast<char>(i * 7 % 256);
    put(directory / "bytes", bytes);
    CHECK(settings::read_file(directory / "bytes") == bytes);
}

TEST_CASE("the size limit is 16 MiB, to the byte", "[CFG-021]") {
    const TemporaryDirectory directory;
    constexpr std::uintmax_t kLimit = 16U << 20U;
    put(directory / "big", "");
    std::filesystem::resize_file(directory / "big", kLimit);
    CHECK(settings::read_file(directory / "big").size() == kLimit);
    std::filesystem::resize_file(directory / "big", kLimit + 1);
    CHECK(rejection_of([&] { return settings::read_file(directory / "big"); }).message() == "is larger than 16 MiB");
}
