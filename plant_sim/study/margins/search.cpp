#include "plant_sim/study/margins/search.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "plant_sim/model/random.hpp"

namespace study::margins {

namespace {

constexpr double kRecombination = 0.9;

double uniform(plant::Random& random) {
    return static_cast<double>(random.bits() >> 11U) * 0x1p-53;
}
std::size_t index(plant::Random& random, std::size_t count) {
    return std::min(static_cast<std::size_t>(uniform(random) * static_cast<double>(count)), count - 1);
}

}  // namespace

Found search(const std::vector<Knob>& knobs, const std::function<double(const std::vector<double>&)>& score,
             const SearchOptions& options, const std::function<void(int, int)>& progress) {
    if (knobs.empty() || options.population < 4)
        throw std::invalid_argument("a search needs knobs and a population of four");
    for (const Knob& k : knobs)
        if (!(k.low > 0.0 && k.high >= k.low && k.start >= k.low && k.start <= k.high))
            throw std::invalid_argument(k.name + ": bounds must be above zero, rising, and hold the start");
    plant::Random random(options.seed);
    const auto members = static_cast<std::size_t>(options.population);
    const std::size_t n = knobs.size();
    std::vector<std::vector<double>> place(members, std::vector<double>(n));  // logarithms
    std::vector<double> scores(members);
    const auto values = [&](const std::vector<double>& x) {
        std::vector<double> v(n);
        std::transform(x.begin(), x.end(), v.begin(), [](double a) { return std::exp(a); });
        return v;
    };
    const int all = options.population * (options.generations + 1);
    Found found;
    const auto judge = [&](const std::vector<double>& x) {
        const double s = score(values(x));
        ++found.evaluations;
        if (progress) progress(found.evaluations, all);
        return s;
    };
    for (std::size_t i = 0; i < members; ++i) {
        for (std::size_t k = 0; k < n; ++k) {
            const double low = std::log(knobs[k].low), high = std::log(knobs[k].high);
            place[i][k] = i == 0 ? std::log(knobs[k].start) : low + uniform(random) * (high - low);
        }
        scores[i] = judge(place[i]);
    }
    found.start_score = scores[0];
    for (int g = 0; g < options.generations; ++g) {
        for (std::size_t i = 0; i < members; ++i) {
            const auto best =
                static_cast<std::size_t>(std::max_element(scores.begin(), scores.end()) - scores.begin());
            const std::size_t a = index(random, members), b = index(random, members);
            const double f = 0.4 + 0.5 * uniform(random);
            const std::size_t always = index(random, n);
            std::vector<double> trial = place[i];
            for (std::size_t k = 0; k < n; ++k) {
                if (uniform(random) > kRecombination && k != always) continue;
                trial[k] = std::clamp(place[best][k] + f * (place[a][k] - place[b][k]),
                                      std::log(knobs[k].low), std::log(knobs[k].high));
            }
            const double s = judge(trial);
            if (s < scores[i]) continue;
            place[i] = std::move(trial);
            scores[i] = s;
        }
    }
    const auto best =
        static_cast<std::size_t>(std::max_element(scores.begin(), scores.end()) - scores.begin());
    found.values = values(place[best]);
    found.score = scores[best];
    return found;
}

}  // namespace study::margins
