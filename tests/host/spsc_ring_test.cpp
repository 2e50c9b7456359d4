#include "firmware/host/spsc_ring.hpp"

#include <cstdint>
#include <memory>
#include <thread>

#include "tests/catch.hpp"

using antiskid::host::SpscRing;

TEST_CASE("a ring gives back what was put in, in order, over many turns", "[RT-073]") {
    SpscRing<int, 8> ring;
    int value = -1;
    REQUIRE_FALSE(ring.pop(value));
    REQUIRE(value == -1);
    int next_in = 0;
    int next_out = 0;
    for (int turn = 0; turn < 1000; ++turn) {
        const int burst = 1 + turn % 8;
        for (int i = 0; i < burst; ++i) REQUIRE(ring.push(next_in++));
        while (ring.pop(value)) REQUIRE(value == next_out++);
        REQUIRE(next_out == next_in);
    }
    REQUIRE(ring.dropped() == 0);
}

TEST_CASE("a full ring keeps what it holds and counts what it loses", "[RT-073]") {
    SpscRing<int, 4> ring;
    for (int i = 0; i < 4; ++i) REQUIRE(ring.push(i));
    for (int i = 4; i < 10; ++i) REQUIRE_FALSE(ring.push(i));
    REQUIRE(ring.dropped() == 6);
    int value = -1;
    for (int i = 0; i < 4; ++i) {
        REQUIRE(ring.pop(value));
        REQUIRE(value == i);
    }
    REQUIRE_FALSE(ring.pop(value));
    REQUIRE(ring.push(10));
    REQUIRE(ring.pop(value));
    REQUIRE(value == 10);
}

// Under the thread sanitizer this is the proof that an item is seen whole: it holds three words that must
// agree.
TEST_CASE("two threads: every item arrives whole and in order, or is counted as dropped", "[RT-073]") {
    struct Item {
        std::uint64_t number;
        std::uint64_t twice;
        std::uint64_t inverse;
    };
    auto ring = std::make_unique<SpscRing<Item, 64>>();
    constexpr std::uint64_t kItems = 200'000;
    std::thread writer([&ring] {
        for (std::uint64_t i = 1; i <= kItems; ++i) ring->push({i, 2 * i, ~i});
        while (!ring->push({0, 0, ~std::uint64_t{0}})) std::this_thread::yield();
    });
    const std::uint64_t kNotSeen = 0;
    std::uint64_t received = 0;
    std::uint64_t last = kNotSeen;
    bool whole = true;
    bool ordered = true;
    for (Item item{};;) {
        if (!ring->pop(item)) {
            std::this_thread::yield();
            continue;
        }
        whole = whole && item.twice == 2 * item.number && item.inverse == ~item.number;
        if (item.number == 0) break;
        ordered = ordered && item.number > last;
        last = item.number;
        ++received;
    }
    writer.join();
    CHECK(whole);
    CHECK(ordered);
    // The writer's repeated attempts to place the closing item count as drops as well.
    CHECK(received + ring->dropped() >= kItems);
    CHECK(received <= kItems);
}
