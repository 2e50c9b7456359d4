/// The least cost per landing that any choice of slip references can have, by stochastic dynamic programming over the remaining energies of brake and
/// tyre, with landings known in distribution only; and the loss of a given choice against it.
///
/// A pair of brake and tyre lasts until the first limit. Then there is a shop visit: either the rest of the other part is discarded in the same
/// visit, or that part goes on and needs its own visit later, of which the share counts that this pair has used; the cheaper of the two counts. Pairs
/// follow each other, so that the cost per landing, g, is the one for which the expected cost of a pair minus g for each of its landings is 0
/// (Howard, Dynamic Programming and Markov Processes, 1960, for semi-Markov chains). Landings have the same distribution at any time, so that their
/// number is not part of the state. The bound knows the remaining energies, which the regulator has to estimate, and may change the reference by any
/// step.
#pragma once

#include <cstddef>
#include <vector>

#include "rig_bridge/wear/regulation_config.hpp"

namespace regulation {

/// Energies of a brake and a tyre: remaining ones, or those that they can take. J.
struct Pair {
    double brake_J = 0.0;
    double tyre_J = 0.0;
};

/// Prices in the units of the bound.
struct Costs {
    double brake_per_J = 0.0;
    double tyre_per_J = 0.0;
    double visit = 0.0;
    double metre = 0.0;
    Pair planned;  ///< expected energies that brake and tyre can take from the beginning of a plan

    /// Cost at the first limit, with `left` remaining.
    [[nodiscard]] double at_limit(const Pair& left) const;
};
[[nodiscard]] Costs costs_of(const wear::Prices& prices, const wear::WearPlan& plan);

struct BoundProblem {
    wear::SurfaceTable table;          ///< all surfaces are equally probable
    std::vector<wear::Range> allowed;  ///< on each surface
    std::vector<double> landing_J;     ///< energies of landings, all equally probable
    Costs costs;
    std::vector<Pair> begins;  ///< initial states of pairs, all equally probable
    bool told = true;  ///< whether the surface is known when the reference is chosen; otherwise one reference within all of `allowed` serves all
    /// Steps of the grid. 0: 1/400 of the greatest tyre energy, and the smallest brake energy of a landing, which is also the largest allowed step.
    double tyre_step_J = 0.0, brake_step_J = 0.0;
};

class Bound {
  public:
    explicit Bound(BoundProblem problem);

    /// Cost per landing, money.
    [[nodiscard]] double per_landing() const { return per_landing_; }
    /// Mean number of landings of a pair.
    [[nodiscard]] double landings() const { return landings_; }
    /// Additional cost of `reference` on `surface` over the best one there, to the end of the pair; both parts of `left` must be > 0. Its sum over
    /// the landings of many lives, divided by their number, is the excess of their cost per landing over per_landing() (Kakade and Langford, ICML
    /// 2002, lemma 6.1).
    [[nodiscard]] double loss(const Pair& left, std::size_t surface, double reference) const;
    /// The best of the table's references.
    [[nodiscard]] double best(const Pair& left, std::size_t surface) const;

  private:
    /// Consequences at one state for each of kShares tyre shares of the next landing, as means over its energies.
    struct Outlook {
        std::vector<double> cost;      // of wear, and of all that follows
        std::vector<double> part;      // part of the landing before the limit
        std::vector<double> landings;  // number that follow
    };
    /// Expected values from a state on.
    struct ToCome {
        double cost = 0.0;
        double landings = 0.0;
    };
    struct Action {
        double reference, distance_m;
        std::size_t step;  // index in Outlook below its share
        double beyond;     // fraction of the interval to the next index
    };
    [[nodiscard]] Action action_of(std::size_t surface, double reference) const;
    void outlook(const Pair& left, Outlook& out) const;
    [[nodiscard]] double cost_of(const Outlook& o, const Action& action) const;
    /// The best action of `surface`, or of all surfaces if one must serve all.
    [[nodiscard]] std::size_t best_of(const Outlook& o, std::size_t surface) const;
    /// Computes the values of all nodes and the cost per landing on a grid up to `greatest`; starts from per_landing_.
    void settle(const Pair& greatest, double tyre_step_J);
    void sweep();
    /// Interpolates between the surrounding nodes.
    [[nodiscard]] ToCome to_come(const Pair& at) const;

    BoundProblem problem_;
    std::vector<std::vector<Action>> actions_;  // of each surface; if one must serve all, the same references on each
    double brake_step_J_ = 0.0, tyre_step_J_ = 0.0;
    std::size_t brake_nodes_ = 0, tyre_nodes_ = 0;
    std::vector<ToCome> nodes_;  // the tyre's index varies fastest
    double per_landing_ = 0.0;
    double landings_ = 0.0;
};

/// Cost per landing, money, without common visits: on each surface the reference with the least cost of distance, wear and the separate visits of
/// each part.
[[nodiscard]] double cost_unshared(const BoundProblem& problem);

}  // namespace regulation
