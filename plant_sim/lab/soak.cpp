#include <fmt/core.h>
#include <malloc.h>

#include <memory>

#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/progress.hpp"
#include "firmware/host/stop_signals.hpp"
#include "plant_sim/endurance/soak.hpp"
#include "plant_sim/lab/verbs.hpp"

namespace plant_sim::lab {

namespace {

std::size_t heap_in_use() {
    const struct mallinfo2 info = ::mallinfo2();
    return info.uordblks + info.hblkhd;
}

struct SoakCommand {
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path scenario;
    std::filesystem::path out = "out/soak";
    std::string json_file;  ///< "-": standard output
    double hours = 24.0;
    std::uint64_t seed = 1;

    [[nodiscard]] int run() const {
        const auto file = scenario.empty() ? config / "scenarios" / "heavy.toml" : scenario;
        const endurance::EnduranceSetup setup = endurance::load_setup(file, config);
        antiskid::host::StopSignals signals;
        constexpr std::int64_t kParts = 1000;
        settings::Progress progress(kParts, 0, "thousandths");
        const endurance::SoakResult result = endurance::soak(setup, {.seconds = hours * 3600.0, .seed = seed, .stop = &signals.stop()}, heap_in_use,
                                                             [&progress](double share) { progress.show(static_cast<std::int64_t>(share * kParts)); });
        progress.finish();
        print_table(json_file, "{}: {} landings in {:.2f} h of the controller's time, seed {}\n", setup.scenario.title, result.landings,
                    result.seconds / 3600.0, seed);
        print_table(json_file, "  span  landings   length (m)            most heap in use (bytes)\n");
        for (std::size_t i = 0; i < result.spans.size(); ++i) {
            const endurance::SoakSpan& span = result.spans[i];
            print_table(json_file, "  {:4}  {:8}   {:8.3f} +- {:6.3f}    {}\n", i + 1, span.landings, span.length_m_mean, span.length_m_deviation,
                        span.max_heap_bytes);
        }
        const auto violations = endurance::violations(result);
        for (const std::string& violation : violations) print_table(json_file, "  WRONG: {}\n", violation);
        if (violations.empty() && !signals.stop().load()) print_table(json_file, "  nothing creeps\n");
        const auto json = out / "soak.json";
        write_json(json, json_file, endurance::to_json(result, setup, seed));
        print_table(json_file, "  {}\n", json.string());
        if (signals.stop().load()) return signals.exit_status();
        return violations.empty() ? 0 : 1;
    }
};

}  // namespace

LabVerb soak_verb(CLI::App& lab) {
    const auto command = std::make_shared<SoakCommand>();
    CLI::App* verb =
        lab.add_subcommand("soak", "Landings back to back on one rig with one controller: does memory, stop length or anything else creep?");
    verb->add_option("--hours", command->hours, "of the controller's time, cooling left out")
        ->check(CLI::Range(0.01, 10'000.0))
        ->capture_default_str();
    settings::existing_file(verb->add_option("--scenario", command->scenario, "scenario file (default: CONFIG/scenarios/heavy.toml)"));
    settings::add_seed(*verb, command->seed)->check(CLI::Range(std::uint64_t{0}, std::uint64_t{INT64_MAX}));
    settings::add_json(*verb, command->json_file, "result");
    settings::add_out(*verb, command->out, "directory of the result");
    settings::add_config_directory(*verb, command->config);
    verb->footer(
        "Leaves soak.json in OUT.\n"
        "Examples:\n"
        "  rig-lab soak\n"
        "  rig-lab soak --hours 1 --scenario config/scenarios/light.toml\n"
        "Exit status: 0 nothing creeps; 1 something does, or a landing went wrong; 2 mistake on the command line or in a configuration file; 130 "
        "stopped by Ctrl-C.");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
