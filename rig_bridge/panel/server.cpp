#include "rig_bridge/panel/server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <httplib.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <fstream>
#include <iterator>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/number_in.hpp"
#include "rig_bridge/panel/broadcast.hpp"
#include "rig_bridge/panel/page.hpp"

namespace rig::panel {

namespace {

using std::chrono::milliseconds;
constexpr milliseconds kPixel{20};
constexpr time_t kPatience_s = 2;  // with who does not send or take

constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";

std::string random_token() {
    std::array<unsigned char, 16> bytes{};
    if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) throw std::runtime_error("panel: no random numbers");
    return fmt::format("{:02x}", fmt::join(bytes, ""));
}

std::string authority(const std::string& host, int port) {
    return fmt::format("{}:{}", host.find(':') == std::string::npos ? host : '[' + host + ']', port);
}

/// The library's own pool takes any number of connections in; here the next one waits outside, in the kernel's short queue, until a thread is
/// free.
class BoundedPool final : public httplib::TaskQueue {
  public:
    BoundedPool() {
        for (std::size_t i = 0; i < Server::kThreads; ++i) threads_.emplace_back([this] { work(); });
    }

    // void in version 0.11, bool later.
    using Taken = decltype(std::declval<httplib::TaskQueue&>().enqueue(std::declval<std::function<void()>>()));
    Taken enqueue(std::function<void()> task) override {
        std::unique_lock lock(mutex_);
        change_.wait(lock, [this] { return busy_ < Server::kThreads; });
        ++busy_;
        tasks_.push_back(std::move(task));
        change_.notify_all();
        return static_cast<Taken>(true);
    }
    void shutdown() override {
        {
            const std::lock_guard lock(mutex_);
            ending_ = true;
        }
        change_.notify_all();
        for (std::thread& thread : threads_) thread.join();
    }

  private:
    void work() {
        std::unique_lock lock(mutex_);
        for (;;) {
            change_.wait(lock, [this] { return ending_ || !tasks_.empty(); });
            if (tasks_.empty()) return;
            const std::function<void()> task = std::move(tasks_.front());
            tasks_.pop_front();
            lock.unlock();
            task();
            lock.lock();
            --busy_;
            change_.notify_all();
        }
    }

    std::mutex mutex_;
    std::condition_variable change_;
    std::deque<std::function<void()>> tasks_;
    std::size_t busy_ = 0;  // waiting or at work
    bool ending_ = false;
    std::vector<std::thread> threads_;
};

void set_socket(int socket) {
    const int yes = 1;
    (void)setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    // Connections inherit both: a viewer that takes nothing is noticed after seconds, not after megabytes.
    const int buffer = 64 * 1024;
    (void)setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &buffer, sizeof buffer);
    const timeval patience{.tv_sec = kPatience_s, .tv_usec = 0};
    (void)setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
}

void refuse(httplib::Response& response, int status, const std::string& why) {
    response.status = status;
    response.set_content(settings::Json{{"error", why}}.dump(-1, ' ', false, settings::Json::error_handler_t::replace), "application/json");
}

void answer(const Handler& handler, const httplib::Request& request, httplib::Response& response) {
    try {
        response.set_content(handler(Query({request.params.begin(), request.params.end()})), "application/json");
    } catch (const Busy& e) {
        refuse(response, 503, e.what());
    } catch (const std::exception& e) {
        refuse(response, 400, e.what());
    }
}

}  // namespace

Address parse_address(std::string_view text) {
    const auto bad = [&](const char* what) {
        return std::invalid_argument(fmt::format("--panel: {}, e.g. {}, got '{}'", what, kDefaultAddress, text));
    };
    const std::size_t colon = text.rfind(':');
    if (colon == std::string_view::npos) throw bad("expected ADDRESS:PORT");
    Address address{.host = std::string(text.substr(0, colon)), .port = settings::number_in<int>(text.substr(colon + 1)).value_or(-1)};
    if (address.host.size() > 2 && address.host.front() == '[' && address.host.back() == ']')
        address.host = address.host.substr(1, address.host.size() - 2);
    if (address.port < 0 || address.port > 65535) throw bad("expected a port from 0 to 65535");
    std::array<unsigned char, sizeof(in6_addr)> numeric{};
    const int family = address.host.find(':') == std::string::npos ? AF_INET : AF_INET6;
    if (inet_pton(family, address.host.c_str(), numeric.data()) != 1) throw bad("expected a numeric address of this computer");
    if (numeric == std::array<unsigned char, sizeof(in6_addr)>{}) throw bad("every interface is too many; expected the address of one");
    return address;
}

std::string Query::text(const std::string& key) const {
    const auto found = values_.find(key);
    return found == values_.end() ? std::string() : found->second;
}

double Query::number(const std::string& key) const {
    const std::string value = text(key);
    const auto number = settings::number_in<double>(value);
    if (!number) throw std::invalid_argument(key + ": expected a number, got '" + value + "'");
    return *number;
}

std::int64_t Query::integer(const std::string& key) const {
    const std::string value = text(key);
    const auto number = settings::number_in<std::int64_t>(value);
    if (!number) throw std::invalid_argument(key + ": expected a whole number, got '" + value + "'");
    return *number;
}

bool is_token(std::string_view said, std::string_view token) {
    if (said.size() != token.size()) return false;
    unsigned different = 0;
    for (std::size_t i = 0; i < token.size(); ++i) different |= static_cast<unsigned>(static_cast<unsigned char>(said[i] ^ token[i]));
    return different == 0;
}

struct Server::Impl {
    Impl(ServerOptions given, LiveFeed* given_feed) : options(std::move(given)), token(random_token()), feed(given_feed) {
        http.new_task_queue = [] { return new BoundedPool; };
        http.set_socket_options([](auto socket) { set_socket(socket); });
        http.set_keep_alive_max_count(1);
        http.set_payload_max_length(kLongestBody);
        http.set_read_timeout(kPatience_s);
        http.set_write_timeout(kPatience_s);
        http.set_default_headers({{"Content-Security-Policy", kPolicy},
                                  {"X-Content-Type-Options", "nosniff"},
                                  {"Referrer-Policy", "no-referrer"},
                                  {"Cross-Origin-Resource-Policy", "same-origin"},
                                  {"Cache-Control", "no-store"}});
        port = options.address.port;
        if (port == 0)
            port = http.bind_to_any_port(options.address.host);
        else if (!http.bind_to_port(options.address.host, port))
            port = -1;
        if (port < 0)
            throw std::runtime_error(fmt::format("panel: {} is not to be had: is another panel there? give --panel another port",
                                                 authority(options.address.host, options.address.port)));
        route();
        listener = std::thread([this] { (void)http.listen_after_bind(); });
        while (!http.is_running()) std::this_thread::sleep_for(milliseconds(1));
        if (feed != nullptr) collector = std::thread([this] { collect(); });
    }
    ~Impl() {
        ending = true;
        broadcast.close();
        http.stop();
        listener.join();
        if (collector.joinable()) collector.join();
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    void collect() {
        while (!ending) {
            feed->collect([this](std::string_view event, const std::string& data) { broadcast.publish(event, data); });
            std::this_thread::sleep_for(kPixel);
        }
    }

    /// Another name for this computer is a page of somebody else's that has it (DNS rebinding).
    [[nodiscard]] bool is_host(const std::string& host) const {
        return host == authority(options.address.host, port) || host == authority("localhost", port);
    }

    [[nodiscard]] httplib::Server::HandlerResponse look(const httplib::Request& request, httplib::Response& response) const {
        const std::string host = request.get_header_value("Host");
        const std::string origin = request.get_header_value("Origin");
        if (!is_host(host))
            refuse(response, 421, "this panel is " + authority(options.address.host, port));
        else if (!origin.empty() && origin != "http://" + host)
            refuse(response, 403, "asked by a page of somebody else");
        else if (request.has_header("Transfer-Encoding"))  // its length is not known beforehand
            refuse(response, 411, "a body needs its Content-Length");
        else if (request.method != "GET" && request.method != "POST")
            refuse(response, 405, "GET or POST");
        else
            return httplib::Server::HandlerResponse::Unhandled;
        return httplib::Server::HandlerResponse::Handled;
    }

    void serve_text(const std::string& path, const std::string& text, const char* type) {
        http.Get(path, [text, type](const httplib::Request&, httplib::Response& response) { response.set_content(text, type); });
    }
    void serve_file(const std::string& path, const std::filesystem::path& file, const char* type) {
        std::ifstream in(file, std::ios::binary);
        if (in) serve_text(path, std::string(std::istreambuf_iterator<char>(in), {}), type);
    }

    void route() {
        http.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) { return look(request, response); });
        serve_text("/", kIndexHtml, "text/html; charset=utf-8");
        serve_text("/panel.css", kPanelCss, "text/css; charset=utf-8");
        serve_text("/charts.js", kChartsJs, "text/javascript; charset=utf-8");
        serve_text("/panel.js", kPanelJs, "text/javascript; charset=utf-8");
        serve_file("/dygraph.js", options.charts / "dygraph.min.js", "text/javascript; charset=utf-8");
        serve_file("/dygraph.css", options.charts / "dygraph.min.css", "text/css; charset=utf-8");
        serve_file("/synchronizer.js", options.charts / "extras" / "synchronizer.js", "text/javascript; charset=utf-8");
        std::vector<std::string> names;
        for (const auto& [name, handler] : options.changes) names.push_back(name);
        serve_text("/api/about", to_json(options.about, names), "application/json");
        http.Get("/events", [this](const httplib::Request&, httplib::Response& response) { show(response); });
        // Structured bindings cannot be captured everywhere.
        for (const auto& read : options.reads)
            http.Get("/api/" + read.first,
                     [&read](const httplib::Request& request, httplib::Response& response) { answer(read.second, request, response); });
        for (const auto& change : options.changes)
            http.Post("/api/" + change.first, [this, &change](const httplib::Request& request, httplib::Response& response) {
                if (is_token(request.get_header_value("X-Panel-Token"), token)) return answer(change.second, request, response);
                refuse(response, 401, "only with the token that the program printed when it started");
            });
    }

    void show(httplib::Response& response) {
        struct Viewer {
            explicit Viewer(std::atomic<int>& all) : count(all) { number = ++count; }
            ~Viewer() { --count; }
            Viewer(const Viewer&) = delete;
            Viewer& operator=(const Viewer&) = delete;
            std::atomic<int>& count;
            int number;
            Broadcast::Place place;
        };
        const auto viewer = std::make_shared<Viewer>(viewers);
        if (viewer->number > kViewers) return refuse(response, 503, fmt::format("{} look already; that is as many as may", kViewers));
        response.set_chunked_content_provider("text/event-stream", [this, viewer](std::size_t, httplib::DataSink& sink) {
            const auto text = broadcast.take(viewer->place, milliseconds(500));
            return text && sink.write(text->data(), text->size());
        });
    }

    ServerOptions options;
    std::string token;
    LiveFeed* feed;
    int port = 0;
    Broadcast broadcast;
    std::atomic<int> viewers{0};
    std::atomic<bool> ending{false};
    httplib::Server http;
    std::thread listener, collector;
};

Server::Server(ServerOptions options, LiveFeed* feed) : impl_(std::make_unique<Impl>(std::move(options), feed)) {}
Server::~Server() = default;

int Server::port() const {
    return impl_->port;
}
const std::string& Server::token() const {
    return impl_->token;
}
int Server::viewers() const {
    return impl_->viewers;
}

std::string Server::greeting() const {
    const std::string page = "http://" + authority(impl_->options.address.host, impl_->port) + "/";
    if (impl_->options.changes.empty()) return "panel: " + page;
    return fmt::format("panel: {0}, to change something: {0}#token={1}", page, impl_->token);
}

}  // namespace rig::panel
