#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/progress.hpp"
#include "plant_sim/lab/verbs.hpp"
#include "plant_sim/study/paper/page.hpp"
#include "plant_sim/study/paper/run.hpp"
#include "plant_sim/study/paper/sections.hpp"
#include "rig_bridge/wear/on_threads.hpp"

namespace plant_sim::lab {

namespace {

namespace fs = std::filesystem;

/// They lie beside each other, built and installed.
fs::path program_of(const std::string& name) {
    fs::path place = fs::read_symlink("/proc/self/exe").parent_path() / name;
    return fs::is_regular_file(place) ? place : fs::path();
}

struct ReportCommand {
    fs::path config = settings::config_directory();
    fs::path sections;
    fs::path out = "out/report";
    std::string json_file;  ///< "-": standard output
    std::vector<std::string> only;
    bool quick = false;
    unsigned jobs = wear::all_cores();

    /// The wanted sections and those that they come after.
    [[nodiscard]] paper::Contents contents(const fs::path& file) const {
        paper::Contents all = paper::load_contents(file);
        if (only.empty()) return all;
        std::vector<std::string> wanted = only;
        for (const std::string& id : only)
            if (std::none_of(all.sections.begin(), all.sections.end(), [&](const auto& s) { return s.id == id; }))
                throw settings::Error(file.string(), 0, "section", "there is no section '" + id + "'");
        for (std::size_t i = all.sections.size(); i-- > 0;) {
            const paper::Section& s = all.sections[i];
            if (std::find(wanted.begin(), wanted.end(), s.id) != wanted.end() && !s.after.empty()) wanted.push_back(s.after);
        }
        std::erase_if(all.sections, [&](const auto& s) { return std::find(wanted.begin(), wanted.end(), s.id) == wanted.end(); });
        return all;
    }

    [[nodiscard]] int run() const {
        const fs::path file = sections.empty() ? config / "report.toml" : sections;
        const paper::Contents found = contents(file);
        std::optional<settings::Progress> bar;
        const auto show = [&bar](const paper::SectionResult& result, std::size_t done, std::size_t all) {
            if (!bar) bar.emplace(static_cast<std::int64_t>(all), 0, "sections");
            const char* state = result.failed() ? "failed" : result.passed() ? "done" : "answers no";
            bar->show(static_cast<std::int64_t>(done), fmt::format("; {}: {}", result.section->id, state));
        };
        const std::vector<paper::SectionResult> results =
            paper::run_sections(found, {.out = out, .config = config, .quick = quick, .jobs = jobs, .program = program_of, .progress = show});
        if (bar) bar->finish();
        const std::vector<paper::Compared> rows = paper::compared(results, config);
        std::vector<fs::path> files{file};
        for (const char* name : {"landing_gear.toml", "flywheel_rig.toml", "maneuvers.toml", "surfaces.toml", "controller.toml",
                                 "controller_endurance.toml", "antiskid.dbc", "antiskid_binding.toml"})
            files.push_back(config / name);
        const paper::PageHead head{.version = ANTISKID_VERSION,
                                   .config_hash = settings::hash(files),
                                   .command = fmt::format("rig-lab report{} --out {}", quick ? " --quick" : "", out.string()),
                                   .quick = quick};
        settings::deliver((out / "report.html").string(), paper::to_html(found, results, rows, head));
        write_json(out / "results.json", json_file, paper::to_json(results, rows, head));
        bool all_well = true;
        for (const paper::SectionResult& r : results) {
            if (r.passed()) continue;
            all_well = false;
            for (const paper::CommandResult& c : r.commands)
                if (c.status != 0) print_table(json_file, "{}: exit status {}: {}\n{}", r.section->id, c.status, c.line, c.errors);
        }
        for (const paper::Compared& row : rows) {
            if (row.ours) continue;
            all_well = false;
            print_table(json_file, "no figure for '{}': {}\n", row.what->quantity, row.why);
        }
        print_table(json_file, "Written to {}: report.html results.json\n", out.string());
        return all_well ? 0 : 1;
    }
};

}  // namespace

LabVerb report_verb(CLI::App& lab) {
    const auto command = std::make_shared<ReportCommand>();
    CLI::App* verb = lab.add_subcommand("report", "Every figure and table of the paper that this project reproduces, as one HTML page, made afresh.");
    verb->add_flag("--quick", command->quick, "fewer stops, starts and maneuvers; the page says so");
    verb->add_option("--only", command->only, "only these sections, and those that they build on");
    settings::existing_file(verb->add_option("--sections", command->sections, "what the report consists of (default: CONFIG/report.toml)"));
    verb->add_option("--jobs", command->jobs, "sections at a time; the page does not depend on it")
        ->check(CLI::Range(1U, 64U))
        ->capture_default_str();
    settings::add_config_directory(*verb, command->config);
    settings::add_json(*verb, command->json_file, "results");
    settings::add_out(*verb, command->out, "directory of report.html, results.json and a folder for each section");
    verb->footer(
        "Examples:\n  rig-lab report\n  rig-lab report --quick --out out/quick\n  rig-lab report --only fig12\n"
        "Exit status: 0 every study answers yes; 1 one answers no or failed, which the page says; 2 mistake on the command line or in a "
        "configuration file.");
    return {verb, [command] { return command->run(); }};
}

}  // namespace plant_sim::lab
