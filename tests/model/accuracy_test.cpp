/// Open loop: the plant against the reference integration on all 32 scenarios, and its energy books.
#include <algorithm>

#include "tests/catch.hpp"
#include "tests/model/reference/comparison.hpp"
#include "tests/model/scenarios.hpp"

using reference::Input;
using reference::Options;

namespace {

void check_agreement(const Comparison& c) {
    CHECK(c.v <= 1e-4);
    CHECK(c.omega <= 1e-4);
    CHECK(c.energy <= 1e-4);
    CHECK(c.distance <= 1e-4);
    CHECK(c.friction_distance <= 1e-4);
    CHECK(c.residual <= 1e-6);
}

/// Keeps the worst of many, for the report at the end.
class Worst {
  public:
    explicit Worst(const char* what) : what_(what) {}
    void add(const Comparison& c) {
        v_ = std::max(v_, c.v);
        omega_ = std::max(omega_, c.omega);
        residual_ = std::max(residual_, c.residual);
        ++runs_;
    }
    ~Worst() { SUCCEED(what_ << ": " << runs_ << " runs, worst error of v " << v_ << ", of omega " << omega_ << ", energy residual " << residual_); }
    Worst(const Worst&) = delete;
    Worst& operator=(const Worst&) = delete;

  private:
    const char* what_;
    double v_ = 0.0, omega_ = 0.0, residual_ = 0.0;
    int runs_ = 0;
};

}  // namespace

TEST_CASE("pressure profiles: speeds, energies and distances agree with the reference on all 32 scenarios", "[RIG-001][RIG-050][figures]") {
    Worst worst("pressure profiles, 1 ms");
    const auto scenarios = all_scenarios();
    REQUIRE(scenarios.size() == 32);
    for (const NamedScenario& s : scenarios) {
        for (const NamedProfile& p : profiles(s.loaded.rig)) {
            CAPTURE(s.name, p.name);
            Options options;
            options.longest_s = p.longest_s;
            const Comparison c = compare(s.loaded.rig, Input::pressure, p.pressure_Pa, 1e-3, options);
            check_agreement(c);
            worst.add(c);
            // A profile that is meant to lock the wheel does so, except on ice, where the torque for it takes too long to act.
            if (std::string(p.name) == "steps past the peak" && s.loaded.rig.surface.name != "ice") {
                CHECK(c.locked);
                CHECK(c.spun_up);
            }
        }
    }
}

TEST_CASE("static pressure through the valve: agreement on all 32 scenarios", "[RIG-001][RIG-050]") {
    Worst worst("through the valve, 1 ms");
    for (const NamedScenario& s : all_scenarios()) {
        const double peak = min_peak_pressure_Pa(s.loaded.rig);
        // Held commands, as a controller sends them, with full release: the pressure runs into zero.
        reference::Profile held{{0.0, 0.0}};
        constexpr std::array<double, 8> kShares{0.4, 0.9, 0.6, 1.3, 0.0, 0.8, 0.2, 1.6};
        for (int i = 0; i < 40; ++i) {
            const double at_s = static_cast<double>(100 + 250 * i) * 1e-3;
            held.push_back({at_s, held.back().value});
            held.push_back({at_s, kShares.at(static_cast<std::size_t>(i) % kShares.size()) * peak});
        }
        CAPTURE(s.name);
        Options options;
        options.longest_s = 10.0;
        const Comparison c = compare(s.loaded.rig, Input::valve, held, 1e-3, options);
        check_agreement(c);
        worst.add(c);
    }
}

TEST_CASE("touchdown: the wheel spins up from standstill as in the reference", "[RIG-001][RIG-050]") {
    Worst worst("touchdown, 1 ms");
    for (const NamedScenario& s : all_scenarios()) {
        CAPTURE(s.name);
        Options options;
        options.longest_s = 2.0;
        options.from_rest = true;
        const Comparison c = compare(s.loaded.rig, Input::pressure, {{0.0, 0.0}, {1.0, 0.0}}, 1e-3, options);
        check_agreement(c);
        worst.add(c);
    }
}

TEST_CASE("the largest step, 5 ms, agrees too where no wheel locks", "[RIG-001][RIG-050]") {
    Worst worst("pressure profiles, 5 ms");
    for (const NamedScenario& s : all_scenarios()) {
        const auto all = profiles(s.loaded.rig);
        for (std::size_t i = 0; i < 2; ++i) {
            CAPTURE(s.name, all[i].name);
            Options options;
            options.longest_s = all[i].longest_s;
            const Comparison c = compare(s.loaded.rig, Input::pressure, all[i].pressure_Pa, 5e-3, options);
            check_agreement(c);
            worst.add(c);
        }
    }
}
