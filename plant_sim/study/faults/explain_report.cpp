#include "plant_sim/study/faults/explain.hpp"

#include <fmt/format.h>

#include <iterator>

#include "firmware/host/settings/json.hpp"
#include "firmware/host/settings/text_table.hpp"
#include "plant_sim/study/faults/report.hpp"

namespace faults {

std::string to_table(const FaultPlan& plan, std::span<const Explanation> explanations) {
    std::string text;
    for (const Explanation& e : explanations) {
        fmt::format_to(std::back_inserter(text), "{}\n  {}\n  a fault-free stop is {:.3f} times as long on {:.3f} of the runway's friction\n",
                       describe(plan, e.run), describe(e.result), e.twin_share, e.grip);
        auto table = settings::TextTable::screen(
            "symptom:<22|this stop:>12.5g|fault-free stops, from:>24.5g|to:>12.5g|on drawn rigs, from:>21.5g|to:>12.5g|  shown:<8", "    ");
        for (std::size_t i = 0; i < kSymptomNames.size(); ++i) {
            const bool here = e.twins[i].shows(e.symptoms[i]), there = e.drawn[i].shows(e.symptoms[i]);
            table.add(kSymptomNames[i], e.symptoms[i], e.twins[i].least, e.twins[i].most, e.drawn[i].least, e.drawn[i].most,
                      here && there ? "  yes"
                      : here        ? "  of this rig"
                                    : "  no");
        }
        text += table.text();
    }
    return text;
}

std::string to_json(const FaultPlan& plan, std::span<const Explanation> explanations) {
    settings::Json runs = settings::Json::array();
    for (const Explanation& e : explanations) {
        settings::Json symptoms;
        for (std::size_t i = 0; i < kSymptomNames.size(); ++i)
            symptoms[std::string(kSymptomNames[i])] = {{"seen", e.symptoms[i]},
                                                       {"sound", {e.twins[i].least, e.twins[i].most}},
                                                       {"sound_drawn", {e.drawn[i].least, e.drawn[i].most}},
                                                       {"shown", e.twins[i].shows(e.symptoms[i])},
                                                       {"shown_among_drawn", e.drawn[i].shows(e.symptoms[i])}};
        runs.push_back({{"run", e.run.number},
                        {"signal", name(e.run.fault.what.signal)},
                        {"kind", name(e.run.fault.what.kind)},
                        {"outcome", name(e.result.verdict.outcome)},
                        {"distance_share", e.result.verdict.distance_share},
                        {"grip", e.grip},
                        {"twin_share", e.twin_share},
                        {"signs", symptoms}});
    }
    return settings::json_page({{"seed", plan.seed}, {"config_hash", plan.config_hash}, {"version", plan.version}, {"runs", runs}});
}

}  // namespace faults
