/// A PLC for the client's tests: the real server, and a thread that scans, counts its watchdog and takes commits over.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#include "rig_bridge/modbus/server.hpp"
#include "rig_bridge/rig/register_map.hpp"

namespace stub {

using namespace std::chrono_literals;

inline rig::RegisterMap shipped_map() {
    return rig::load_register_map("config/registers.toml");
}

/// Waits until `true_now()`; false when a minute was not enough.
template <typename Condition>
[[nodiscard]] bool eventually(const Condition& true_now) {
    const auto end = std::chrono::steady_clock::now() + 60s;
    while (!true_now()) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(1ms);
    }
    return true;
}

class Plc {
  public:
    explicit Plc(const rig::RegisterMap& map, const rig::modbus::ServerOptions& options = {}) : server_(map, options), thread_([this] { run(); }) {}
    ~Plc() {
        stop_ = true;
        thread_.join();
    }
    Plc(const Plc&) = delete;
    Plc& operator=(const Plc&) = delete;

    [[nodiscard]] const rig::modbus::ModbusServer& server() const { return server_; }
    void set(rig::Measured q, double value) {
        const std::lock_guard lock(mutex_);
        rig::at(measured_, q) = value;
    }
    [[nodiscard]] rig::modbus::PlcCommands commands() const {
        const std::lock_guard lock(mutex_);
        return commands_;
    }
    /// Every commit that was seen, in order of appearance; a number twice is there twice.
    [[nodiscard]] std::vector<rig::CommandedValues> commits() const {
        const std::lock_guard lock(mutex_);
        return commits_;
    }
    /// Returns when whatever was set, and whatever has been written, has gone through a whole scan.
    void settle() const {
        const std::uint64_t goal = scans_ + 2;
        while (scans_ < goal) std::this_thread::sleep_for(1ms);
    }
    void reject(bool on) { reject_ = on; }
    void freeze(bool on) { frozen_ = on; }

  private:
    void run() {
        while (!stop_) {
            if (!frozen_) scan();
            std::this_thread::sleep_for(2ms);
        }
    }
    void scan() {
        const std::lock_guard lock(mutex_);
        auto& watchdog = rig::at(measured_, rig::Measured::plc_watchdog);
        watchdog = watchdog >= 65535.0 ? 0.0 : watchdog + 1.0;
        commands_ = server_.exchange(measured_);
        ++scans_;
        const double commit = rig::at(commands_.commanded, rig::Commanded::commit);
        if (commit == commit_) return;
        commit_ = commit;
        commits_.push_back(commands_.commanded);
        rig::at(measured_, reject_ ? rig::Measured::rejected_commit : rig::Measured::applied_commit) = commit;
    }

    rig::modbus::ModbusServer server_;
    mutable std::mutex mutex_;
    rig::MeasuredValues measured_{};
    rig::modbus::PlcCommands commands_;
    std::vector<rig::CommandedValues> commits_;
    double commit_ = 0.0;
    std::atomic<std::uint64_t> scans_{0};
    std::atomic<bool> stop_{false}, reject_{false}, frozen_{false};
    std::thread thread_;
};

}  // namespace stub
