/// An aircraft of a fleet: brakes that wear by a physical law of the wear arena, which its owner is not told, tyres whose lives scatter, and what
/// inspections with errors tell of both. Landings by the table of surfaces, without a plant.
#pragma once

#include <cstdint>
#include <vector>

#include "plant_sim/study/regulation/bound.hpp"
#include "plant_sim/study/regulation/mean_share.hpp"
#include "plant_sim/wear/rival_laws.hpp"
#include "rig_bridge/wear/life_readings.hpp"
#include "rig_bridge/wear/regulation_config.hpp"

namespace regulation {

/// What the removal records of worn-out brakes say: means.
struct PastBrakes {
    double life_J = 0.0;
    double worn = 1.0;  ///< of the lining, when friction reached its limit
};

struct AircraftKind {
    std::vector<double> landing_J;  ///< energies of landings, all equally probable
    wear::arena::Law law{};
    wear::arena::Settings brakes;  ///< limit, expected life and scatter
    PastBrakes past;
    double tyre_life_J = 0.0;     ///< mean
    wear::Deviations deviations;  ///< of the tyres' lives, which are lognormal, and of readings; that of the brakes' lives is only believed
    int inspection_landings = 1;  ///< landings between two readings of lining and tread, above 0

    [[nodiscard]] double mean_landing_J() const;
};

/// `count` brakes from new to worn out, on the aircraft's landings, with the mean energy of `kind.brakes`.
[[nodiscard]] PastBrakes past_brakes(const AircraftKind& kind, std::uint64_t seed, int count);

class Aircraft {
  public:
    /// In service: brake and tyre are worn by shares of their lives that are uniform from 0 to 1. The same seed gives the same landings, brakes and
    /// tyres, one after the other. `kind` must outlive it.
    Aircraft(const AircraftKind& kind, std::uint64_t seed);

    /// One landing with the references of `choice`; an inspection after it when one is due.
    void land(const Choice& choice);
    /// The limit is noticed when it is reached, not before.
    [[nodiscard]] bool brake_worn_out() const;
    [[nodiscard]] bool tyre_worn_out() const { return tyre_.taken_J >= tyre_.life_J; }
    /// Energies left as the owner estimates them, not negative; 0 at the limit.
    [[nodiscard]] Pair left() const;
    void inspect();
    void change_brake();
    void change_tyre();

    [[nodiscard]] double brake_unworn() const;  ///< share of the brake, true: 1 new, 0 as worn as past brakes were at the limit, or more
    [[nodiscard]] double tyre_unworn() const;
    [[nodiscard]] std::int64_t landings() const { return landings_; }
    [[nodiscard]] double distance_m() const { return distance_m_; }  ///< all stops

  private:
    struct Brake {
        wear::arena::Brake part;
        wear::LifeReadings readings{1.0, 0.0, 0.0};
        int landings = 0;
        double taken_J = 0.0;
    };
    struct Tyre {
        double life_J = 0.0;
        wear::LifeReadings readings{1.0, 0.0, 0.0};
        double taken_J = 0.0;
    };
    [[nodiscard]] Brake new_brake();
    [[nodiscard]] Tyre new_tyre();
    void wear_brake(double energy_J);

    const AircraftKind* kind_;
    std::uint64_t seed_;
    wear::Generator landing_draws_, wear_draws_, reading_draws_;
    std::uint64_t brakes_ = 0, tyres_ = 0;  // had so far
    Brake brake_;
    Tyre tyre_;
    std::int64_t landings_ = 0;
    double distance_m_ = 0.0;
};

}  // namespace regulation
