#include "plant_sim/wear/rival_laws.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/host/settings/settings.hpp"

namespace wear::arena {

namespace {

/// Of the glaze under landings of wear_arena.toml: 0.3 of them add 0.12 of what is missing, 0.2 take 0.7 of what is there.
constexpr double kMeanGlaze = 0.2;

/// Streams of random numbers: lives of one seed under two laws share none.
std::uint64_t stream(Law law, std::uint64_t which) {
    return 16 * static_cast<std::uint64_t>(law) + which;
}

}  // namespace

Settings load_settings(const std::filesystem::path& file) {
    const auto document = settings::Document::load(file);
    const settings::Table seeds = document.root().table("seeds"), lives = document.root().table("lives");
    const auto seed = [&](const char* key) { return seeds.integer<std::uint64_t>(key, {.min = 0}); };
    Settings s;
    s.training = seed("training");
    s.tuning = seed("tuning");
    s.held_out = seed("held_out");
    s.limit = lives.number("limit", {.min = 0.15, .max = 0.25});
    s.life_landings = lives.number("life_landings", {.min = 50.0, .max = 5000.0});
    s.life_scatter = lives.number("life_scatter", {.min = 0.0, .max = 0.5});
    s.correlation = lives.number("correlation", {.min = -1.0, .max = 1.0});
    s.reading_every = lives.integer<std::size_t>("reading_every", {.min = 1});
    s.reading_error = lives.number("reading_error", {.min = 1e-4, .max = 0.2});
    const settings::NumbersRule three{.range = {.min = 0.01, .max = 100.0}, .count = {.min = 3, .max = 3}};
    const std::vector<double> energy_MJ = lives.numbers("energy_MJ", three), share = lives.numbers("share", three);
    constexpr std::array kKinds{"light", "medium", "heavy"};
    for (std::size_t i = 0; i < kKinds.size(); ++i) s.mix.push_back({kKinds.at(i), share[i], energy_MJ[i] * 1e6, 0.03e6 * energy_MJ[i]});
    if (std::abs(share[0] + share[1] + share[2] - 1.0) > 1e-9) lives.fail("share", "must add up to 1");
    return s;
}

double Settings::mean_energy_J() const {
    double sum = 0.0;
    for (const LandingKind& k : mix) sum += k.share * k.energy_J;
    return sum;
}

double landing_energy_J(const Settings& settings, Generator& generator) {
    double left = uniform(generator);
    std::size_t i = 0;
    for (; i + 1 < settings.mix.size() && left >= settings.mix[i].share; ++i) left -= settings.mix[i].share;
    return settings.mix[i].energy_J + settings.mix[i].deviation_J * normal(generator);
}

Brake::Brake(Law law, const Settings& settings, std::uint64_t seed) : law_(law), mean_J_(settings.mean_energy_J()) {
    Generator generator = generator_of(seed, stream(law, 1));
    const double z = normal(generator);
    const double own = normal(generator);
    life_J_ = settings.life_landings * mean_J_ * std::exp(settings.life_scatter * z);
    level_ = 0.006 * (settings.correlation * z + std::sqrt(1.0 - settings.correlation * settings.correlation) * own);
}

Brake Brake::with(double life_J, double level) const {
    Brake out = *this;
    out.worn_ *= life_J_ / life_J;
    out.life_J_ = life_J;
    out.level_ = level;
    return out;
}

double Brake::condition() const {
    double friction = 0.0;
    switch (law_) {
        case Law::ostermeyer:
            friction = 0.16 + 0.15 * film_ * (1.0 - 0.9 * worn_ * worn_);
            break;
        case Law::oxidation:
            friction = 0.31 - 0.11 * std::sqrt(worn_);
            break;
        default:
            friction = 0.27 + 0.03 * std::exp(-15.0 * worn_) - 0.03 * worn_ - 0.04 * std::pow(worn_, 6.0);
    }
    return (friction + level_) * (1.0 - lost_);
}

double Brake::expected() const {
    const double fade = law_ == Law::ostermeyer ? 0.004 : 0.008;
    const double glaze = law_ == Law::glazing ? 0.03 * (film_ - kMeanGlaze) : 0.0;
    return (condition() - fade * (heat_ - 1.0) - glaze) * misread_;
}

double Brake::land(double energy_J, Generator& generator) {
    const double size = energy_J / mean_J_;
    const double friction = expected() + kFresh * normal(generator);
    const double step = energy_J / life_J_;
    heat_ += 0.4 * (size - heat_);
    switch (law_) {
        case Law::oxidation:
            worn_ += step * std::exp(1.5 * (1.0 - 1.0 / std::max(0.3, heat_)));
            break;
        default:
            worn_ += step * (1.0 + 0.3 * (heat_ - 1.0));
    }
    if (law_ == Law::ostermeyer) film_ += size * (0.15 * (1.0 - film_) - 0.01 * film_ * heat_);
    if (law_ == Law::glazing) film_ = size < 0.8 ? film_ + 0.12 * (1.0 - film_) : (size > 1.3 ? 0.3 * film_ : film_);
    if (law_ == Law::step_faults && uniform(generator) < 2.0 * step) lost_ += 0.03 + 0.05 * uniform(generator);
    if (law_ == Law::sensor_drift) misread_ += 0.004 * normal(generator);
    return friction;
}

Life live(Law law, const Settings& settings, std::uint64_t seed) {
    Brake brake(law, settings, seed);
    Generator generator = generator_of(seed, stream(law, 2)), readings = generator_of(seed, stream(law, 3));
    Life life;
    life.campaign.source = kLawNames.at(static_cast<std::size_t>(law));
    double c_e_J = 0.0;
    while (life.before.size() < std::size_t{kRunIn} || brake.condition() >= settings.limit) {
        life.before.push_back(brake);
        const double energy_J = landing_energy_J(settings, generator);
        c_e_J += energy_J;
        life.campaign.points.push_back({c_e_J, brake.land(energy_J, generator)});
        if (life.before.size() % settings.reading_every == 0)
            life.campaign.readings.push_back({c_e_J, brake.worn() + settings.reading_error * normal(readings)});
    }
    return life;
}

}  // namespace wear::arena
