/// The panel's web server: pages and live view for who looks, changes for who has the token. It knows no rig: what it shows is handed in as
/// text, what it may do as functions.
///
///     LiveFeed feed;                                                  // the program's loop writes it, and never waits
///     Server server({.address = parse_address("127.0.0.1:8410"), .about = about, .reads = {}, .changes = {}}, &feed);
///     say(server.greeting());
///
/// Threads of its own serve it, as many as kThreads; they inherit priority and signal mask from whoever constructs it, so that is done ahead
/// of real time. One request a connection, 4 KiB a body, 20 viewers of events; more wait or are refused.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

#include "rig_bridge/panel/about.hpp"
#include "rig_bridge/panel/live_feed.hpp"
#include "rig_bridge/panel/page.hpp"

namespace rig::panel {

struct Address {
    std::string host = "127.0.0.1";  ///< numeric
    int port = 8410;                 ///< 0: any free one
};
inline constexpr const char* kDefaultAddress = "127.0.0.1:8410";
/// "127.0.0.1:8410", "[::1]:8410". Throws std::invalid_argument: no such address, or one that means every interface.
[[nodiscard]] Address parse_address(std::string_view text);

/// Parameters of a request: its query, or the fields of its form.
class Query {
  public:
    explicit Query(std::multimap<std::string, std::string> values) : values_(std::move(values)) {}
    [[nodiscard]] std::string text(const std::string& key) const;  ///< empty: not given
    /// Throws std::invalid_argument naming `key`.
    [[nodiscard]] double number(const std::string& key) const;
    [[nodiscard]] std::int64_t integer(const std::string& key) const;
    [[nodiscard]] bool has(const std::string& key) const { return values_.contains(key); }

  private:
    std::multimap<std::string, std::string> values_;
};

/// JSON. What it throws becomes the answer's `error` with status 400, of a Busy 503. Called by several threads at a time.
using Handler = std::function<std::string(const Query&)>;
class Busy : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

struct ServerOptions {
    Address address;
    About about;
    std::map<std::string, Handler> reads{};  ///< by name, GET /api/NAME
    /// POST /api/NAME, with the token in X-Panel-Token.
    std::map<std::string, Handler> changes{};
    std::filesystem::path charts = kChartsLibrary;
};

class Server {
  public:
    static constexpr int kViewers = 20;
    static constexpr std::size_t kThreads = 28;
    static constexpr std::size_t kLongestBody = 4096;

    /// Listens when it returns. `feed` must outlive it; none: no live view. Throws std::runtime_error where the address is not to be had.
    explicit Server(ServerOptions options, LiveFeed* feed = nullptr);
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    [[nodiscard]] int port() const;
    [[nodiscard]] const std::string& token() const;
    /// Where the page is, for people, and where there are changes the link that may make them.
    [[nodiscard]] std::string greeting() const;
    [[nodiscard]] int viewers() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Takes as long for every text of the token's length.
[[nodiscard]] bool is_token(std::string_view said, std::string_view token);

}  // namespace rig::panel
