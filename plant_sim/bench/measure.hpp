/// Processor time of a function, and quantiles of several measurements.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

namespace bench {

/// Processor time of this process; other load of the machine does not count.
inline double processor_s() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <typename Run>
double processor_s_of(const Run& run) {
    const double start = processor_s();
    run();
    return processor_s() - start;
}

/// `values` must not be empty.
inline double quantile(std::vector<double> values, double share) {
    const auto at = static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)));
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
    return values[at];
}
inline double median(const std::vector<double>& values) {
    return quantile(values, 0.5);
}

/// Returns the benchmark's status, or prints its exception on standard error and returns 1. For main().
template <typename Run>
int status_of(const char* name, const Run& run) {
    try {
        return run();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s: %s\n", name, error.what());
        return 1;
    }
}

/// The same for a benchmark that needs a folder, which is empty and removed afterwards.
template <typename Run>
int status_in_folder(const char* name, const Run& run) {
    struct Folder {
        std::string path;
        ~Folder() {
            std::error_code ignored;
            std::filesystem::remove_all(path, ignored);
        }
    };
    return status_of(name, [&] {
        std::string path = std::filesystem::temp_directory_path() / (std::string(name) + "_XXXXXX");
        if (mkdtemp(path.data()) == nullptr) throw std::runtime_error("no temporary directory");
        const Folder folder{path};
        return run(folder.path);
    });
}

}  // namespace bench
