/// A search for the best point in a box: seeded, the same every time.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace study::margins {

/// One number that is tuned. Searched on a logarithmic scale; both ends above zero.
struct Knob {
    std::string name;
    double low;
    double high;
    double start;  ///< a point that is in the first population
};

struct SearchOptions {
    std::uint64_t seed = 1;
    int population = 16;  ///< 4 at least
    int generations = 25;
};

struct Found {
    std::vector<double> values;  ///< in the order of the knobs
    double score = 0.0;
    double start_score = 0.0;
    int evaluations = 0;
};

/// Maximises `score` by differential evolution (Storn and Price, 1997: best/1/bin, F drawn between 0.4 and 0.9, CR 0.9). Throws
/// std::invalid_argument for an empty box.
[[nodiscard]] Found search(const std::vector<Knob>& knobs,
                           const std::function<double(const std::vector<double>&)>& score,
                           const SearchOptions& options,
                           const std::function<void(int done, int all)>& progress = {});

}  // namespace study::margins
