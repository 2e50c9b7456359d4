/// cortex-m-prepare: what the microcontroller's run needs from the host. See --help.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "firmware/can/candump.hpp"
#include "firmware/can/load_layout.hpp"
#include "firmware/cortex_m/stream.hpp"
#include "firmware/host/controller_config.hpp"
#include "firmware/host/settings/atomic_file.hpp"
#include "firmware/host/settings/command_line.hpp"
#include "firmware/host/settings/config_directory.hpp"
#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/hash.hpp"
#include "firmware/host/settings/json.hpp"

namespace {

using antiskid::can::Layout;
using antiskid::can::Role;
using antiskid::cortex_m::Head;
using antiskid::cortex_m::Record;

/// A constant of type `type` for the target: the host's bytes, which mean the same there (static_assert of the size beside them).
template <class T>
std::string constant(const char* type, const char* name, const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::array<unsigned char, sizeof(T)> bytes{};
    std::copy_n(reinterpret_cast<const unsigned char*>(&value), sizeof(T), bytes.begin());
    std::string text = fmt::format("inline constexpr {} {} = std::bit_cast<{}>(std::array<unsigned char, {}>{{", type, name, type, sizeof(T));
    for (std::size_t i = 0; i < bytes.size(); ++i) fmt::format_to(std::back_inserter(text), "{}{},", i % 32 == 0 ? "\n    " : "", bytes[i]);
    fmt::format_to(std::back_inserter(text), "\n}});\nstatic_assert(sizeof({}) == {});\n", type, sizeof(T));
    return text;
}

std::string tables(const antiskid::control::Config& control, const Layout& layout) {
    return "// Made by cortex-m-prepare from configuration, DBC and binding.\n#pragma once\n\n#include <array>\n#include <bit>\n\n"
           "#include \"firmware/can/layout.hpp\"\n#include \"firmware/control/config.hpp\"\n\n" +
           constant("antiskid::control::Config", "kControl", control) + constant("antiskid::can::Layout", "kLayout", layout);
}

template <class T>
void append(std::string& out, const T& value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

struct Streams {
    std::string in;
    std::string expected;
};

/// A lockstep log: sensors, SYNC, then the controller's answer, period by period.
Streams streams_of(const std::filesystem::path& log, const Layout& layout, std::int64_t period_ns) {
    std::ifstream file(log);
    if (!file) throw settings::Error(log.string(), 0, "", "cannot be opened: a candump log is wanted");
    Streams out;
    append(out.in, Head{.period_ns = period_ns});
    std::uint32_t line = 0;
    std::size_t steps = 0;
    for (std::string text; std::getline(file, text);) {
        ++line;
        const auto parsed = antiskid::can::parse_candump(text);
        if (const auto* bad = std::get_if<antiskid::can::CandumpFailure>(&parsed)) {
            throw settings::Error(log.string(), line, "", fmt::format("column {}: {}", bad->column, bad->what));
        }
        const antiskid::can::CandumpLine& entry = std::get<antiskid::can::CandumpLine>(parsed);
        if (entry.extended || entry.remote || entry.error) continue;
        Record record{.id = static_cast<std::uint16_t>(entry.frame.id), .length = entry.frame.length};
        std::copy_n(entry.frame.data.begin(), entry.frame.length, record.data.begin());
        const auto is = [&](Role role) { return layout[role].bound && layout[role].id == entry.frame.id; };
        if (is(Role::valve) || is(Role::status) || is(Role::faults) || is(Role::road) || is(Role::controller_heartbeat)) {
            append(out.expected, record);
            continue;
        }
        append(out.in, record);
        if (!is(Role::sync)) continue;
        append(out.in, Record{.kind = Record::Kind::step});
        ++steps;
    }
    if (steps == 0) throw settings::Error(log.string(), 0, "", "no SYNC: the log must be of a lockstep run");
    return out;
}

int run(int argc, char** argv) {
    CLI::App app{
        "Controller configuration and frame layout as constants for the microcontroller (tables.hpp), and lockstep bus logs as its input (NAME.in) "
        "and what it must answer (NAME.expected). Prints version and hash of the configuration as JSON.",
        "cortex-m-prepare"};
    std::filesystem::path config = settings::config_directory();
    std::filesystem::path controller, dbc, binding;
    std::filesystem::path out;
    std::vector<std::filesystem::path> logs;
    settings::add_config_directory(app, config);
    settings::existing_file(app.add_option("--controller", controller, "controller's numbers (default: CONFIG/controller.toml)"));
    settings::add_layout_files(app, dbc, binding);
    settings::add_out(app, out, "made if it is not there")->required();
    settings::existing_file(app.add_option("LOG", logs, "candump logs of lockstep runs (rig-lab stop --bus-log)"));
    app.footer("Example:\n  cortex-m-prepare --out out/pil heavy.log");
    if (const auto status = settings::parse(app, argc, argv)) return *status;
    if (controller.empty()) controller = config / "controller.toml";
    if (dbc.empty()) dbc = config / "antiskid.dbc";
    if (binding.empty()) binding = config / "antiskid_binding.toml";
    const antiskid::control::Config control = antiskid::load_controller_config(controller);
    const Layout layout = antiskid::can::load_layout(dbc, binding);
    std::filesystem::create_directories(out);
    settings::write_file(out / "tables.hpp", tables(control, layout));
    const auto period_ns = static_cast<std::int64_t>(std::llround(static_cast<double>(control.period_s) * 1e6)) * 1000;
    for (const std::filesystem::path& log : logs) {
        const Streams streams = streams_of(log, layout, period_ns);
        settings::write_file(out / log.stem().concat(".in"), streams.in);
        settings::write_file(out / log.stem().concat(".expected"), streams.expected);
    }
    const settings::Json made_of{{"version", ANTISKID_VERSION}, {"config_hash", settings::hash(std::array{controller, dbc, binding})}};
    fmt::print("{}\n", made_of.dump());
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "cortex-m-prepare: %s\n", e.what());
        return 2;
    }
}
