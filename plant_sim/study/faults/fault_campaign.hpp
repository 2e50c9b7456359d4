/// Runs of the fault campaign: the stop in one process, with real frames, the real controller and the fault between them; and the runs of a plan on
/// all cores.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/can/layout.hpp"
#include "firmware/control/config.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "plant_sim/model/rig.hpp"
#include "plant_sim/study/faults/catalogue.hpp"
#include "plant_sim/study/faults/judge.hpp"
#include "plant_sim/study/in_process.hpp"
#include "plant_sim/study/rig_session.hpp"

namespace faults {

/// Part of a stop in which the fault begins.
enum class StopPart : std::uint8_t {
    self_test,   ///< before the controller is armed
    approach,    ///< armed, in the air
    touchdown,   ///< the wheel spins up
    rolling,     ///< the wheel rolls freely
    build_up,    ///< 0.3 s from brake-on
    fast,        ///< braking, 90 to 50 % of the speed at brake-on
    slow,        ///< braking, 50 to 15 %
    drop_out,    ///< below the drop-out speed
    standstill,  ///< held, then released
};
inline constexpr std::array<std::string_view, 9> kPhaseNames{"self_test", "approach", "touchdown", "rolling",   "build_up",
                                                             "fast",      "slow",     "drop_out",  "standstill"};
[[nodiscard]] constexpr std::string_view name(StopPart phase) {
    return kPhaseNames[static_cast<std::size_t>(phase)];
}

struct Surface {
    std::string name;
    rig::RigParameters rig;
};

/// Definition of one run.
struct Case {
    std::size_t number = 0;
    Fault fault;
    StopPart phase{};
    double at = 0.0;  ///< 0 to 1: point of the part at which it begins
    std::size_t surface = 0;
    std::size_t repetition = 0;
    std::uint64_t sensor_seed = 0;  ///< the same for every fault of one surface and repetition
    std::uint64_t fault_seed = 0;   ///< of the fault's own randomness
};

/// The campaign as a list of numbered runs: each fault of the catalogue in each part of a stop on each surface, `repetitions` times. Number and seed
/// determine a run completely, so that any run can be repeated alone.
struct FaultPlan {
    std::vector<Surface> surfaces;
    antiskid::control::Config controller;
    antiskid::can::Layout layout;
    study::ManeuverPlan maneuver;
    double drop_out_mps = 0.0;
    std::size_t repetitions = 0;
    std::uint64_t seed = 0;
    std::string config_hash;
    std::string version;

    [[nodiscard]] std::size_t runs() const { return catalogue().size() * kPhaseNames.size() * surfaces.size() * repetitions; }
    /// `number` must be below runs().
    [[nodiscard]] Case at(std::size_t number) const;
    [[nodiscard]] study::SessionOptions session(const Case& c) const;
};

struct FaultPlanOptions {
    std::filesystem::path config = settings::config_directory();
    std::string maneuver = "light";
    std::vector<std::string> surfaces{"dry_asphalt", "wet_asphalt", "snow", "ice"};
    std::size_t repetitions = 5;
    std::uint64_t seed = 1;
};

/// Throws settings::Error naming file, line and key.
[[nodiscard]] FaultPlan load_plan(const FaultPlanOptions& options);

/// Detects the instant at which the fault of a case begins.
class FaultStart {
  public:
    FaultStart(const Case& c, double drop_out_mps) : phase_(c.phase), at_(c.at), drop_out_mps_(drop_out_mps) {}
    /// Call once a period; returns whether it has begun.
    [[nodiscard]] bool reached(const study::RigSession& session);

  private:
    [[nodiscard]] bool now(const study::RigSession& session);

    StopPart phase_;
    double at_;
    double drop_out_mps_;
    double stood_at_s_ = -1.0;
    bool reached_ = false;
};

/// The same stop without a fault. run_fault_free() throws std::runtime_error if it names faults or does not come to rest, since no comparison
/// would be possible.
struct FaultFree {
    double distance_m = 0.0;  ///< from brake-on to standstill
    double lasts_s = 0.0;     ///< from the start of the run to its end
    antiskid::control::FaultSet named;
};
[[nodiscard]] FaultFree run_fault_free(const FaultPlan& plan, const Case& c);

struct Result {
    Judgement verdict;
    double begun_s = -1.0;  ///< time at which the fault began; negative: the stop ended before
    double begun_mps = 0.0;
};
/// State after a period of a run.
struct Period {
    const study::RigSession& session;
    const antiskid::can::ControllerView& view;  ///< the rig's view of the controller
    double driver_mA;                           ///< current commanded at the valve's driver
    const antiskid::control::Sensors* given;    ///< inputs of the controller; null: it missed the period
    const antiskid::control::Command& command;  ///< the controller's answer
    bool begun;                                 ///< whether the fault has begun
};
using PeriodObserver = std::function<void(const Period&)>;
/// `sound`: the fault-free stop of `c`. `on_period` may be empty.
[[nodiscard]] Result run_one(const FaultPlan& plan, const Case& c, const FaultFree& sound, const PeriodObserver& on_period = {});

struct JudgedRun {
    Case run;
    Result result;
};

struct CampaignOptions {
    unsigned threads = 1;                              ///< at least 1; results do not depend on it
    const std::atomic<bool>* stop = nullptr;           ///< once true, runs that have begun are finished and no others start
    std::function<void(std::size_t done)> progress{};  ///< called by any thread, one at a time
};

/// Runs `numbers` of the plan; returns the finished ones in the order given. Throws as run_fault_free.
[[nodiscard]] std::vector<JudgedRun> run_campaign(const FaultPlan& plan, std::span<const std::size_t> numbers, const CampaignOptions& options);

}  // namespace faults
