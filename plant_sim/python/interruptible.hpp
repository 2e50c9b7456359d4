/// Runs long C++ work while other Python threads go on; Ctrl-C ends it.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <future>

namespace plant_sim::python {

/// Returns or throws what `work` does. On a signal of Python calls `stop`, waits for `work`, and throws the exception of the signal's handler:
/// KeyboardInterrupt. Only in Python's main thread; others get no signals.
template <class Work, class Stop>
auto interruptible(const Work& work, const Stop& stop) {
    constexpr std::chrono::milliseconds kLook{50};
    const pybind11::gil_scoped_release others_run;
    auto result = std::async(std::launch::async, work);
    while (result.wait_for(kLook) != std::future_status::ready) {
        const pybind11::gil_scoped_acquire python;
        if (PyErr_CheckSignals() == 0) continue;
        const pybind11::error_already_set raised;
        stop();
        {
            const pybind11::gil_scoped_release they_run_on;
            result.wait();
        }
        throw pybind11::error_already_set(raised);
    }
    return result.get();
}

}  // namespace plant_sim::python
