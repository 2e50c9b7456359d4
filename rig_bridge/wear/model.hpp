/// A fitted wear model: the mixture and its origin.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rig_bridge/wear/conditional.hpp"
#include "rig_bridge/wear/fit.hpp"
#include "rig_bridge/wear/mixture.hpp"
#include "rig_bridge/wear/provenance.hpp"
#include "rig_bridge/wear/wear_campaign.hpp"

namespace wear {

struct Model {
    struct Data {
        std::string source;
        std::string hash;  ///< data_hash() of the campaign
        std::size_t maneuvers = 0;
        double first_c_e_J = 0.0;
        double last_c_e_J = 0.0;
        double min_friction = 0.0;
        double greatest_friction = 0.0;
        std::string origin = kUnknownOrigin;  ///< provenance.hpp
        bool operator==(const Data&) const = default;
        /// Mean energy per maneuver, J.
        [[nodiscard]] double mean_step_J() const;
    };
    struct Search {
        std::uint64_t seed = 0;
        int starts = 0;
        double tolerance = 0.0;
        double covariance_floor = 0.0;
        bool operator==(const Search&) const = default;
    };
    struct Candidate {
        std::size_t components = 0;
        double log_likelihood = 0.0;
        double bic = 0.0;
        std::optional<double> score{};  ///< order_score.hpp; none: not scored
        bool operator==(const Candidate&) const = default;
    };

    Data data;
    Search search;
    std::vector<Candidate> orders;
    Mixture mixture;

    /// Whether the energy is outside the model's data: more than one mean maneuver before the first point or after the last.
    [[nodiscard]] bool extrapolates(double c_e_J) const;

    bool operator==(const Model&) const = default;
};

/// How the model extrapolates beyond its data, in one sentence for people.
constexpr const char* kHowItExtrapolates =
    "beyond the data the components that speak at its end go on along their own straight lines, with their "
    "scatter";

[[nodiscard]] Model model_of(const Campaign& campaign, const Fit& fit, const FitSettings& settings);

/// Mean friction of the maneuver at which c_e = a (finite, J), eq. (14). Beyond the data: kHowItExtrapolates.
[[nodiscard]] Conditional friction_given_energy(const Model& model, double a_J, const ConditionalRule& rule = {});

}  // namespace wear
