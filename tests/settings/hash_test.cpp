#include "firmware/host/settings/hash.hpp"

#include <array>
#include <vector>

#include "tests/settings/refusal.hpp"

namespace {

std::string hash_of(std::vector<std::string_view> contents) {
    return settings::hash_bytes(contents);
}

}  // namespace

TEST_CASE("the hash is the one that xxhsum finds", "[CFG-023]") {
    // printf 'hi\n' > a; printf '' > b; for f in a b; do xxhsum -q -H2 $f | cut -c1-32; done | xxhsum -q -H2
    CHECK(hash_of({"hi\n"}) == "156cf5929a9c3cbcd4a602a1e53f14a5");
    CHECK(hash_of({"hi\n", ""}) == "a42cac84abf5d508f758bacdc1d5ebaf");
}

TEST_CASE("the hash sees every byte, the order and the borders of the files", "[CFG-023]") {
    CHECK(hash_of({"ab", "c"}) != hash_of({"a", "bc"}));
    CHECK(hash_of({"a", "b"}) != hash_of({"b", "a"}));
    CHECK(hash_of({"a"}) != hash_of({"a", ""}));
    CHECK(hash_of({"a = 1"}) != hash_of({"a = 1\n"}));
    CHECK(hash_of({"a"}) == hash_of({"a"}));
}

TEST_CASE("files are hashed by their bytes, not their names", "[CFG-023]") {
    const TemporaryDirectory directory;
    put(directory / "one", "hi\n");
    put(directory / "two", "hi\n");
    CHECK(settings::hash(std::array{directory / "one"}) == settings::hash(std::array{directory / "two"}));
    CHECK(settings::hash(std::array{directory / "one"}) == hash_of({"hi\n"}));
    CHECK(rejection_of([&] {
              return settings::hash(std::array{directory / "one", directory / "absent"});
          }).file() == (directory / "absent").string());
}
