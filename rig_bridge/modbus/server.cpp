#include "rig_bridge/modbus/server.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <set>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

#include "rig_bridge/modbus/modbus_context.hpp"
#include "rig_bridge/modbus/pseudo_terminal.hpp"
#include "rig_bridge/modbus/register_bank.hpp"

namespace rig::modbus {
namespace {

constexpr std::uint32_t kRtuFrame_us = 200'000;  // from a request's first byte to its last
constexpr std::size_t kRtuHeader = 1;
constexpr std::size_t kRtuChecksum = 2;
constexpr int kListenBacklog = 8;

/// One TCP connection and the bytes of its next request.
struct Peer {
    explicit Peer(int descriptor) : socket(descriptor) {}
    settings::FileDescriptor socket;
    std::array<std::uint8_t, kTcpMax> bytes{};
    std::size_t have = 0;
    bool closing = false;
    std::chrono::steady_clock::time_point asked = std::chrono::steady_clock::now();  ///< last whole request
};

class TcpListener {
  public:
    TcpListener(const std::string& address, std::uint16_t port)
        : context_(modbus_new_tcp(address.c_str(), port)), socket_(listen(context_.get(), address, port)) {
        // libmodbus waits for the response time-out before it sends some of its exceptions.
        modbus_set_response_timeout(context_.get(), 0, 1);
    }

    [[nodiscard]] int descriptor() const { return socket_.get(); }
    [[nodiscard]] modbus_t* context_for(const Peer& peer) const {
        modbus_set_socket(context_.get(), peer.socket.get());
        return context_.get();
    }
    [[nodiscard]] std::uint16_t port() const {
        sockaddr_in bound{};
        socklen_t size = sizeof bound;
        if (::getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&bound), &size) != 0) return 0;
        return ntohs(bound.sin_port);
    }

  private:
    [[nodiscard]] static int listen(modbus_t* context, const std::string& address, std::uint16_t port) {
        const std::string where = "Modbus TCP " + address + ":" + std::to_string(port) + ": ";
        in_addr numeric{};
        if (context == nullptr || ::inet_pton(AF_INET, address.c_str(), &numeric) != 1)
            throw std::runtime_error(where + "expected a numeric IPv4 address, e.g. 127.0.0.1");
        const int socket = modbus_tcp_listen(context, kListenBacklog);
        if (socket < 0) throw std::runtime_error(where + std::generic_category().message(errno));
        ::fcntl(socket, F_SETFL, O_NONBLOCK);
        return socket;
    }

    ModbusContext context_;
    settings::FileDescriptor socket_;
};

/// The clients that may connect.
class AllowedPeers {
  public:
    explicit AllowedPeers(const ServerOptions& options) : tell_(options.on_rejected) {
        for (const std::string& address : options.allow) {
            in_addr numeric{};
            if (::inet_pton(AF_INET, address.c_str(), &numeric) != 1)
                throw std::invalid_argument("Modbus TCP: allowed peer '" + address + "': expected a numeric IPv4 address, e.g. 127.0.0.1");
            allowed_.insert(numeric.s_addr);
        }
    }
    [[nodiscard]] bool admits(const sockaddr_in& peer) {
        const in_addr_t address = peer.sin_addr.s_addr;
        if (allowed_.contains(address)) return true;
        if (named_.size() < ServerOptions::kMaxNamed && named_.insert(address).second && tell_) {
            std::array<char, INET_ADDRSTRLEN> text{};
            ::inet_ntop(AF_INET, &peer.sin_addr, text.data(), text.size());
            tell_(text.data());
        }
        return false;
    }

  private:
    std::function<void(const std::string&)> tell_;
    std::set<in_addr_t> allowed_;
    std::set<in_addr_t> named_;
};

class RtuLine {
  public:
    explicit RtuLine(const RegisterMap& map)
        : context_(modbus_new_rtu(terminal_.path().c_str(), map.serial.baud, map.serial.parity, 8, map.serial.stop_bits)) {
        if (context_ == nullptr) throw std::runtime_error("Modbus RTU: " + modbus_error(errno));
        modbus_set_slave(context_.get(), map.unit_id);
        modbus_set_socket(context_.get(), terminal_.master());
        modbus_set_indication_timeout(context_.get(), 0, kRtuFrame_us);
        modbus_set_byte_timeout(context_.get(), 0, 0);  // the former holds for the whole request
        modbus_set_response_timeout(context_.get(), 0, 1);
    }

    [[nodiscard]] const PseudoTerminal& terminal() const { return terminal_; }
    [[nodiscard]] modbus_t* context() const { return context_.get(); }

  private:
    PseudoTerminal terminal_;
    ModbusContext context_;
};

}  // namespace

class ModbusServer::Impl {
  public:
    Impl(const RegisterMap& map, const ServerOptions& options)
        : bank_(map), max_(options.clients), idle_after_(options.idle), allowed_peers_(options) {
        if (options.port) {
            tcp_ = std::make_unique<TcpListener>(options.address, *options.port);
            port_ = tcp_->port();
        }
        if (options.rtu) rtu_ = std::make_unique<RtuLine>(map);
        thread_ = std::thread([this] { run(); });
    }
    ~Impl() {
        stop_.raise();
        thread_.join();
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    [[nodiscard]] std::uint16_t port() const { return port_; }
    [[nodiscard]] std::string rtu_path() const { return rtu_ ? rtu_->terminal().path() : ""; }
    PlcCommands exchange(const MeasuredValues& measured) { return bank_.exchange(measured); }
    [[nodiscard]] std::uint16_t bridge_turn() const { return bank_.bridge_turn(); }
    [[nodiscard]] ServerCounters counters() const {
        return {.requests = requests_,
                .exceptions = exceptions_,
                .broken = broken_,
                .hangs = hangs_,
                .rejected = rejected_,
                .idle = idle_,
                .clients = clients_};
    }

  private:
    void run() {
        std::vector<pollfd> events;
        while (true) {
            events.clear();
            events.push_back({stop_.descriptor(), POLLIN, 0});
            events.push_back({tcp_ ? tcp_->descriptor() : -1, POLLIN, 0});
            events.push_back({rtu_ ? rtu_->terminal().master() : -1, POLLIN, 0});
            for (const auto& peer : peers_) events.push_back({peer->socket.get(), POLLIN, 0});
            if (::poll(events.data(), events.size(), -1) < 0) continue;  // a signal
            if (events[0].revents != 0) return;
            const std::size_t peers = peers_.size();
            for (std::size_t i = 0; i < peers && !stopped_; ++i) {
                if (events[3 + i].revents != 0) serve(*peers_[i]);
            }
            if (events[2].revents != 0 && !stopped_) serve_rtu();
            if (events[1].revents != 0 && !stopped_) accept_peer();
            if (stopped_) return;
            std::erase_if(peers_, [](const auto& peer) { return peer->closing; });
            clients_ = peers_.size();
        }
    }

    void accept_peer() {
        sockaddr_in from{};
        socklen_t size = sizeof from;
        const int socket = ::accept4(tcp_->descriptor(), reinterpret_cast<sockaddr*>(&from), &size, SOCK_NONBLOCK | SOCK_CLOEXEC);
        if (socket < 0) return;
        auto peer = std::make_unique<Peer>(socket);
        if (!allowed_peers_.admits(from)) {
            ++rejected_;
            return;
        }
        const int on = 1;
        ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
        if (peers_.size() < max_ || drop_idle(peer->asked)) peers_.push_back(std::move(peer));
        clients_ = peers_.size();
    }

    bool drop_idle(std::chrono::steady_clock::time_point now) {
        const auto longest = std::min_element(peers_.begin(), peers_.end(), [](const auto& a, const auto& b) { return a->asked < b->asked; });
        if (longest == peers_.end() || now - (*longest)->asked < idle_after_) return false;
        peers_.erase(longest);
        ++idle_;
        return true;
    }

    void serve(Peer& peer) {
        const auto got = ::recv(peer.socket.get(), peer.bytes.data() + peer.have, peer.bytes.size() - peer.have, 0);
        if (got <= 0) {
            peer.closing = got == 0 || (errno != EAGAIN && errno != EINTR);
            return;
        }
        peer.have += static_cast<std::size_t>(got);
        while (!peer.closing && !stopped_) {
            const auto frame = tcp_frame(std::span(peer.bytes).first(peer.have));
            if (frame.state == FrameState::incomplete) return;
            if (frame.state == FrameState::broken) {
                ++broken_;
                peer.closing = true;
                return;
            }
            const auto adu = std::span<const std::uint8_t>(peer.bytes).first(frame.length);
            peer.closing = !answer(tcp_->context_for(peer), adu, kTcpHeader, 0, false);
            peer.asked = std::chrono::steady_clock::now();
            std::copy(peer.bytes.begin() + static_cast<std::ptrdiff_t>(frame.length), peer.bytes.begin() + static_cast<std::ptrdiff_t>(peer.have),
                      peer.bytes.begin());
            peer.have -= frame.length;
        }
    }

    void serve_rtu() {
        std::array<std::uint8_t, MODBUS_MAX_ADU_LENGTH> bytes{};
        const int length = modbus_receive(rtu_->context(), bytes.data());
        if (length == 0) {
            // A request for another unit. libmodbus would now take our next request for that unit's answer, which never comes on this line; receiving
            // once, which only waits for the response timeout, makes libmodbus forget the request.
            static_cast<void>(modbus_receive(rtu_->context(), bytes.data()));
            return;
        }
        if (length < 0) {
            ++broken_;
            rtu_->terminal().drain();
            return;
        }
        const auto adu = std::span<const std::uint8_t>(bytes).first(static_cast<std::size_t>(length));
        static_cast<void>(answer(rtu_->context(), adu, kRtuHeader, kRtuChecksum, bytes[0] == MODBUS_BROADCAST_ADDRESS));
    }

    /// False: the answer cannot be delivered, or the server is to stop.
    bool answer(modbus_t* context, std::span<const std::uint8_t> adu, std::size_t header, std::size_t checksum, bool silent) {
        ++requests_;
        if (const double hang_s = bank_.take_hang(); hang_s > 0.0) {
            ++hangs_;
            const std::chrono::duration<double> hang(hang_s);
            stopped_ = stop_.wait_for(std::chrono::duration_cast<std::chrono::nanoseconds>(hang));
            if (stopped_) return false;
        }
        const auto result = bank_.answer(context, adu, header, checksum, silent);
        if (result == RegisterBank::Answer::exception) ++exceptions_;
        return result != RegisterBank::Answer::failed;
    }

    RegisterBank bank_;
    std::size_t max_;
    std::chrono::milliseconds idle_after_;
    AllowedPeers allowed_peers_;
    StopSignal stop_;
    std::unique_ptr<TcpListener> tcp_;
    std::unique_ptr<RtuLine> rtu_;
    std::uint16_t port_ = 0;
    std::vector<std::unique_ptr<Peer>> peers_;
    bool stopped_ = false;
    std::atomic<std::uint64_t> requests_{0}, exceptions_{0}, broken_{0}, hangs_{0}, rejected_{0}, idle_{0};
    std::atomic<std::size_t> clients_{0};
    std::thread thread_;
};

ModbusServer::ModbusServer(const RegisterMap& map, const ServerOptions& options) : impl_(std::make_unique<Impl>(map, options)) {}
ModbusServer::~ModbusServer() = default;
std::uint16_t ModbusServer::port() const {
    return impl_->port();
}
std::string ModbusServer::rtu_path() const {
    return impl_->rtu_path();
}
PlcCommands ModbusServer::exchange(const MeasuredValues& measured) {
    return impl_->exchange(measured);
}
std::uint16_t ModbusServer::bridge_turn() const {
    return impl_->bridge_turn();
}
ServerCounters ModbusServer::counters() const {
    return impl_->counters();
}

}  // namespace rig::modbus
