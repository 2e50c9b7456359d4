#include "plant_sim/study/faults/fault_campaign.hpp"

#include <mutex>
#include <optional>

#include "firmware/host/controller_config.hpp"
#include "firmware/host/layout_files.hpp"
#include "firmware/host/settings/hash.hpp"
#include "rig_bridge/rig/load_rig.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace faults {

namespace {

/// Fault-free stops by surface and repetition, each run once.
class FaultFreeStops {
  public:
    explicit FaultFreeStops(const FaultPlan& plan) : plan_(plan), known_(plan.surfaces.size() * plan.repetitions) {}

    const FaultFree& of(const Case& c) {
        Entry& entry = known_[c.surface * plan_.repetitions + c.repetition];
        const std::scoped_lock lock(entry.mutex);
        if (!entry.sound) entry.sound = run_fault_free(plan_, c);
        return *entry.sound;
    }

  private:
    struct Entry {
        std::mutex mutex;
        std::optional<FaultFree> sound;
    };
    const FaultPlan& plan_;
    std::vector<Entry> known_;
};

}  // namespace

std::vector<JudgedRun> run_campaign(const FaultPlan& plan, std::span<const std::size_t> numbers, const CampaignOptions& options) {
    std::vector<std::optional<JudgedRun>> rows(numbers.size());
    FaultFreeStops sound(plan);
    std::mutex mutex;
    std::size_t done = 0;
    const auto job = [&](std::size_t i) {
        const Case c = plan.at(numbers[i]);
        rows[i] = JudgedRun{c, run_one(plan, c, sound.of(c))};
        const std::scoped_lock lock(mutex);
        ++done;
        if (options.progress) options.progress(done);
    };
    wear::run_jobs(options.threads, numbers.size(), job, options.stop);
    std::vector<JudgedRun> finished;
    finished.reserve(done);
    for (std::optional<JudgedRun>& row : rows) {
        if (row) finished.push_back(*row);
    }
    return finished;
}

Case FaultPlan::at(std::size_t number) const {
    Case c;
    c.number = number;
    std::size_t left = number;
    c.repetition = left % repetitions;
    left /= repetitions;
    c.surface = left % surfaces.size();
    left /= surfaces.size();
    c.phase = static_cast<StopPart>(left % kPhaseNames.size());
    const Pair what = catalogue()[left / kPhaseNames.size()];

    rig::Random sensors(seed + 1000003U * (c.surface * repetitions + c.repetition));
    c.sensor_seed = sensors.bits();
    rig::Random random(rig::Random(seed).bits() ^ number);
    c.fault = draw(what, random);
    c.at = random.uniform();
    c.fault_seed = random.bits();
    return c;
}

study::SessionOptions FaultPlan::session(const Case& c) const {
    study::SessionOptions session;
    session.plan = maneuver;
    session.period_s = static_cast<double>(controller.period_s);
    session.drop_out_mps = drop_out_mps;
    session.seed = c.sensor_seed;
    return session;
}

FaultPlan load_plan(const FaultPlanOptions& options) {
    const auto controller = options.config / "controller.toml";
    const antiskid::LayoutFiles layout(options.config);
    FaultPlan plan;
    plan.controller = antiskid::load_controller_config(controller);
    plan.layout = layout.load(antiskid::required_range(plan.controller));
    plan.repetitions = options.repetitions;
    plan.seed = options.seed;
    plan.version = ANTISKID_VERSION;
    std::vector<std::filesystem::path> files;
    for (const std::string& surface : options.surfaces) {
        rig::ManeuverChoice choice;
        choice.maneuver = options.maneuver;
        choice.surface = surface;
        const rig::LoadedRig loaded = rig::load_rig(options.config, choice);
        plan.surfaces.push_back({surface, loaded.rig});
        plan.maneuver.demand_Pa = loaded.full_pressure_Pa;
        plan.drop_out_mps = loaded.drop_out_mps;
        files = loaded.files;
    }
    // Long enough for a fault at standstill to act before and after the release.
    plan.maneuver.after_standstill_s = 0.6;
    plan.maneuver.release_s = 0.6;
    files.insert(files.end(), {controller, layout.dbc, layout.binding});
    plan.config_hash = settings::hash(files);
    return plan;
}

bool FaultStart::reached(const study::RigSession& session) {
    reached_ = reached_ || now(session);
    return reached_;
}

bool FaultStart::now(const study::RigSession& session) {
    const double time_s = session.rig().time_s();
    const double v = session.rig().wheel().v_mps;
    const double brake_on_mps = session.rig().parameters().brake_on_mps;
    const study::ManeuverPlan& plan = session.pilot().plan();
    const bool braking = session.pilot().phase() == study::StopPhase::braking;
    constexpr double kSelfTestBegins_s = 0.01;
    constexpr double kSpinUp_s = 0.2;
    constexpr double kBuildUp_s = 0.3;
    constexpr double kHeld_s = 0.3;
    const auto after = [&](double from_s, double lasts_s) { return time_s >= from_s + at_ * lasts_s; };
    const auto below = [&](double from, double to) { return braking && v <= brake_on_mps * (from + at_ * (to - from)); };
    switch (phase_) {
        case StopPart::self_test:
            return after(kSelfTestBegins_s, plan.arm_s - kSelfTestBegins_s);
        case StopPart::approach:
            return after(plan.arm_s, plan.touchdown_s - plan.arm_s);
        case StopPart::touchdown:
            return after(plan.touchdown_s, kSpinUp_s);
        case StopPart::rolling:
            return after(plan.touchdown_s + kSpinUp_s, plan.settle_s - kSpinUp_s);
        case StopPart::build_up:
            return after(plan.touchdown_s + plan.settle_s, kBuildUp_s);
        case StopPart::fast:
            return below(0.9, 0.5);
        case StopPart::slow:
            return below(0.5, 0.15);
        case StopPart::drop_out:
            return braking && v <= drop_out_mps_ * (1.0 - 0.8 * at_);
        case StopPart::standstill:
            if (session.pilot().phase() < study::StopPhase::standstill) return false;
            if (stood_at_s_ < 0.0) stood_at_s_ = time_s;
            return after(stood_at_s_, kHeld_s);
    }
    return false;
}

}  // namespace faults
