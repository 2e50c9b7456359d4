#include "plant_sim/study/margins/search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>

#include "rig_bridge/rig/random.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace study::margins {

namespace {

constexpr double kRecombination = 0.9;

std::size_t index(rig::Random& random, std::size_t count) {
    return std::min(static_cast<std::size_t>(random.uniform() * static_cast<double>(count)), count - 1);
}

/// Value of one unit of the last digit.
double last_place(double value, int digits) {
    return std::pow(10.0, std::floor(std::log10(value) + 1e-12) - digits + 1);
}

struct Candidate {
    std::vector<double> values;
    double to_beat = -std::numeric_limits<double>::infinity();
};

/// Scores in the order of the candidates.
class Scorer {
  public:
    Scorer(const Score& score, unsigned threads, const SearchProgress& progress) : score_(score), threads_(threads), progress_(progress) {}

    [[nodiscard]] std::vector<double> scores(const std::vector<Candidate>& candidates, std::size_t all) {
        std::vector<double> out(candidates.size());
        std::mutex mutex;
        wear::run_jobs(threads_, candidates.size(), [&](std::size_t i) {
            out[i] = score_(candidates[i].values, candidates[i].to_beat);
            const std::scoped_lock lock(mutex);
            ++scored_;
            if (progress_) progress_(static_cast<std::size_t>(scored_), all);
        });
        return out;
    }
    [[nodiscard]] int scored() const { return scored_; }

  private:
    const Score& score_;
    unsigned threads_;
    const SearchProgress& progress_;
    int scored_ = 0;
};

}  // namespace

double rounded(double value, int digits) {
    const double place = last_place(value, digits);
    // Divides by a whole number if the digit's value is below 1: 4.31e-3 is then the double of the text "0.00431".
    return place < 1.0 ? std::round(value / place) / std::round(1.0 / place) : std::round(value / place) * place;
}

Found search(const std::vector<Parameter>& parameters, const Score& score, const SearchOptions& options, const SearchProgress& progress) {
    if (parameters.empty() || options.population < 4) throw std::invalid_argument("a search needs parameters and a population of four");
    for (const Parameter& k : parameters)
        if (!(k.low > 0.0 && k.high >= k.low) || (k.start && (*k.start < k.low || *k.start > k.high)))
            throw std::invalid_argument(k.name + ": bounds must be above zero, rising, and hold the start");
    rig::Random random(options.seed);
    const auto members = static_cast<std::size_t>(options.population);
    const std::size_t n = parameters.size();
    const bool started = std::all_of(parameters.begin(), parameters.end(), [](const Parameter& k) { return k.start; });
    std::vector<std::vector<double>> place(members, std::vector<double>(n));  // logarithms
    const auto values = [&](const std::vector<double>& x) {
        std::vector<double> v(n);
        for (std::size_t k = 0; k < n; ++k) v[k] = rounded(std::exp(x[k]), options.digits);
        return v;
    };
    const auto all = static_cast<std::size_t>(options.population) * (static_cast<std::size_t>(options.generations) + 1);
    Scorer scorer(score, options.threads, progress);
    std::vector<Candidate> candidates(members);
    for (std::size_t i = 0; i < members; ++i) {
        for (std::size_t k = 0; k < n; ++k) {
            const double low = std::log(parameters[k].low), high = std::log(parameters[k].high);
            place[i][k] = i == 0 && started ? std::log(*parameters[k].start) : low + random.uniform() * (high - low);
        }
        candidates[i].values = values(place[i]);
    }
    std::vector<double> scores = scorer.scores(candidates, all);
    const auto best = [&scores] { return static_cast<std::size_t>(std::max_element(scores.begin(), scores.end()) - scores.begin()); };
    std::vector<std::vector<double>> trials(members);
    for (int g = 0; g < options.generations; ++g) {
        const std::vector<double>& leader = place[best()];
        for (std::size_t i = 0; i < members; ++i) {
            const std::size_t a = index(random, members), b = index(random, members);
            const double f = 0.4 + 0.5 * random.uniform();
            const std::size_t always = index(random, n);
            trials[i] = place[i];
            for (std::size_t k = 0; k < n; ++k) {
                if (random.uniform() > kRecombination && k != always) continue;
                trials[i][k] = std::clamp(leader[k] + f * (place[a][k] - place[b][k]), std::log(parameters[k].low), std::log(parameters[k].high));
            }
            candidates[i] = {values(trials[i]), scores[i]};
        }
        const std::vector<double> found = scorer.scores(candidates, all);
        for (std::size_t i = 0; i < members; ++i) {
            if (found[i] < scores[i]) continue;
            place[i] = trials[i];
            scores[i] = found[i];
        }
    }
    return {values(place[best()]), scores[best()], scorer.scored()};
}

Found climb(const std::vector<Parameter>& parameters, const std::vector<double>& start, const Score& score, double min_gain,
            const SearchOptions& options, const SearchProgress& progress) {
    if (start.size() != parameters.size() || !(min_gain > 0.0))
        throw std::invalid_argument("a climb needs a start for each parameter and a least gain above zero");
    Scorer scorer(score, options.threads, progress);
    Found found{start, scorer.scores({{start}}, 1).front(), 1};
    constexpr std::array<int, 3> kSteps{20, 5, 1};
    for (std::size_t size = 0; size < kSteps.size();) {
        std::vector<Candidate> candidates;
        for (std::size_t k = 0; k < parameters.size(); ++k) {
            const double step = kSteps[size] * last_place(found.values[k], options.digits);
            for (const double change : {-step, step}) {
                std::vector<double> x = found.values;
                x[k] = rounded(std::clamp(x[k] + change, parameters[k].low, parameters[k].high), options.digits);
                if (x[k] != found.values[k]) candidates.push_back({std::move(x), found.score + min_gain});
            }
        }
        const std::vector<double> scores = scorer.scores(candidates, static_cast<std::size_t>(scorer.scored()) + candidates.size());
        found.evaluations = scorer.scored();
        const auto best = std::max_element(scores.begin(), scores.end());
        if (best == scores.end() || *best < found.score + min_gain) {
            ++size;
            continue;
        }
        found.values = candidates[static_cast<std::size_t>(best - scores.begin())].values;
        found.score = *best;
        size = 0;
    }
    return found;
}

}  // namespace study::margins
