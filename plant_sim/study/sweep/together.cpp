#include "plant_sim/study/sweep/together.hpp"

#include <algorithm>
#include <stdexcept>

#include "plant_sim/study/sweep/part_file.hpp"
#include "plant_sim/study/team/shared_work.hpp"

namespace sweep {

namespace {

/// In the order of work, without those in `done`.
std::vector<std::size_t> pending(const SweepPlan& plan, const std::vector<SweptStop>& done) {
    std::vector<bool> finished(plan.stops());
    for (const SweptStop& row : done) finished[row.stop.number] = true;
    std::vector<std::size_t> numbers = study::team::order_of_work(plan.stops());
    std::erase_if(numbers, [&finished](std::size_t number) { return finished[number]; });
    return numbers;
}

/// This process's share of what is not in `done`.
void work_on(const SweepPlan& plan, const Work& work, const std::vector<SweptStop>& done, study::team::Team& team,
             const std::function<void(std::string_view line)>& take) {
    const auto ours = study::team::share_of(pending(plan, done), team);
    study::team::work_together(
        team,
        [&](const study::team::PieceDone& piece_done) {
            (void)run(plan, ours, {.threads = work.threads, .stop = work.stop, .on_row = [&](const SweptStop& row) { piece_done(line(row)); }});
        },
        take);
}

std::vector<SweptStop> lead(const SweepPlan& plan, const Work& work, study::team::Team& team) {
    PartFile part(work.part, plan);
    std::vector<SweptStop> rows = part.rows();
    const std::size_t before = rows.size();
    (void)team.from_leader(to_csv(identity_of(plan), rows));
    work_on(plan, work, part.rows(), team, [&](std::string_view text) {
        part.append(text);
        rows.push_back(parse_row("a finished stop", 1, text.substr(0, text.size() - 1)));
        if (work.progress) work.progress(rows.size(), plan.stops(), before);
    });
    std::sort(rows.begin(), rows.end(), [](const SweptStop& a, const SweptStop& b) { return a.stop.number < b.stop.number; });
    return rows;
}

void follow(const SweepPlan& plan, const Work& work, study::team::Team& team) {
    const StopsTable begun = parse_stops("the leading process", team.from_leader({}));
    const std::string differs = difference(identity_of(plan), begun.identity);
    if (!differs.empty()) throw std::invalid_argument("this process was given another sweep than the leading one: " + differs);
    work_on(plan, work, begun.rows, team, {});
}

}  // namespace

std::vector<SweptStop> run_together(const SweepPlan& plan, const Work& work, study::team::Team& team) {
    if (team.rank() == 0) return lead(plan, work, team);
    follow(plan, work, team);
    return {};
}

}  // namespace sweep
