#include "plant_sim/study/side_by_side.hpp"

#include <array>
#include <memory>

#include "plant_sim/study/rounded_loop.hpp"
#include "plant_sim/study/session_lanes.hpp"

namespace study {

namespace {

constexpr std::size_t kLanes = SessionLanes::kLanes;

class Runner {
  public:
    Runner(const antiskid::can::Layout& layout, const NextManeuver& next, const ManeuverDone& done)
        : layout_(layout), next_(next), done_(done) {}

    void run() {
        for (std::size_t i = 0; i < kLanes; ++i) refill(i);
        while (running_ > 0) {
            for (std::size_t i = 0; i < kLanes; ++i) {
                if (loops_[i] == nullptr) continue;
                const antiskid::control::State state = loops_[i]->control().state;
                periods_[i] = {loops_[i]->current_mA(), state};
            }
            lanes_.advance(periods_);
            for (std::size_t i = 0; i < kLanes; ++i) {
                if (loops_[i] == nullptr) continue;
                if (observers_[i])
                    observers_[i](loops_[i]->session(), loops_[i]->view(), loops_[i]->current_mA());
                if (!loops_[i]->session().done()) continue;
                done_(numbers_[i], loops_[i]->result());
                loops_[i].reset();
                --running_;
                refill(i);
            }
        }
    }

  private:
    /// The next maneuver that fits into a lane; those that do not are run here and now.
    void refill(std::size_t lane) {
        lanes_.place(lane, nullptr);
        while (more_) {
            const std::optional<Maneuver> m = next_();
            if (!m) {
                more_ = false;
                return;
            }
            const std::size_t number = begun_++;
            auto loop = std::make_unique<RoundedLoop>(m->controller, layout_, m->rig, m->options);
            if (loop->session().single_steps() && !loop->session().done()) {
                loops_[lane] = std::move(loop);
                numbers_[lane] = number;
                observers_[lane] = m->on_step;
                lanes_.place(lane, &loops_[lane]->session());
                ++running_;
                return;
            }
            done_(number,
                  run_in_process(m->controller, layout_, m->rig, m->options, Link::rounded, m->on_step));
        }
    }

    SessionLanes lanes_;  // first: it is aligned for vector code
    std::array<SessionLanes::Period, kLanes> periods_{};
    std::array<std::unique_ptr<RoundedLoop>, kLanes> loops_;
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

void run_side_by_side(const antiskid::can::Layout& layout, const NextManeuver& next,
                      const ManeuverDone& done) {
    Runner(layout, next, done).run();
}

}  // namespace study
