/// Long work of C++ that other threads of Python do not wait for, and that Ctrl-C ends.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <future>

namespace plant_sim::python {

/// What `work` returns or throws. Where a signal of Python's comes meanwhile `stop` is called, `work` is waited for, and what the signal's
/// handler raised is thrown: KeyboardInterrupt. For Python's main thread; in another there are no signals.
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
