/// A batch of stops from Python against the same batch by the program's own library, in turns, each on one thread. Table on standard output, JSON in
/// out/bench/python.json. Times are processor time of the batch alone: reading configuration and importing the module are in neither.

#include <fmt/core.h>

#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/json.hpp"
#include "plant_sim/bench/measure.hpp"
#include "plant_sim/scenario/stop_options.hpp"
#include "plant_sim/study/run_many.hpp"

namespace {

constexpr std::size_t kStops = 400;
constexpr int kRounds = 5;

double native_s(const plant_sim::StopInputs& inputs, double& distance_m) {
    return bench::processor_s_of([&] {
        study::run_many(
            inputs.layout, kStops,
            [&](std::size_t) { return study::Maneuver{.controller = inputs.controller, .rig = inputs.plant.rig, .options = inputs.session}; },
            [&](std::size_t, const study::RunResult& result) { distance_m = result.figures.stop_distance_m; }, {.threads = 1});
    });
}

double python_s(double& distance_m) {
    const std::string script = fmt::format(
        "import sys, time; sys.path.insert(0, '{}'); import antiskid\n"
        "scenario = antiskid.Scenario(); slip = [0.24] * {}\n"
        "begun = time.process_time(); table = scenario.stops(slip); print(time.process_time() - begun, table['stop_distance_m'][-1])\n",
        BENCH_MODULE, kStops);
    std::FILE* const python = ::popen(fmt::format("/usr/bin/python3 -c \"{}\"", script).c_str(), "r");
    if (python == nullptr) throw std::runtime_error("cannot start /usr/bin/python3");
    double spent_s = 0.0;
    const int read = std::fscanf(python, "%lf %lf", &spent_s, &distance_m);
    if (::pclose(python) != 0 || read != 2) throw std::runtime_error("the batch in Python failed");
    return spent_s;
}

int run() {
    const plant_sim::StopInputs inputs = plant_sim::load_scenario({});
    std::vector<double> native, python, ratio;
    for (int round = 0; round < kRounds; ++round) {
        double by_native_m = 0.0, by_python_m = 0.0;
        native.push_back(native_s(inputs, by_native_m));
        python.push_back(python_s(by_python_m));
        ratio.push_back(native.back() / python.back());
        if (by_native_m != by_python_m) throw std::runtime_error("Python's stops are not the program's");
    }
    fmt::print("{} stops, processor time: native {:.3f} s, from Python {:.3f} s; speed from Python over native {:.3f} (median of {})\n", kStops,
               bench::median(native), bench::median(python), bench::median(ratio), kRounds);
    const settings::Json report{{"stops", kStops},
                                {"native_s", native},
                                {"python_s", python},
                                {"python_over_native_speed", bench::median(ratio)},
                                {"version", ANTISKID_VERSION}};
    settings::write_file("out/bench/python.json", report.dump(2) + "\n");
    return 0;
}

}  // namespace

int main() {
    return bench::status_of("bench_python", run);
}
