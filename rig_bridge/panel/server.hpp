/// The panel's web server: anybody with access may see pages and live view; changes need the token. It does not know the rig: data are passed to it
/// as text, and changes as functions.
///
///     LiveFeed feed;                                                  // the program's loop writes it, and never waits
///     Server server({.address = parse_address("127.0.0.1:8410"), .about = about, .reads = {}, .changes = {}}, &feed);
///     say(server.greeting());
///
/// It has kThreads threads, which inherit priority and signal mask from the constructing thread: construct it before real-time operation starts.
/// Limits: one request per connection, bodies of 4 KiB, 20 viewers of events; further ones wait or are refused.
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
/// Parses "127.0.0.1:8410" or "[::1]:8410". Throws std::invalid_argument for an invalid address, and for one that stands for every interface.
[[nodiscard]] Address parse_address(std::string_view text);

/// Parameters of a request: those of its query, or the fields of its form.
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

/// Returns JSON. An exception becomes the answer's `error` with status 400, for Busy 503. Called by several threads at once.
using Handler = std::function<std::string(const Query&)>;
class Busy : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

struct ServerOptions {
    Address address;
    About about;
    std::map<std::string, Handler> reads{};  ///< by name, GET /api/NAME
    /// By name, POST /api/NAME, with the token in X-Panel-Token.
    std::map<std::string, Handler> changes{};
    std::filesystem::path charts = kChartsLibrary;
};

class Server {
  public:
    static constexpr int kViewers = 20;
    static constexpr std::size_t kThreads = 28;
    static constexpr std::size_t kLongestBody = 4096;

    /// Listens when it returns. `feed` must outlive it; null: no live view. Throws std::runtime_error if the address cannot be bound.
    explicit Server(ServerOptions options, LiveFeed* feed = nullptr);
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    [[nodiscard]] int port() const;
    [[nodiscard]] const std::string& token() const;
    /// Text for people: the page's address and, if there are changes, the link that permits them.
    [[nodiscard]] std::string greeting() const;
    [[nodiscard]] int viewers() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Whether `said` is the token; takes the same time for every text of the token's length.
[[nodiscard]] bool is_token(std::string_view said, std::string_view token);

}  // namespace rig::panel
