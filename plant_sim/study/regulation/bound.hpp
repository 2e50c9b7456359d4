/// The least cost a landing that any choice of slip references could have: stochastic dynamic programming over what is left of brake and tyre,
/// with landings known in distribution only, and what a given choice loses against it.
///
/// A pair lasts until its first limit. Then the shop is visited; what is left of the other part is thrown away in the same visit, or it goes on and
/// needs a visit of its own, of which the part counts that this pair has used: whichever is less. Pairs follow pairs, so the cost a landing, g, is
/// that with which the expected cost of a pair less g for each of its landings is 0 (Howard, Dynamic Programming and Markov Processes, 1960, for
/// semi-Markov chains). Landings are alike at any time: their number is no part of the state. It is a bound for who knows what is left, where the
/// regulator estimates it, and who may move the reference by any step.
#pragma once

#include <cstddef>
#include <vector>

#include "rig_bridge/wear/regulation_config.hpp"

namespace regulation {

/// What is left of a brake and a tyre, or can be taken by them. J.
struct Pair {
    double brake_J = 0.0;
    double tyre_J = 0.0;
};

/// Prices as they count here.
struct Costs {
    double brake_per_J = 0.0;
    double tyre_per_J = 0.0;
    double visit = 0.0;
    double metre = 0.0;
    Pair planned;  ///< what brake and tyre can take from a plan's begin, expected

    /// At the first limit, with so much left of the other.
    [[nodiscard]] double at_limit(const Pair& left) const;
};
[[nodiscard]] Costs costs_of(const wear::Prices& prices, const wear::WearPlan& plan);

struct BoundProblem {
    wear::SurfaceTable table;          ///< every surface as likely as any other
    std::vector<wear::Range> allowed;  ///< on each of them
    std::vector<double> landing_J;     ///< energies of landings, each as likely as any other
    Costs costs;
    std::vector<Pair> begins;  ///< of pairs, each as likely as any other
    bool told = true;          ///< the surface is known before the reference is chosen; else one reference must serve all, within all of `allowed`
    /// Of the grid. 0: 1/400 of the greatest tyre, and the least that a landing takes of a brake, which none may be above.
    double tyre_step_J = 0.0, brake_step_J = 0.0;
};

class Bound {
  public:
    explicit Bound(BoundProblem problem);

    /// Money.
    [[nodiscard]] double per_landing() const { return per_landing_; }
    /// Landings of a pair, in the mean.
    [[nodiscard]] double landings() const { return landings_; }
    /// What `reference` on `surface` costs more, to the end of the pair, than the best there; with both left above 0. The sum over the landings of
    /// many lives over their number is how far their cost a landing lies above per_landing() (Kakade and Langford, ICML 2002, lemma 6.1).
    [[nodiscard]] double loss(const Pair& left, std::size_t surface, double reference) const;
    /// The best reference there, of the table's.
    [[nodiscard]] double best(const Pair& left, std::size_t surface) const;

  private:
    /// At one state, for each of kShares tyre shares of the landing to come, the mean of its energies.
    struct Outlook {
        std::vector<double> cost;      // of wear, and what follows
        std::vector<double> part;      // of the landing that comes before the limit
        std::vector<double> landings;  // that follow
    };
    /// What follows one state.
    struct ToCome {
        double cost = 0.0;
        double landings = 0.0;
    };
    struct Action {
        double reference, distance_m;
        std::size_t step;  // of Outlook, below its share
        double beyond;     // that step, up to the next
    };
    [[nodiscard]] Action action_of(std::size_t surface, double reference) const;
    void outlook(const Pair& left, Outlook& out) const;
    [[nodiscard]] double cost_of(const Outlook& o, const Action& action) const;
    /// The best action of `surface`; of all where one must serve all.
    [[nodiscard]] std::size_t best_of(const Outlook& o, std::size_t surface) const;
    /// Values of all nodes, and the cost a landing, on a grid up to `greatest`; begins with per_landing_.
    void settle(const Pair& greatest, double tyre_step_J);
    void sweep();
    /// Between the nodes around it.
    [[nodiscard]] ToCome to_come(const Pair& at) const;

    BoundProblem problem_;
    std::vector<std::vector<Action>> actions_;  // of each surface; where one must serve all, the same references on each
    double brake_step_J_ = 0.0, tyre_step_J_ = 0.0;
    std::size_t brake_nodes_ = 0, tyre_nodes_ = 0;
    std::vector<ToCome> nodes_;  // tyre fastest
    double per_landing_ = 0.0;
    double landings_ = 0.0;
};

/// Money a landing where nobody cares for common visits: on each surface the reference for which distance, wear and the visits that each part needs
/// for itself are cheapest.
[[nodiscard]] double cost_unshared(const BoundProblem& problem);

}  // namespace regulation
