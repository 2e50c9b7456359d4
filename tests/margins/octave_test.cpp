/// The margins of a sample of loops against octave-control.
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

#include "plant_sim/study/margins/law_loop.hpp"
#include "plant_sim/study/margins/margins.hpp"
#include "plant_sim/study/margins/pid_loop.hpp"
#include "tests/catch.hpp"
#include "tests/margins/scenario.hpp"

using namespace study::margins;
using margins_test::scenario;

namespace {

constexpr double kWithin = 1e-3;  // relative

/// What `script` prints as lines "name value".
std::map<std::string, double> octave(const std::string& script) {
    const std::string file = (std::filesystem::temp_directory_path() / ("margins_" + std::to_string(::getpid()) + ".m")).string();
    std::ofstream(file) << "crash_dumps_octave_core(false);\npkg load control\n" << script;
    std::FILE* pipe = ::popen(("octave-cli --norc --quiet " + file + " 2>&1").c_str(), "r");
    if (pipe == nullptr) throw std::runtime_error("cannot start octave-cli");
    std::string said;
    std::array<char, 4096> buffer{};
    while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) said += buffer.data();
    ::pclose(pipe);
    std::filesystem::remove(file);
    std::map<std::string, double> values;
    std::istringstream lines(said);
    std::string line;
    while (std::getline(lines, line)) {
        std::istringstream words(line);
        std::string mark, name;
        double value = 0.0;
        if (words >> mark >> name >> value && mark == "result") values[name] = value;
    }
    if (values.empty()) throw std::runtime_error("octave-cli with octave-control gave nothing: " + said);
    return values;
}

void print(std::ostringstream& out, const Eigen::MatrixXd& m) {
    const Eigen::IOFormat format(17, Eigen::DontAlignCols, ", ", ";\n", "", "", "[", "]");
    out << m.format(format);
}

double ratio(double dB) {
    return std::pow(10.0, dB / 20.0);
}

/// Frequency response by octave-control, crossings by Octave's own root finder. Not its `margin`: that goes over polynomials, which lose
/// the crossings of a loop with 25 states.
constexpr const char* kReport = R"(
function report(name, f, last)
  w = logspace(-2, log10(last), 1500);
  y = f(w);
  up = Inf; phase = 180; down = 0;
  k = find(diff(sign(abs(y) - 1)) != 0);
  for i = k
    x = fzero(@(x) abs(f(x)) - 1, w([i, i + 1]));
    phase = min(phase, abs(arg(-f(x))) * 180 / pi);
  end
  k = find(diff(sign(imag(y))) != 0 & real(y(1:end-1)) < 0);
  for i = k
    g = 1 / abs(f(fzero(@(x) imag(f(x)), w([i, i + 1]))));
    if g > 1 up = min(up, g); else down = max(down, g); end
  end
  printf('result %s.up %.12g\nresult %s.phase %.12g\nresult %s.down %.12g\n', name, up, name, phase, name, down);
  printf('result %s.peak %.12g\n', name, max(1 ./ abs(1 + y)));
end
function y = response(G, w)
  y = reshape(freqresp(G, w(:).'), size(w));
end
)";

void compare(const Margins& m, const std::string& name, std::map<std::string, double>& theirs) {
    INFO(name);
    REQUIRE(theirs.count(name + ".up") == 1);
    CHECK(ratio(m.gain_up_dB) == Approx(theirs[name + ".up"]).epsilon(kWithin));
    CHECK(m.phase_deg == Approx(theirs[name + ".phase"]).epsilon(kWithin));
    CHECK(1.0 / m.modulus == Approx(theirs[name + ".peak"]).epsilon(1e-2));  // both on a grid
    if (m.downward_radps > 0.5) CHECK(ratio(-m.gain_down_dB) == Approx(theirs[name + ".down"]).epsilon(kWithin));
}

}  // namespace

TEST_CASE("the shipped law's loop: octave-control's frequency response and stability", "[STUDY-123]") {
    std::ostringstream script;
    script << kReport;
    std::map<std::string, Margins> ours;
    for (const char* surface : {"dry_asphalt", "dry_cobblestone", "wet_asphalt", "snow", "ice"}) {
        const plant_sim::StopInputs s = scenario(surface);
        for (const double v : {48.0, 36.0}) {
            const OperatingPoint at = operating_point(s.plant.rig, v, 0.24);
            const PeriodicSystem p = law_system(s.controller, s.plant.rig, at, Linearisation::full);
            REQUIRE(p.a.size() == 1);
            const std::string name = surface + std::to_string(static_cast<int>(v));
            ours[name] = margins(SampledLoop(p));
            script << "L = ss(";
            print(script, p.a[0]);
            script << ", ";
            print(script, p.b);
            script << ", ";
            print(script, -p.c[0]);
            script << ", 0, " << p.period_s << ");\nreport('" << name << "', @(w) response(L, w), 0.999 * pi / " << p.period_s
                   << ");\nprintf('result " << name << ".stable %d\\n', isstable(feedback(L)));\n";
        }
    }
    auto theirs = octave(script.str());
    for (const auto& [name, m] : ours) {
        compare(m, name, theirs);
        CHECK(m.stable == (theirs[name + ".stable"] == 1.0));
    }
}

TEST_CASE("the PID's loop with its exact delay: octave's frequency response and root finder", "[STUDY-123]") {
    const Pid pid{60.0, 40.0, 0.4, 0.002, 1.0};
    std::ostringstream script;
    script << kReport;
    script.precision(17);
    std::map<std::string, Margins> ours;
    for (const char* surface : {"dry_asphalt", "dry_cobblestone", "wet_asphalt", "snow"}) {
        const plant_sim::StopInputs s = scenario(surface);
        for (const double v : {48.0, 30.0, 15.0}) {
            const rig::ValveParameters& valve = s.plant.rig.valve;
            const double a = operating_point(s.plant.rig, v, 0.24).wheel_pole_radps(Linearisation::full);
            const std::string name = surface + std::to_string(static_cast<int>(v));
            const Margins m = margins(pid_loop(pid, valve, a));
            if (!m.stable) continue;
            ours[name] = m;
            const double w = valve.natural_frequency_radps;
            script << "C = " << pid.k_p_per_s << " + tf(" << pid.k_i_per_s2 << ", [1 0]) + tf([" << pid.k_d << " 0], [" << pid.filter_s
                   << " 1]);\nG = C * tf(" << w * w << ", [1 " << 2.0 * valve.damping * w << " " << w * w << "]) * tf(1, [1 " << a << "]);\nreport('"
                   << name << "', @(w) response(G, w) .* exp(-1i * w * " << valve.delay_s << "), 1000);\n";
        }
    }
    REQUIRE(ours.size() >= 6);
    auto theirs = octave(script.str());
    for (const auto& [name, m] : ours) compare(m, name, theirs);
}
