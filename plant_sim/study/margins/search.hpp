/// Search for the best point in a box; the same seed gives the same point for any number of threads.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace study::margins {

/// A tuned parameter. The search is logarithmic; both ends must be positive.
struct Parameter {
    std::string name;
    double low;
    double high;
    std::optional<double> start{};  ///< if all parameters have one, this point is in the first population
};

/// The function to be maximised. If the result is below `to_beat`, its value does not matter: any value below `to_beat` may be returned. Called by
/// several threads at once.
using Score = std::function<double(const std::vector<double>& values, double to_beat)>;

/// Called with the number of judged points and its maximum; one call at a time, by any thread.
using SearchProgress = std::function<void(std::size_t done, std::size_t all)>;

struct SearchOptions {
    std::uint64_t seed = 1;
    int population = 16;  ///< >= 4
    int generations = 25;
    int digits = 15;       ///< number of significant digits of the judged points
    unsigned threads = 0;  ///< 0 counts as 1
};

struct Found {
    std::vector<double> values;  ///< in the order of the parameters
    double score = 0.0;
    int evaluations = 0;
};

/// Maximises `score` by differential evolution (Storn and Price, 1997: best/1/bin, F drawn between 0.4 and 0.9, CR 0.9), one generation at a time.
/// Throws std::invalid_argument for an empty box, and exceptions of `score`.
[[nodiscard]] Found search(const std::vector<Parameter>& parameters, const Score& score, const SearchOptions& options,
                           const SearchProgress& progress = {});

/// Climbs from `start` by the best single step of one parameter, up or down by 20 units of its last significant digit; if none gains at least
/// `min_gain`, by 5, then by 1. Ends if none of these does. Of `options` only digits and threads are used.
[[nodiscard]] Found climb(const std::vector<Parameter>& parameters, const std::vector<double>& start, const Score& score, double min_gain,
                          const SearchOptions& options, const SearchProgress& progress = {});

/// `value` rounded to `digits` significant digits; `value` > 0.
[[nodiscard]] double rounded(double value, int digits);

}  // namespace study::margins
