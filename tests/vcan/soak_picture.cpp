/// soak_picture soak.csv soak.png: what soak.py measured, in the style of all pictures.

#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <functional>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/input_file.hpp"
#include "rig_bridge/pictures/figure.hpp"
#include "rig_bridge/wear/csv_rows.hpp"

namespace {

using Columns = std::map<std::string, std::vector<double>, std::less<>>;

Columns read(const std::string& file) {
    const std::string csv = settings::read_file(file);
    wear::CsvRows rows(csv);
    if (!rows.next()) throw settings::Error(file, 0, "", "is empty");
    const std::vector<std::string> names(rows.fields().begin(), rows.fields().end());
    Columns columns;
    while (rows.next())
        for (std::size_t i = 0; i < names.size(); ++i)
            columns[names[i]].push_back(wear::csv_number(file, rows.line(), names[i], rows.fields().at(i)));
    return columns;
}

const std::vector<double>& column(const Columns& columns, const char* name) {
    const auto found = columns.find(name);
    if (found == columns.end()) throw std::runtime_error(fmt::format("there is no column {}", name));
    return found->second;
}

struct Curve {
    const char *column, *name;
};

pictures::Chart chart(const Columns& columns, const char* label, double unit, const std::vector<Curve>& curves) {
    pictures::Chart all{.y_label = label, .x_label = "time (min)"};
    for (const Curve& curve : curves) {
        pictures::Series& one =
            all.series.emplace_back(pictures::Series{.name = curve.name, .colour = all.series.size(), .x = column(columns, "minute")});
        std::ranges::transform(column(columns, curve.column), std::back_inserter(one.y), [unit](double value) { return value / unit; });
    }
    return all;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        fmt::print(stderr, "usage: soak_picture soak.csv soak.png\n");
        return 2;
    }
    try {
        constexpr double kKiB_per_MiB = 1024.0;
        const Columns columns = read(argv[1]);
        pictures::Chart latency =
            chart(columns, "latency (us)", 1.0, {{"latency_p50_us", "median"}, {"latency_p99_us", "p99"}, {"latency_max_us", "greatest"}});
        latency.logarithmic_y = true;
        pictures::draw(
            {.charts = {chart(columns, "resident memory (MiB)", kKiB_per_MiB,
                              {{"controller_rss_KiB", "controller"}, {"virtual-rig_rss_KiB", "virtual rig"}, {"bridge_rss_KiB", "bridge"}}),
                        std::move(latency),
                        chart(columns, "maneuvers", 1.0, {{"finished", "finished"}, {"aborted", "aborted"}, {"unfinished", "unfinished"}})}},
            argv[2]);
    } catch (const std::exception& e) {
        fmt::print(stderr, "soak_picture: {}\n", e.what());
        return 1;
    }
    return 0;
}
