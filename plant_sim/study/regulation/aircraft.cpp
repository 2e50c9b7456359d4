#include "plant_sim/study/regulation/aircraft.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace regulation {

namespace {

/// Streams of random numbers of an aircraft; its tyres have those from kTyres on.
enum Stream : std::uint64_t { kLandings, kWear, kReadings, kAges, kTyres };

/// Seeds of brakes for each aircraft: those of one and of the next differ.
constexpr std::uint64_t kBrakesEach = 4096;

bool worn_out(const AircraftKind& kind, const wear::arena::Brake& brake, int landings) {
    return landings >= wear::arena::kRunIn && brake.condition() < kind.brakes.limit;
}

std::size_t drawn_below(std::size_t count, wear::Generator& generator) {
    return std::min(count - 1, static_cast<std::size_t>(wear::uniform(generator) * static_cast<double>(count)));
}

}  // namespace

double AircraftKind::mean_landing_J() const {
    return std::accumulate(landing_J.begin(), landing_J.end(), 0.0) / static_cast<double>(landing_J.size());
}

PastBrakes past_brakes(const AircraftKind& kind, std::uint64_t seed, int count) {
    const double brake_share = kind.brakes.mean_energy_J() / kind.mean_landing_J();
    PastBrakes mean{.life_J = 0.0, .worn = 0.0};
    for (int i = 0; i < count; ++i) {
        const std::uint64_t own = seed + static_cast<std::uint64_t>(i);
        wear::Generator generator = wear::generator_of(own, kLandings);
        wear::arena::Brake brake(kind.law, kind.brakes, own);
        for (int landings = 0; !worn_out(kind, brake, landings); ++landings) {
            const double brake_J = brake_share * kind.landing_J[drawn_below(kind.landing_J.size(), generator)];
            brake.land(brake_J, generator);
            mean.life_J += brake_J / count;
        }
        mean.worn += brake.worn() / count;
    }
    return mean;
}

Aircraft::Aircraft(const AircraftKind& kind, std::uint64_t seed)
    : kind_(&kind),
      seed_(seed),
      landing_draws_(wear::generator_of(seed, kLandings)),
      wear_draws_(wear::generator_of(seed, kWear)),
      reading_draws_(wear::generator_of(seed, kReadings)),
      brake_(new_brake()),
      tyre_(new_tyre()) {
    wear::Generator ages = wear::generator_of(seed, kAges);
    tyre_.taken_J = wear::uniform(ages) * tyre_.life_J;
    const double unworn = wear::uniform(ages);
    while (brake_unworn() > unworn && !brake_worn_out()) wear_brake(kind.brakes.mean_energy_J());
    inspect();
}

Aircraft::Brake Aircraft::new_brake() {
    return {.part = wear::arena::Brake(kind_->law, kind_->brakes, seed_ * kBrakesEach + brakes_++),
            .readings = wear::LifeReadings(kind_->past.life_J, kind_->deviations.brake, kind_->deviations.inspection / kind_->past.worn)};
}

Aircraft::Tyre Aircraft::new_tyre() {
    wear::Generator generator = wear::generator_of(seed_, kTyres + tyres_++);
    return {.life_J = kind_->tyre_life_J * std::exp(kind_->deviations.tyre * wear::normal(generator)),
            .readings = wear::LifeReadings(kind_->tyre_life_J, kind_->deviations.tyre, kind_->deviations.inspection)};
}

void Aircraft::wear_brake(double energy_J) {
    brake_.part.land(energy_J, wear_draws_);
    brake_.taken_J += energy_J;
    ++brake_.landings;
}

void Aircraft::land(const Choice& choice) {
    const std::size_t surface = drawn_below(choice.tyre_share.size(), landing_draws_);
    const double energy_J = kind_->landing_J[drawn_below(kind_->landing_J.size(), landing_draws_)];
    const double tyre_J = choice.tyre_share[surface] * energy_J;
    wear_brake(energy_J - tyre_J);
    tyre_.taken_J += tyre_J;
    distance_m_ += choice.distance_m[surface];
    if (++landings_ % kind_->inspection_landings == 0) inspect();
}

bool Aircraft::brake_worn_out() const {
    return worn_out(*kind_, brake_.part, brake_.landings);
}

Pair Aircraft::left() const {
    return {.brake_J = brake_worn_out() ? 0.0 : std::max(0.0, brake_.readings.life_J() - brake_.taken_J),
            .tyre_J = tyre_worn_out() ? 0.0 : std::max(0.0, tyre_.readings.life_J() - tyre_.taken_J)};
}

void Aircraft::inspect() {
    const auto seen = [&](double worn) { return worn + kind_->deviations.inspection * wear::normal(reading_draws_); };
    brake_.readings.read(brake_.taken_J, seen(brake_.part.worn()) / kind_->past.worn);
    tyre_.readings.read(tyre_.taken_J, seen(tyre_.taken_J / tyre_.life_J));
}

void Aircraft::change_brake() {
    brake_ = new_brake();
}

void Aircraft::change_tyre() {
    tyre_ = new_tyre();
}

double Aircraft::brake_unworn() const {
    return std::clamp(1.0 - brake_.part.worn() / kind_->past.worn, 0.0, 1.0);
}

double Aircraft::tyre_unworn() const {
    return std::max(0.0, 1.0 - tyre_.taken_J / tyre_.life_J);
}

}  // namespace regulation
