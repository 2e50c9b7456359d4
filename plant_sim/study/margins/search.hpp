/// Searches for the best point in a box: seeded, the same every time, whatever the number of threads.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace study::margins {

/// One number that is tuned. Searched on a logarithmic scale; both ends above zero.
struct Parameter {
    std::string name;
    double low;
    double high;
    std::optional<double> start{};  ///< where all parameters have one, that point is in the first population
};

/// What is maximised. `to_beat`: whoever asks only wants to know how good the point is if it is at least as good as this; for any other it
/// may answer whatever is below it. Called from several threads at once.
using Score = std::function<double(const std::vector<double>& values, double to_beat)>;

/// Called with how many points were judged, of how many at the most; one call at a time, from any thread.
using SearchProgress = std::function<void(std::size_t done, std::size_t all)>;

struct SearchOptions {
    std::uint64_t seed = 1;
    int population = 16;  ///< 4 at least
    int generations = 25;
    int digits = 15;       ///< significant ones: only such points are judged
    unsigned threads = 0;  ///< 0: one, as 1
};

struct Found {
    std::vector<double> values;  ///< in the order of the parameters
    double score = 0.0;
    int evaluations = 0;
};

/// Maximises `score` by differential evolution (Storn and Price, 1997: best/1/bin, F drawn between 0.4 and 0.9, CR 0.9), a generation at a
/// time. Throws std::invalid_argument for an empty box, and what `score` throws.
[[nodiscard]] Found search(const std::vector<Parameter>& parameters, const Score& score, const SearchOptions& options,
                           const SearchProgress& progress = {});

/// Climbs from `start` by the best single step of one parameter, up or down by 20 of its last significant digit; where none gains `min_gain` or
/// more by 5, then by 1 of it. Ends where none of all these does. Of `options` the digits and threads count.
[[nodiscard]] Found climb(const std::vector<Parameter>& parameters, const std::vector<double>& start, const Score& score, double min_gain,
                          const SearchOptions& options, const SearchProgress& progress = {});

/// `value` with so many significant digits; above zero.
[[nodiscard]] double rounded(double value, int digits);

}  // namespace study::margins
