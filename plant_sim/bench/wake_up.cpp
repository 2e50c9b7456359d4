#include "plant_sim/bench/wake_up.hpp"

#include <chrono>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>

#include "firmware/can/roles.hpp"
#include "firmware/can/socket_can.hpp"
#include "plant_sim/bench/child.hpp"

namespace antiskid::bench {

namespace {

using namespace std::chrono_literals;

constexpr std::chrono::seconds kPatience{30};

nlohmann::json read_json(const std::filesystem::path& path) {
    std::ifstream in(path);
    if (!in) throw std::runtime_error("cannot read " + path.string());
    return nlohmann::json::parse(in);
}

/// virtual-rig by the clock, and a socket that has seen its first frame.
class Traffic {
  public:
    Traffic(const Settings& s, const can::IdList& ids)
        : socket_(std::make_unique<can::SocketCan>(s.interface, ids.span())),
          rig_({s.virtual_rig, "--can", s.interface, "--clock", "timer", "--priority", std::to_string(s.rig_priority()), "--patience", "3600000"},
               s.log()) {
        if (!socket_->wait(kPatience)) throw std::runtime_error("virtual-rig sent nothing; see " + s.log().string());
    }

    void close_socket() { socket_.reset(); }
    [[nodiscard]] bool ends_within(std::chrono::milliseconds time) { return rig_.ends_within(time); }
    void stop() { rig_.stop(); }

  private:
    std::unique_ptr<can::SocketCan> socket_;
    Child rig_;
};

/// The controller's report.
nlohmann::json run_controller(const Settings& s, const can::IdList& ids, const std::string& clock, WakeUpRound& round) {
    Traffic traffic(s, ids);
    traffic.close_socket();
    const auto report_path = std::filesystem::path(s.json).replace_extension(".controller.json");
    Child controller({s.controller, "--can", s.interface, "--clock", clock, "--priority", std::to_string(s.priority), "--cpu", std::to_string(s.cpu),
                      "--log-level", "warning", "--json", report_path},
                     s.log());
    if (traffic.ends_within(std::chrono::seconds{s.seconds})) round.cut_short = true;
    if (controller.ends_within(0ms))
        throw std::runtime_error("antiskid-controller ended with status " + std::to_string(controller.status()) + "; see " + s.log().string());
    controller.stop();
    controller.expect_success();
    traffic.stop();
    nlohmann::json report = read_json(report_path);
    std::filesystem::remove(report_path);
    for (const nlohmann::json& fault : report.at("faults")) round.faults.push_back(fault.at("name").get<std::string>());
    return report;
}

void measure_controller(const Settings& s, const can::IdList& ids, WakeUpRound& round) {
    const nlohmann::json by_timer = run_controller(s, ids, "timer", round);
    round.controller = from_report(by_timer, "latency");
    round.edge_by_timer = from_report(by_timer, "edge_to_command");
    round.frames_received = by_timer.at("link").at("frames_received").get<std::uint64_t>();
    round.edge_by_sensors = from_report(run_controller(s, ids, "sensors", round), "edge_to_command");
}

void measure_cyclictest(const Settings& s, const can::IdList& ids, WakeUpRound& round) {
    Traffic traffic(s, ids);
    const auto result_path = std::filesystem::path(s.json).replace_extension(".cyclictest.json");
    // The histogram reaches to 20 ms.
    std::vector<std::string> words{"cyclictest",
                                   "--quiet",
                                   "--mlockall",
                                   "--interval=1000",
                                   "--histogram=20000",
                                   "--histfile=/dev/null",
                                   "--priority=" + std::to_string(s.priority),
                                   "--affinity=" + std::to_string(s.cpu),
                                   "--duration=" + std::to_string(s.seconds),
                                   "--json=" + result_path.string()};
    if (s.priority == 0) words.emplace_back("--policy=other");
    const auto cyclictest = [&] {
        try {
            return std::make_unique<Child>(words, s.log());
        } catch (const std::system_error& error) {
            if (error.code() != std::errc::no_such_file_or_directory) throw;
            throw std::runtime_error(
                "cyclictest is not installed, so there is nothing to compare the wake-up latency with: "
                "`apt-get install rt-tests`, or ./rig setup");
        }
    }();
    if (!cyclictest->ends_within(std::chrono::seconds{s.seconds} + kPatience))
        throw std::runtime_error("cyclictest did not end in time; see " + s.log().string());
    cyclictest->expect_success();
    if (traffic.ends_within(0ms)) throw std::runtime_error("virtual-rig ended before cyclictest; see " + s.log().string());
    traffic.stop();
    round.cyclictest = from_cyclictest(read_json(result_path));
    std::filesystem::remove(result_path);
}

}  // namespace

std::vector<WakeUpRound> measure_wake_up(const Settings& settings, const can::Layout& layout,
                                         const std::function<void(int, const WakeUpRound&)>& on_round) {
    const can::IdList ids = can::ids(layout, can::kToController);
    std::vector<WakeUpRound> rounds;
    for (int number = 1; number <= settings.rounds; ++number) {
        WakeUpRound round;
        measure_cyclictest(settings, ids, round);
        measure_controller(settings, ids, round);
        on_round(number, round);
        rounds.push_back(round);
    }
    return rounds;
}

}  // namespace antiskid::bench
