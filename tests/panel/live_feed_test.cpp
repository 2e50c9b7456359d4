// What the loop hands over: no peak between two pixels is lost, what is not known is null, and nobody is waited for. [BRG-520]
#include <chrono>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "firmware/host/settings/json.hpp"
#include "rig_bridge/panel/broadcast.hpp"
#include "rig_bridge/panel/curves.hpp"
#include "rig_bridge/panel/live_feed.hpp"
#include "tests/catch.hpp"

using namespace rig::panel;

namespace {

LiveSample sample(double time_s, double slip) {
    LiveSample s;
    s.time_s = time_s;
    s[Signal::slip] = slip;
    s[Signal::pressure] = 1e7;
    return s;
}

using Events = std::vector<std::pair<std::string, std::string>>;

Events collected(LiveFeed& feed) {
    Events events;
    feed.collect([&](std::string_view event, const std::string& data) { events.emplace_back(event, data); });
    return events;
}

constexpr std::chrono::milliseconds kNoWait{0};

}  // namespace

TEST_CASE("a pixel keeps the least, the greatest and the last of its samples", "[BRG-520]") {
    LiveFeed feed;
    for (const double slip : {0.2, 0.9, 0.1, 0.3}) feed.sample(sample(1.0, slip));
    const Events events = collected(feed);
    REQUIRE(events.size() == 1);
    CHECK(events[0].first == "pixel");
    const auto pixel = settings::parse_json(events[0].second);
    CHECK(pixel["v"][static_cast<std::size_t>(Signal::slip)] == settings::Json({0.1, 0.9, 0.3}));
    CHECK(pixel["v"][static_cast<std::size_t>(Signal::pressure)] == settings::Json({10.0, 10.0, 10.0}));
    CHECK(pixel["v"][static_cast<std::size_t>(Signal::load)] == settings::Json({nullptr, nullptr, nullptr}));
    CHECK(collected(feed).empty());
}

TEST_CASE("while the clock stands still, samples wait for the next pixel", "[BRG-520]") {
    LiveFeed feed;
    feed.sample(sample(1.0, 0.2));
    REQUIRE(collected(feed).size() == 1);
    feed.sample(sample(1.0, 0.9));
    CHECK(collected(feed).empty());
    feed.sample(sample(1.0004, 0.1));
    CHECK(collected(feed).empty());  // the page reads milliseconds
    feed.sample(sample(1.001, 0.3));
    const Events later = collected(feed);
    REQUIRE(later.size() == 1);
    const auto pixel = settings::parse_json(later[0].second);
    CHECK(pixel["t"] == 1.001);
    CHECK(pixel["v"][static_cast<std::size_t>(Signal::slip)] == settings::Json({0.1, 0.9, 0.3}));
    feed.sample(sample(0.5, 0.3));  // another program with a clock of its own
    CHECK(collected(feed).size() == 1);
}

TEST_CASE("states are due ten times a second, and come once", "[BRG-520]") {
    LiveFeed feed;
    CHECK(feed.state_due(5.0));
    feed.state([] { return "{}"; }, 5.0);
    CHECK_FALSE(feed.state_due(5.05));
    CHECK(feed.state_due(5.11));
    CHECK(feed.state_due(0.0));  // the clock began anew
    CHECK(collected(feed) == Events{{"state", "{}"}});
    CHECK(collected(feed).empty());
}

TEST_CASE("the text of states is made by the reader, and only of the newest", "[BRG-520]") {
    LiveFeed feed;
    std::vector<std::thread::id> made_by;
    for (const double now_s : {5.0, 5.1})
        feed.state(
            [&made_by] {
                made_by.push_back(std::this_thread::get_id());
                return std::string("{}");
            },
            now_s);
    CHECK(made_by.empty());
    std::thread reader([&feed] { (void)collected(feed); });
    const std::thread::id id = reader.get_id();
    reader.join();
    CHECK(made_by == std::vector{id});
}

TEST_CASE("a loop that nobody reads goes on", "[BRG-520]") {
    LiveFeed feed;
    for (int i = 0; i < 100'000; ++i) feed.sample(sample(i * 1e-3, 0.2));
    CHECK(collected(feed).size() == 1);
}

TEST_CASE("a viewer has what was kept, then what is new, and is dropped when it falls behind", "[BRG-520]") {
    Broadcast all;
    all.publish("pixel", "1");
    all.publish("pixel", "2");
    Broadcast::Place quick, slow;
    CHECK(all.take(quick, kNoWait) == "event: pixel\ndata: 1\n\nevent: pixel\ndata: 2\n\n");
    CHECK(all.take(quick, kNoWait) == ":\n\n");
    CHECK(all.take(slow, kNoWait).has_value());
    for (std::size_t i = 0; i <= Broadcast::kKept; ++i) {
        all.publish("pixel", "x");
        CHECK(all.take(quick, kNoWait) == "event: pixel\ndata: x\n\n");
    }
    CHECK_FALSE(all.take(slow, kNoWait).has_value());
    all.close();
    CHECK_FALSE(all.take(quick, kNoWait).has_value());
}

TEST_CASE("curves have the channels that are known, in their units", "[BRG-520]") {
    Curves curves;
    CHECK(curves.empty());
    curves.add(sample(-0.001, 0.2));
    curves.add(sample(0.0004, std::nan("")));
    const auto json = settings::parse_json(curves.json());
    CHECK(json["t"] == settings::Json({-0.001, 0.0}));
    CHECK(json["slip"] == settings::Json({0.2, nullptr}));
    CHECK(json["pressure"] == settings::Json({10.0, 10.0}));
    CHECK_FALSE(json.contains("load"));
}
