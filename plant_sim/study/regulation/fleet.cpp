#include "plant_sim/study/regulation/fleet.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace regulation {

namespace {

/// An aircraft and where it is.
struct Member {
    Aircraft aircraft;
    const Choice* choice = nullptr;  // for its landings of today
    int grounded = -1;               // day from which it has not flown; -1: it flies
    int out = -1;                    // day on which it leaves the shop; -1: it is not there
    double due = 0.0;                // days from today
};

class FleetDays {
  public:
    FleetDays(const AircraftKind& kind, const FleetRules& rules, const Economy& economy, const FleetPolicy& policy,
              std::span<const std::uint64_t> seeds)
        : rules_(rules), economy_(economy), policy_(policy) {
        if (policy.own_bay) rules_.shop.bays = static_cast<int>(seeds.size());
        members_.reserve(seeds.size());
        for (const std::uint64_t seed : seeds) members_.push_back({.aircraft = Aircraft(kind, seed)});
        count_unworn(1.0);
    }

    [[nodiscard]] FleetResult run() {
        for (today_ = 0; today_ < rules_.days; ++today_) {
            for (Member& m : members_)
                if (m.out == today_) m.grounded = m.out = -1;
            send(in_order_of_due());
            for (Member& m : members_) fly(m);
        }
        count_unworn(-1.0);
        for (const Member& m : members_) {
            result_.landings += m.aircraft.landings();
            result_.distance_m += m.aircraft.distance_m();
        }
        result_.money.visit = rules_.prices.visit * static_cast<double>(result_.visits.size());
        result_.money.ground = rules_.ground_day * result_.ground_days;
        result_.money.distance = rules_.prices.metre * result_.distance_m;
        return result_;
    }

  private:
    /// Parts count as far as they are worn: what is there at the beginning less what is left at the end.
    void count_unworn(double sign) {
        for (const Member& m : members_) {
            result_.money.brake += sign * rules_.prices.brake * m.aircraft.brake_unworn();
            result_.money.tyre += sign * rules_.prices.tyre * m.aircraft.tyre_unworn();
        }
    }

    void plan(Member& m) const {
        const Pair left = m.aircraft.left();
        m.choice = policy_.together ? &economy_.together(left, *policy_.share) : policy_.share;
        if (m.grounded >= 0)
            m.due = -(policy_.margin_days + 1.0 + today_ - m.grounded);  // before all that fly, the longest waiting first
        else if (policy_.visits == Visits::at_limit)
            m.due = std::numeric_limits<double>::infinity();
        else
            m.due = days_left(left, *m.choice);
    }

    [[nodiscard]] double days_left(const Pair& left, const Choice& choice) const {
        return economy_.landings_left(left, choice) / rules_.landings_a_day - policy_.margin_days;
    }

    /// Those outside of the shop.
    [[nodiscard]] std::vector<Member*> in_order_of_due() {
        std::vector<Member*> order;
        order.reserve(members_.size());
        for (Member& m : members_) {
            if (m.out >= 0) continue;
            plan(m);
            order.push_back(&m);
        }
        const auto earlier = [](const Member* a, const Member* b) { return a->due < b->due; };
        std::stable_sort(order.begin(), order.end(), earlier);
        if (policy_.visits == Visits::spread) {
            spread(order);
            std::stable_sort(order.begin(), order.end(), earlier);
        }
        return order;
    }

    /// Moves wear so that each aircraft lasts until its turn.
    void spread(const std::vector<Member*>& order) const {
        const std::vector<double> turns = rules_.shop.first_come(due_of(order), busy());
        for (std::size_t i = 0; i < order.size(); ++i) {
            Member& m = *order[i];
            if (m.grounded >= 0 || turns[i] <= m.due) continue;
            const Pair left = m.aircraft.left();
            m.choice = &economy_.lasting(left, *m.choice, (turns[i] + policy_.margin_days) * rules_.landings_a_day);
            m.due = days_left(left, *m.choice);
        }
    }

    [[nodiscard]] static std::vector<double> due_of(const std::vector<Member*>& order) {
        std::vector<double> due(order.size());
        std::transform(order.begin(), order.end(), due.begin(), [](const Member* m) { return m->due; });
        return due;
    }

    /// Days from today until which bays are taken.
    [[nodiscard]] std::vector<double> busy() const {
        std::vector<double> until;
        until.reserve(members_.size());
        for (const Member& m : members_)
            if (m.out >= 0) until.push_back(m.out - today_);
        return until;
    }

    void send(const std::vector<Member*>& order) {
        const std::vector<double> latest = rules_.shop.latest_starts(due_of(order));
        auto free = static_cast<std::size_t>(rules_.shop.bays) - busy().size();
        for (std::size_t i = 0; i < order.size() && free > 0; ++i) {
            if (latest[i] >= 1.0) continue;  // tomorrow is early enough
            visit(*order[i]);
            --free;
        }
    }

    void visit(Member& m) {
        Aircraft& aircraft = m.aircraft;
        aircraft.inspect();
        const Pair left = aircraft.left();
        const bool brake_first = left.brake_J / (1.0 - m.choice->mean_share) < left.tyre_J / m.choice->mean_share;
        Visit v{.aircraft = static_cast<std::size_t>(&m - members_.data()), .grounded = m.grounded >= 0 ? m.grounded : today_, .begin = today_};
        v.brake = brake_first || aircraft.brake_worn_out() || economy_.brake_worth_changing(left.brake_J);
        v.tyre = !brake_first || aircraft.tyre_worn_out() || economy_.tyre_worth_changing(left.tyre_J);
        if (v.brake) {
            result_.money.brake += rules_.prices.brake;
            aircraft.change_brake();
        }
        if (v.tyre) {
            result_.money.tyre += rules_.prices.tyre;
            aircraft.change_tyre();
        }
        result_.visits.push_back(v);
        m.grounded = v.grounded;
        m.out = today_ + rules_.shop.visit_days;
    }

    void fly(Member& m) {
        if (m.grounded >= 0) {
            result_.ground_days += 1.0;
            if (m.out < 0) result_.waiting_days += 1.0;
            return;
        }
        for (int landing = 0; landing < rules_.landings_a_day; ++landing) {
            m.aircraft.land(*m.choice);
            if (!m.aircraft.brake_worn_out() && !m.aircraft.tyre_worn_out()) continue;
            m.grounded = today_ + 1;
            result_.ground_days += static_cast<double>(rules_.landings_a_day - landing - 1) / rules_.landings_a_day;
            return;
        }
    }

    FleetRules rules_;
    const Economy& economy_;
    FleetPolicy policy_;
    std::vector<Member> members_{};
    FleetResult result_{};
    int today_ = 0;
};

}  // namespace

FleetResult run_fleet(const AircraftKind& kind, const FleetRules& rules, const Economy& economy, const FleetPolicy& policy,
                      std::span<const std::uint64_t> seeds) {
    return FleetDays(kind, rules, economy, policy, seeds).run();
}

double Economy::landings_left(const Pair& left, const Choice& choice) const {
    return std::min(left.brake_J / (1.0 - choice.mean_share), left.tyre_J / choice.mean_share) / landing_J_;
}

const Choice& Economy::together(const Pair& left, const Choice& preferred) const {
    double tyres_J = left.tyre_J;
    double before = 0.0;
    double share = tyres_J / (tyres_J + left.brake_J);
    while (share < preferred.mean_share) {
        before = share;
        tyres_J += costs_.planned.tyre_J;
        share = tyres_J / (tyres_J + left.brake_J);
    }
    return choices_->at(preferred.mean_share - before < share - preferred.mean_share ? before : share);
}

const Choice& Economy::lasting(const Pair& left, const Choice& choice, double landings) const {
    const double energy_J = landings * landing_J_;
    const double least = 1.0 - left.brake_J / energy_J, greatest = left.tyre_J / energy_J;
    if (least > greatest) return choices_->at(left.tyre_J / (left.tyre_J + left.brake_J));
    return choices_->at(std::clamp(choice.mean_share, least, greatest));
}

bool Economy::brake_worth_changing(double left_J) const {
    return left_J * costs_.brake_per_J < costs_.visit * (1.0 - left_J / costs_.planned.brake_J);
}

bool Economy::tyre_worth_changing(double left_J) const {
    return left_J * costs_.tyre_per_J < costs_.visit * (1.0 - left_J / costs_.planned.tyre_J);
}

std::vector<double> Shop::latest_starts(std::span<const double> due) const {
    std::vector<double> start(due.begin(), due.end());
    const auto together = static_cast<std::size_t>(bays);
    // With visits of equal length, the bay of visit i is the one that visit i + bays takes next.
    for (std::size_t i = start.size(); i-- > 0;)
        if (i + together < start.size()) start[i] = std::min(start[i], start[i + together] - visit_days);
    return start;
}

std::vector<double> Shop::first_come(std::span<const double> due, std::span<const double> busy) const {
    std::vector<double> free(static_cast<std::size_t>(bays), 0.0);
    std::copy(busy.begin(), busy.end(), free.begin());
    std::vector<double> start(due.begin(), due.end());
    for (double& day : start) {
        double& bay = *std::min_element(free.begin(), free.end());
        day = std::max(day, bay);
        bay = day + visit_days;
    }
    return start;
}

}  // namespace regulation
