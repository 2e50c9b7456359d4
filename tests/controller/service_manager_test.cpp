#include "firmware/controller/service_manager.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "tests/catch.hpp"
#include "tests/settings/refusal.hpp"

using namespace std::chrono_literals;
using antiskid::controller::ServiceManager;
using antiskid::host::Time;

namespace {

struct Told {
    std::vector<std::string> said;
    ServiceManager manager;

    explicit Told(Time watchdog) : manager([this](const char* state) { said.emplace_back(state); }, watchdog) {}
    Told(const Told&) = delete;
    Told& operator=(const Told&) = delete;
};

}  // namespace

TEST_CASE("a service is ready with the loop's first cycle, and alive as long as they go on", "[RT-120]") {
    Told told(400ms);
    told.manager.update(0ms, 0);
    CHECK(told.said.empty());
    told.manager.update(20ms, 7);
    CHECK(told.said == std::vector<std::string>{"READY=1", "WATCHDOG=1"});
    for (std::uint64_t turn = 2; turn <= 51; ++turn)  // a second, in turns of 20 ms
        told.manager.update(turn * 20ms, 20 * turn);
    CHECK(told.said.size() == 2 + 10);
    told.said.clear();
    for (std::uint64_t turn = 52; turn <= 200; ++turn) told.manager.update(turn * 20ms, 1020);
    CHECK(told.said.empty());  // the loop stands
    told.manager.stopping();
    CHECK(told.said == std::vector<std::string>{"STOPPING=1"});
}

TEST_CASE("without a watchdog a service is ready, no more", "[RT-120]") {
    Told told(0ms);
    for (std::uint64_t turn = 1; turn < 100; ++turn) told.manager.update(turn * 20ms, turn);
    CHECK(told.said == std::vector<std::string>{"READY=1"});
}

TEST_CASE("what is said goes to the socket that systemd names", "[RT-120]") {
    const TemporaryDirectory directory;
    const std::string path = (directory / "notify").string();
    const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    REQUIRE(socket >= 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    REQUIRE(path.size() < sizeof address.sun_path);
    std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
    REQUIRE(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
    ServiceManager::of_this_process().update(1s, 1);
    ::unsetenv("NOTIFY_SOCKET");
    std::array<char, 64> text{};
    const ssize_t length = ::recv(socket, text.data(), text.size(), 0);
    ::close(socket);
    REQUIRE(length > 0);
    CHECK(std::string(text.data(), static_cast<std::size_t>(length)) == "READY=1");
    ServiceManager::of_this_process().update(1s, 1);  // nobody: nothing happens
}
