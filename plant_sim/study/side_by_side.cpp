#include "plant_sim/study/side_by_side.hpp"

#include <array>
#include <cstddef>
#include <memory>

#include "plant_sim/model/rig.hpp"
#include "plant_sim/model/wheel_lanes.hpp"
#include "plant_sim/study/loop.hpp"

namespace plant {

/// Up to eight rigs that step together, each with its own current: valves, loads and sensors one after the other, the wheels at once in vector code.
/// The bits are those of a single rig.
class RigLanes {
  public:
    static constexpr std::size_t kLanes = plant::WheelLanes::kLanes;

    /// `rig` takes part until it is replaced or removed (nullptr); until then it must live, and its brake must not change.
    void place(std::size_t lane, plant::Rig* rig) {
        rigs_[lane] = rig;
        if (rig != nullptr) wheels_.laws.set(lane, rig->dynamics_.law());
    }
    /// One step of every rig with the constant current of its lane.
    void advance_current(const std::array<double, kLanes>& current_mA) {
        for (std::size_t i = 0; i < kLanes; ++i) {
            if (rigs_[i] == nullptr) continue;
            plant::Rig& rig = *rigs_[i];
            const plant::Rig::Step& step = under_way_[i] = rig.begin(current_mA[i], current_mA[i]);
            wheels_.inputs.set(i, {rig.state_.v_mps, rig.state_.omega_radps, step.pressure, step.load, step.h});
        }
        wheels_.turn();
        for (std::size_t i = 0; i < kLanes; ++i) {
            if (rigs_[i] == nullptr) continue;
            plant::Rig& rig = *rigs_[i];
            const plant::Rig::Step& step = under_way_[i];
            if (!rig.plain() || !rig.dynamics_.take(rig.state_, wheels_.steps[i])) rig.move(step.pressure, step.load, step.h);
            rig.end(step);
        }
    }

  private:
    std::array<plant::Rig*, kLanes> rigs_{};
    std::array<plant::Rig::Step, kLanes> under_way_{};
    plant::WheelLanes wheels_;
};

}  // namespace plant

namespace study {

/// Up to eight sessions that advance together, with their rigs in plant::RigLanes. The bits are those of a single session.
class SessionLanes {
  public:
    static constexpr std::size_t kLanes = plant::RigLanes::kLanes;

    /// Arguments of RigSession::advance.
    struct Period {
        double current_mA = 0.0;
        antiskid::control::State controller = antiskid::control::State::self_test;
    };

    /// `session`, with single_steps(), takes part until it is replaced or removed (nullptr); until then it must live and must not be moved.
    void place(std::size_t lane, RigSession* session) {
        sessions_[lane] = session;
        rigs_.place(lane, session != nullptr ? &session->rig_ : nullptr);
    }
    /// One period of every session.
    void advance(const std::array<Period, kLanes>& periods) {
        std::array<double, kLanes> current_mA{};
        for (std::size_t i = 0; i < kLanes; ++i) current_mA[i] = periods[i].current_mA;
        rigs_.advance_current(current_mA);
        for (std::size_t i = 0; i < kLanes; ++i) {
            if (sessions_[i] == nullptr) continue;
            sessions_[i]->meter_.command(periods[i].current_mA);
            sessions_[i]->measure();
            sessions_[i]->close_period(periods[i].controller);
        }
    }

  private:
    std::array<RigSession*, kLanes> sessions_{};
    plant::RigLanes rigs_;
};

namespace {

constexpr std::size_t kLanes = SessionLanes::kLanes;

class Runner {
  public:
    Runner(const antiskid::can::Layout& layout, const NextManeuver& next, const ManeuverDone& done) : layout_(layout), next_(next), done_(done) {}

    void run() {
        for (std::size_t i = 0; i < kLanes; ++i) refill(i);
        while (running_ > 0) {
            for (std::size_t i = 0; i < kLanes; ++i) {
                if (loops_[i] == nullptr) continue;
                loops_[i]->control();
                periods_[i] = {loops_[i]->link().current_mA(), loops_[i]->link().state()};
            }
            lanes_.advance(periods_);
            for (std::size_t i = 0; i < kLanes; ++i) {
                if (loops_[i] == nullptr) continue;
                if (observers_[i]) observers_[i](loops_[i]->session(), loops_[i]->link().view(), loops_[i]->link().current_mA());
                if (!loops_[i]->session().done()) continue;
                done_(numbers_[i], loops_[i]->result());
                loops_[i].reset();
                --running_;
                refill(i);
            }
        }
    }

  private:
    /// Puts the next suitable maneuver into a lane; runs unsuitable ones at once.
    void refill(std::size_t lane) {
        lanes_.place(lane, nullptr);
        while (more_) {
            const std::optional<Maneuver> m = next_();
            if (!m) {
                more_ = false;
                return;
            }
            const std::size_t number = begun_++;
            auto loop = std::make_unique<Loop<ValueLink>>(m->controller, m->rig, m->options, ValueLink(layout_, period_of(m->controller)));
            if (loop->session().single_steps() && !loop->session().done()) {
                loops_[lane] = std::move(loop);
                numbers_[lane] = number;
                observers_[lane] = m->on_step;
                lanes_.place(lane, &loops_[lane]->session());
                ++running_;
                return;
            }
            done_(number, run_in_process(m->controller, layout_, m->rig, m->options, Link::rounded, m->on_step));
        }
    }

    SessionLanes lanes_;  // first: it is aligned for vector code
    std::array<SessionLanes::Period, kLanes> periods_{};
    std::array<std::unique_ptr<Loop<ValueLink>>, kLanes> loops_;
    std::array<std::size_t, kLanes> numbers_{};
    std::array<StepObserver, kLanes> observers_;
    const antiskid::can::Layout& layout_;
    const NextManeuver& next_;
    const ManeuverDone& done_;
    std::size_t running_ = 0;
    std::size_t begun_ = 0;
    bool more_ = true;
};

}  // namespace

void run_side_by_side(const antiskid::can::Layout& layout, const NextManeuver& next, const ManeuverDone& done) {
    Runner(layout, next, done).run();
}

}  // namespace study
