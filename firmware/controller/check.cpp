#include "firmware/controller/check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "firmware/host/settings/command_line.hpp"
#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"

namespace antiskid::controller {

namespace {

constexpr std::array kVerdicts{CheckResult::fail, CheckResult::warn, CheckResult::skipped, CheckResult::pass};

std::ptrdiff_t count(const Checks& checks, CheckResult verdict) {
    return std::count_if(checks.begin(), checks.end(), [verdict](const Check& check) { return check.verdict == verdict; });
}

std::size_t widest(const Checks& checks, std::string Check::*text, std::size_t min) {
    for (const Check& check : checks) min = std::max(min, (check.*text).size());
    return min;
}

/// In a table a failed one must catch the eye.
std::string_view shown(CheckResult verdict) {
    return verdict == CheckResult::fail ? "FAIL" : name(verdict);
}

}  // namespace

std::string_view name(CheckResult verdict) {
    constexpr std::array<std::string_view, 4> kNames{"pass", "warn", "fail", "skipped"};
    return kNames.at(static_cast<std::size_t>(verdict));
}

Check judged(std::string name, bool good, CheckTexts texts, CheckResult otherwise) {
    return {.name = std::move(name),
            .verdict = good ? CheckResult::pass : otherwise,
            .measured = std::move(texts.measured),
            .required = std::move(texts.required),
            .remedy = good ? std::string() : std::move(texts.remedy),
            .figures = {}};
}

Check skipped(std::string name, std::string why, std::string required) {
    return {.name = std::move(name),
            .verdict = CheckResult::skipped,
            .measured = std::move(why),
            .required = std::move(required),
            .remedy = {},
            .figures = {}};
}

void append(Checks& checks, Checks more) {
    checks.insert(checks.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

bool passed(const Report& report) {
    return count(report.checks, CheckResult::fail) == 0;
}

std::string table(const Report& report) {
    constexpr std::size_t kMaxMeasured = 48;  // longer ones push their own line's last column out
    const std::size_t names = widest(report.checks, &Check::name, 5);
    const std::size_t measured = std::min(kMaxMeasured, widest(report.checks, &Check::measured, 8));
    auto table = settings::TextTable::screen(fmt::format(":<9|check:<{}|measured:<{}|required", names + 2, measured + 2));
    for (const Check& check : report.checks) {
        table.add(shown(check.verdict), check.name, check.measured + "  ", check.required);
        if (!check.remedy.empty()) table.line(fmt::format("{:<9}{:<{}}  -> {}", "", "", names, check.remedy));
    }
    std::string text = table.text();
    const auto out = std::back_inserter(text);
    for (const CheckResult verdict : kVerdicts) fmt::format_to(out, "{} {}, ", count(report.checks, verdict), shown(verdict));
    fmt::format_to(out, "configuration {}: {}\n", report.config_hash.empty() ? "unread" : report.config_hash,
                   passed(report) ? "no check failed" : "not fit, mend what failed");
    return text;
}

std::string json(const Report& report) {
    auto checks = settings::Json::array();
    for (const Check& check : report.checks) {
        settings::Json entry{{"name", check.name},
                             {"verdict", name(check.verdict)},
                             {"measured", check.measured},
                             {"required", check.required},
                             {"remedy", check.remedy}};
        for (const auto& [figure, value] : check.figures) entry["figures"][figure] = value;
        checks.push_back(std::move(entry));
    }
    const settings::Json root{{"program", report.program},         {"version", ANTISKID_VERSION}, {"interface", report.interface},
                              {"config_hash", report.config_hash}, {"passed", passed(report)},    {"checks", checks}};
    // A name or an error message out of a file need not be UTF-8.
    return settings::json_page(root);
}

int deliver(const Report& report, const std::string& json_place) {
    if (json_place != "-") fmt::print("{}", table(report));
    settings::deliver(json_place, json(report));
    return passed(report) ? 0 : 1;
}

}  // namespace antiskid::controller
