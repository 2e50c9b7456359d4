#include "rig_bridge/modbus/client.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "rig_bridge/modbus/backoff.hpp"
#include "rig_bridge/modbus/modbus_context.hpp"
#include "rig_bridge/modbus/plc_connection.hpp"
#include "rig_bridge/rig/lockstep_turn.hpp"
#include "rig_bridge/rig/register_blocks.hpp"

namespace rig::modbus {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr int kWatchdogsPerTimeout = 5;

double age_s(ClockTime since, ClockTime now) {
    return std::chrono::duration<double>(now - since).count();
}

std::vector<Field> written_together(const RegisterMap& map) {
    std::vector<Field> fields;
    for (std::size_t i = 0; i < kCommandedCount; ++i) {
        const auto q = static_cast<Commanded>(i);
        if (q != Commanded::bridge_watchdog && q != Commanded::commit) fields.push_back(map.commanded[i]);
    }
    return fields;
}

}  // namespace

std::string_view name(LinkState state) {
    constexpr std::array<std::string_view, 4> kNames{"connecting", "connected", "lost", "other map version"};
    return kNames[static_cast<std::size_t>(state)];
}

class ModbusClient::Impl {
  public:
    Impl(RegisterMap map, const PlcAddress& address, std::function<ClockTime()> now, Polling polling, std::unique_ptr<PlcLine> line)
        : map_(std::move(map)),
          now_(std::move(now)),
          connection_(map_, address, line ? std::move(line) : libmodbus_line(map_, address)),
          backoff_(map_.link.backoff_min, map_.link.backoff_max),
          input_blocks_(blocks_of(map_.measured, kMaxRead)),
          command_blocks_(blocks_of(written_together(map_), kMaxWrite)),
          inputs_(map_.measured, map_.word_order),
          commands_(map_) {
        const bool ambiguous = std::any_of(input_blocks_.begin(), input_blocks_.end(), [](const Block& block) { return block.count == 1; });
        if (std::holds_alternative<SerialDevice>(address) && ambiguous)
            throw std::invalid_argument(to_string(address) +
                                        ": a serial line needs input registers in groups of two or more, so that a "
                                        "late answer cannot be taken for that of the map version");
        shown_.values.fill(std::numeric_limits<double>::quiet_NaN());
        if (polling == Polling::own_thread) thread_ = std::thread([this] { run(); });
    }
    ~Impl() {
        stop_.raise();
        if (thread_.joinable())
            thread_.join();
        else if (connection_.is_open() && map_.bridge_turn)
            static_cast<void>(send_turn(kNoTurns));
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    void command(const CommandedValues& wanted) {
        const ClockTime now = now_();
        const std::lock_guard lock(mutex_);
        commands_.want(wanted, now);
        user_at_ = now;
    }

    void alive() {
        const ClockTime now = now_();
        const std::lock_guard lock(mutex_);
        user_at_ = now;
    }

    [[nodiscard]] Snapshot snapshot() const {
        const ClockTime now = now_();
        const std::lock_guard lock(mutex_);
        Snapshot shown = shown_;
        for (std::size_t i = 0; i < kMeasuredCount; ++i)
            shown.age_s[i] = shown.quality[i] == ValueQuality::never ? kNever : age_s(shown.read_at[i], now);
        shown.plc_watchdog_age_s = plc_seen_running_ ? age_s(plc_moved_at_, now) : kNever;
        shown.commit = commands_.commit();
        shown.command = commands_.state();
        shown.pending_s = commands_.pending_s(now);
        shown.command_error = commands_.error();
        shown.foreign_commands = commands_.foreign_commands();
        shown.foreign_commit = commands_.foreign_commit();
        return shown;
    }

    void exchange() {
        if (const std::optional<LinkFailure> failed = connection_.is_open() ? cycle() : connect()) lose(*failed);
    }

    void read_all() {
        std::optional<LinkFailure> failed = connection_.is_open() ? std::nullopt : connect();
        if (!failed && connection_.is_open()) failed = poll();
        if (failed) lose(*failed);
    }

    void write_turn(std::uint16_t number) {
        if (!connection_.is_open()) return;
        std::optional<LinkFailure> failed = write_due();
        if (!failed) failed = send_turn(number);
        if (failed) lose(*failed);
    }

  private:
    using Failed = std::optional<LinkFailure>;

    Failed send_turn(std::uint16_t number) {
        const std::array word{number};
        count_request();
        return connection_.write(map_.bridge_turn.value().address, word);
    }

    void run() {
        auto next = std::chrono::steady_clock::now();
        while (true) {
            const bool polling = connection_.is_open();
            exchange();
            std::chrono::nanoseconds pause{0};
            if (!connection_.is_open()) {
                pause = backoff_.next();
            } else if (polling) {
                backoff_.reset();
                const auto now = std::chrono::steady_clock::now();
                next = std::max(next + map_.link.poll, now);
                pause = next - now;
            }
            if (stop_.wait_for(pause)) return;
        }
    }

    void lose(const LinkFailure& failure) {
        connection_.close();
        const std::lock_guard lock(mutex_);
        if (shown_.link == LinkState::connected || shown_.link == LinkState::map_rejected) shown_.link = LinkState::lost;
        shown_.error = failure.text;
        plc_seen_running_ = false;
        auto& counters = shown_.counters;
        if (failure.kind == LinkFailure::Kind::timeout) ++counters.timeouts;
        if (failure.kind == LinkFailure::Kind::exception) ++counters.exceptions;
        if (failure.kind == LinkFailure::Kind::other) ++counters.errors;
    }

    /// Reads and writes nothing else before the PLC has reported the map's version.
    Failed connect() {
        if (auto failed = connection_.open()) {
            const std::lock_guard lock(mutex_);
            ++shown_.counters.failed_connects;
            return failed;
        }
        std::array<std::uint16_t, 1> version{};
        count_request();
        if (auto failed = connection_.read_inputs(map_.field(Measured::map_version).address, version)) return failed;
        if (reject_other_map(version[0])) return std::nullopt;
        std::array<std::uint16_t, 1> commit{};
        count_request();
        if (auto failed = connection_.read_holdings(map_.field(Commanded::commit).address, commit)) return failed;
        count_request();
        std::array<std::uint16_t, 1> watchdog{};
        if (auto failed = connection_.read_holdings(map_.field(Commanded::bridge_watchdog).address, watchdog)) return failed;
        watchdog_ = watchdog[0];
        unsupervised();
        const ClockTime now = now_();
        const std::lock_guard lock(mutex_);
        plc_seen_running_ = false;
        plc_watchdog_.reset();
        commands_.reconnected(commit[0], now);
        shown_.link = LinkState::connected;
        ++shown_.counters.connects;
        return std::nullopt;
    }

    /// True, and the link closed, for another version than the map's.
    bool reject_other_map(double version) {
        if (version == map_.version) return false;
        connection_.close();
        const std::lock_guard lock(mutex_);
        shown_.link = LinkState::map_rejected;
        shown_.error = "the PLC has version " + std::to_string(static_cast<int>(version)) + " of the register map, the bridge's is " +
                       std::to_string(map_.version) + ": nothing is read or written";
        return true;
    }

    Failed cycle() {
        if (auto failed = poll()) return failed;
        return connection_.is_open() ? write_due() : std::nullopt;
    }

    Failed write_due() {
        if (auto failed = move_watchdog()) return failed;
        return send_command();
    }

    Failed poll() {
        std::array<ClockTime, kMeasuredCount> read_at{};
        for (const Block& block : input_blocks_) {
            const ClockTime asked = now_();
            count_request();
            if (auto failed = connection_.read_inputs(block.address, inputs_.words(block.address, block.count))) return failed;
            for (std::size_t i = 0; i < kMeasuredCount; ++i) {
                const int offset = map_.measured[i].address - block.address;
                if (offset >= 0 && offset < block.count) read_at[i] = asked;
            }
        }
        if (reject_other_map(read(map_, inputs_, Measured::map_version).value)) return std::nullopt;
        const std::lock_guard lock(mutex_);
        for (std::size_t i = 0; i < kMeasuredCount; ++i) {
            const Reading reading = read(map_, inputs_, static_cast<Measured>(i));
            shown_.values[i] = reading.value;
            shown_.quality[i] = reading.quality;
        }
        shown_.read_at = read_at;
        ++shown_.counters.polls;
        look_at_plc();
        return std::nullopt;
    }

    /// Requires the mutex.
    void look_at_plc() {
        const double watchdog = at(shown_.values, Measured::plc_watchdog);
        const auto applied = static_cast<std::uint16_t>(at(shown_.values, Measured::applied_commit));
        const auto rejected = static_cast<std::uint16_t>(at(shown_.values, Measured::rejected_commit));
        commands_.seen(applied, rejected, shown_.read_at[static_cast<std::size_t>(Measured::applied_commit)]);
        if (plc_watchdog_ && *plc_watchdog_ != watchdog) {
            plc_seen_running_ = true;
            plc_moved_at_ = shown_.read_at[static_cast<std::size_t>(Measured::plc_watchdog)];
        }
        plc_watchdog_ = watchdog;
        if (!watchdog_at_) return;
        // This is the first reading after our watchdog counted; when the PLC's own has counted once more, the PLC has seen ours.
        if (!plc_watchdog_before_) plc_watchdog_before_ = watchdog;
        supervised_ = supervised_ || *plc_watchdog_before_ != watchdog;
    }

    void unsupervised() {
        watchdog_at_.reset();
        plc_watchdog_before_.reset();
        supervised_ = false;
    }

    Failed move_watchdog() {
        const ClockTime now = now_();
        {
            const std::lock_guard lock(mutex_);
            if (!user_at_ || now - *user_at_ > map_.link.user_timeout) {
                unsupervised();
                return std::nullopt;
            }
        }
        if (watchdog_at_ && now - *watchdog_at_ < map_.bridge_timeout / kWatchdogsPerTimeout) return std::nullopt;
        ++watchdog_;
        const std::array word{watchdog_};
        count_request();
        if (auto failed = connection_.write(map_.field(Commanded::bridge_watchdog).address, word)) return failed;
        watchdog_at_ = now;
        return std::nullopt;
    }

    /// Only if the PLC runs and has seen our watchdog count: it rejects commands of a bridge that it takes for dead.
    Failed send_command() {
        std::optional<RegisterImage> image;
        {
            const std::lock_guard lock(mutex_);
            if (supervised_) image = commands_.due();
        }
        if (!image) return std::nullopt;
        const Field& commit = map_.field(Commanded::commit);
        std::array<std::uint16_t, 1> held{};
        count_request();
        if (auto failed = connection_.read_holdings(commit.address, held)) return failed;
        {
            const std::lock_guard lock(mutex_);
            commands_.register_holds(held[0]);
        }
        for (const Block& block : command_blocks_) {
            count_request();
            if (auto failed = connection_.write(block.address, image->words(block.address, block.count))) return failed;
        }
        {
            const std::lock_guard lock(mutex_);
            commands_.sending(*image);
        }
        count_request();
        return connection_.write(commit.address, image->words(commit.address, 1));
    }

    void count_request() {
        const std::lock_guard lock(mutex_);
        ++shown_.counters.requests;
    }

    // Used only by the client's thread.
    const RegisterMap map_;
    const std::function<ClockTime()> now_;
    PlcConnection connection_;
    Backoff backoff_;
    const std::vector<Block> input_blocks_;
    const std::vector<Block> command_blocks_;
    RegisterImage inputs_;
    std::uint16_t watchdog_ = 0;
    std::optional<ClockTime> watchdog_at_;  // last count; none: none since the link was opened or the user returned
    std::optional<double> plc_watchdog_before_;
    bool supervised_ = false;  // the PLC has seen our watchdog count

    StopSignal stop_;
    mutable std::mutex mutex_;  // guards what follows; never held while waiting for the PLC
    Snapshot shown_;
    CommandTracker commands_;
    std::optional<ClockTime> user_at_;
    bool plc_seen_running_ = false;  // since the link was opened
    std::optional<double> plc_watchdog_;
    ClockTime plc_moved_at_{};

    std::thread thread_;
};

ModbusClient::ModbusClient(RegisterMap map, const PlcAddress& address, std::function<ClockTime()> now, Polling polling, std::unique_ptr<PlcLine> line)
    : impl_(std::make_unique<Impl>(std::move(map), address, std::move(now), polling, std::move(line))) {}
ModbusClient::~ModbusClient() = default;
void ModbusClient::command(const CommandedValues& wanted) {
    impl_->command(wanted);
}
void ModbusClient::alive() {
    impl_->alive();
}
void ModbusClient::exchange() {
    impl_->exchange();
}
void ModbusClient::read_all() {
    impl_->read_all();
}
void ModbusClient::write_turn(std::uint16_t number) {
    impl_->write_turn(number);
}
Snapshot ModbusClient::snapshot() const {
    return impl_->snapshot();
}

}  // namespace rig::modbus
