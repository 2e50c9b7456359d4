// Who may look, who may change, and that nobody holds the program up. [BRG-520] [BRG-521]
#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "rig_bridge/panel/server.hpp"
#include "tests/catch.hpp"

using namespace rig::panel;

namespace {

/// A connection that has sent `request`.
class Connection {
  public:
    Connection(int port, const std::string& request, int buffer = 0) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
        if (buffer > 0) (void)setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
        const timeval limit{.tv_sec = 10, .tv_usec = 0};
        (void)setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(static_cast<std::uint16_t>(port));
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) throw std::runtime_error("no connection");
        (void)::send(socket_, request.data(), request.size(), MSG_NOSIGNAL);
    }
    ~Connection() { ::close(socket_); }
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    /// Until `text` was heard, or the other end has closed.
    std::string read_until(const std::string& text) {
        std::array<char, 4096> part{};
        while (text.empty() || heard_.find(text) == std::string::npos) {
            const ssize_t n = recv(socket_, part.data(), part.size(), 0);
            if (n <= 0) break;
            heard_.append(part.data(), static_cast<std::size_t>(n));
        }
        return heard_;
    }

  private:
    int socket_;
    std::string heard_;
};

std::string request(const Server& server, const std::string& line, const std::string& headers = {}, const std::string& body = {}) {
    return fmt::format("{} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n{}\r\n{}", line, server.port(), headers, body);
}

std::string ask(const Server& server, const std::string& text) {
    return Connection(server.port(), text).read_until({});
}

int status(const std::string& answer) {
    return answer.size() > 12 ? std::stoi(answer.substr(9, 3)) : 0;
}

std::string post(const Server& server, const std::string& name, const std::string& headers, const std::string& body) {
    return request(server, "POST /api/" + name,
                   fmt::format("Content-Type: application/x-www-form-urlencoded\r\nContent-Length: {}\r\n{}", body.size(), headers), body);
}

ServerOptions free_port() {
    return {.address = parse_address("127.0.0.1:0"), .about = {.title = "test", .views = {"live"}}};
}

}  // namespace

TEST_CASE("addresses of the panel", "[BRG-521]") {
    CHECK(parse_address("127.0.0.1:8410").port == 8410);
    CHECK(parse_address("[::1]:80").host == "::1");
    for (const char* const wrong : {"", "8410", "localhost:80", "127.0.0.1:", "127.0.0.1:70000", "0.0.0.0:80", "[::]:80", "127.0.0.1:8x"})
        CHECK_THROWS_AS(parse_address(wrong), std::invalid_argument);
    const Server server(free_port());
    ServerOptions second = free_port();
    second.address.port = server.port();
    CHECK_THROWS_WITH(Server(second), Catch::Contains("is not to be had"));
}

TEST_CASE("the page comes with a strict policy, to this computer's own names alone", "[BRG-521]") {
    const Server server(free_port());
    const std::string page = ask(server, request(server, "GET /"));
    CHECK(status(page) == 200);
    CHECK(page.find("Content-Security-Policy: default-src 'none'; script-src 'self'") != std::string::npos);
    CHECK(page.find("unsafe") == std::string::npos);
    for (const char* const file : {"/panel.js", "/charts.js", "/panel.css", "/api/about"})
        CHECK(status(ask(server, request(server, fmt::format("GET {}", file)))) == 200);
    CHECK(status(ask(server, request(server, "GET /../etc/passwd"))) == 404);
    CHECK(status(ask(server, fmt::format("GET / HTTP/1.1\r\nHost: localhost:{}\r\n\r\n", server.port()))) == 200);
    CHECK(status(ask(server, "GET / HTTP/1.1\r\nHost: rebound.example:8410\r\n\r\n")) == 421);
    CHECK(status(ask(server, "GET / HTTP/1.1\r\n\r\n")) == 421);
    CHECK(status(ask(server, request(server, "GET /", "Origin: http://elsewhere.example\r\n"))) == 403);
    CHECK(status(ask(server, request(server, "GET /", fmt::format("Origin: http://127.0.0.1:{}\r\n", server.port())))) == 200);
    CHECK(status(ask(server, request(server, "PUT /", "Content-Length: 0\r\n"))) == 405);
}

TEST_CASE("changes need the token, and a body that is bounded", "[BRG-521]") {
    std::atomic<int> changed{0};
    ServerOptions options = free_port();
    options.changes["abort"] = [&changed](const Query& query) {
        if (query.text("why") == "no") throw std::runtime_error("not now");
        ++changed;
        return std::string(R"({"said":"done"})");
    };
    const Server server(options);
    const std::string right = "X-Panel-Token: " + server.token() + "\r\n";
    CHECK(status(ask(server, post(server, "abort", "", "why=x"))) == 401);
    CHECK(status(ask(server, post(server, "abort", "X-Panel-Token: " + std::string(32, '0') + "\r\n", "why=x"))) == 401);
    CHECK(status(ask(server, post(server, "abort", right + "Origin: http://elsewhere.example\r\n", "why=x"))) == 403);
    CHECK(status(ask(server, request(server, "GET /api/abort", right))) == 404);
    CHECK(status(ask(server, post(server, "abort", right, "why=" + std::string(5000, 'x')))) == 413);
    CHECK(status(ask(server, request(server, "POST /api/abort", right + "Transfer-Encoding: chunked\r\n", "5\r\nwhy=x\r\n0\r\n\r\n"))) == 411);
    CHECK(changed == 0);
    CHECK(status(ask(server, post(server, "abort", right, "why=x"))) == 200);
    CHECK(changed == 1);
    const std::string refused = ask(server, post(server, "abort", right, "why=no"));
    CHECK(status(refused) == 400);
    CHECK(refused.find(R"({"error":"not now"})") != std::string::npos);
    CHECK(server.greeting().find(server.token()) != std::string::npos);
    CHECK(Server(free_port()).greeting().find("token") == std::string::npos);
}

TEST_CASE("tokens", "[BRG-521]") {
    CHECK(is_token("abc", "abc"));
    for (const char* const wrong : {"", "ab", "abd", "abcd", "ABC"}) CHECK_FALSE(is_token(wrong, "abc"));
    CHECK(Server(free_port()).token() != Server(free_port()).token());
}

TEST_CASE("parameters of requests", "[BRG-521]") {
    const Query query({{"a", "1.5"}, {"b", "7"}, {"c", "7x"}, {"d", ""}});
    CHECK(query.number("a") == 1.5);
    CHECK(query.integer("b") == 7);
    for (const char* const wrong : {"c", "d", "e"}) {
        CHECK_THROWS_AS(query.number(wrong), std::invalid_argument);
        CHECK_THROWS_AS(query.integer(wrong), std::invalid_argument);
    }
    CHECK_THROWS_AS(query.integer("a"), std::invalid_argument);
}

TEST_CASE("twenty look, one more is refused, and the page is still served", "[BRG-520]") {
    LiveFeed feed;
    const Server server(free_port(), &feed);
    std::vector<std::unique_ptr<Connection>> viewers;
    for (int i = 0; i < Server::kViewers; ++i) {
        viewers.push_back(std::make_unique<Connection>(server.port(), request(server, "GET /events")));
        CHECK(viewers.back()->read_until("\r\n\r\n").find("text/event-stream") != std::string::npos);
    }
    CHECK(status(ask(server, request(server, "GET /events"))) == 503);
    CHECK(status(ask(server, request(server, "GET /"))) == 200);
    LiveSample sample;
    sample.time_s = 7.25;
    feed.sample(sample);
    for (const auto& viewer : viewers) CHECK(viewer->read_until("\"t\":7.250").find("event: pixel") != std::string::npos);
}

TEST_CASE("a viewer that takes nothing is dropped, and the others have everything meanwhile", "[BRG-520]") {
    using Clock = std::chrono::steady_clock;
    LiveFeed feed;
    const Server server(free_port(), &feed);
    Connection stuck(server.port(), request(server, "GET /events"), 4096);
    Connection reads(server.port(), request(server, "GET /events"));
    (void)reads.read_until("\r\n\r\n");
    const std::string large = "\"" + std::string(30'000, 'x') + "\"";
    const auto end = Clock::now() + std::chrono::seconds(20);
    bool both = false;
    bool dropped = false;
    for (int i = 0; !dropped && Clock::now() < end; ++i) {
        both = both || server.viewers() == 2;
        feed.sample({});
        feed.state([large] { return large; }, i);
        (void)reads.read_until("event: state\ndata: \"");
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        dropped = both && server.viewers() == 1;
    }
    CHECK(dropped);
}
