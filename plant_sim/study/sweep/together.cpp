#include "plant_sim/study/sweep/together.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "plant_sim/study/sweep/part_file.hpp"

namespace sweep {

namespace {

/// What is not in `done` and falls to this process.
std::vector<std::size_t> share_of(const std::vector<std::size_t>& numbers, const std::vector<Row>& done,
                                  const Team& team) {
    std::set<std::size_t> finished;
    for (const Row& row : done) finished.insert(row.stop.number);
    std::vector<std::size_t> ours;
    std::size_t pending = 0;
    for (const std::size_t number : numbers) {
        if (!finished.contains(number) && pending++ % team.size() == team.rank()) ours.push_back(number);
    }
    return ours;
}

std::vector<Row> lead(const Plan& plan, const Work& work, Team& team) {
    PartFile part(work.part, plan, work.shard);
    const std::vector<std::size_t> numbers = numbers_of(plan.stops(), work.shard);
    std::vector<Row> rows = part.rows();
    const std::size_t before = rows.size();
    (void)team.from_leader(to_csv(identity_of(plan), work.shard, rows));
    std::size_t at_work = team.size() - 1;
    const auto take = [&](std::string_view text, Row row) {
        part.append(text);
        rows.push_back(std::move(row));
        if (work.progress) work.progress(rows.size(), numbers.size(), before);
    };
    const auto hear = [&](bool wait) {
        const auto text = team.received(wait);
        if (text && text->empty()) --at_work;
        if (text && !text->empty())
            take(*text, parse_row("a stop of another process", 1,
                                  std::string_view(*text).substr(0, text->size() - 1)));
        return text.has_value();
    };
    (void)run(plan, share_of(numbers, part.rows(), team),
              {.threads = work.threads, .stop = work.stop, .on_row = [&](const Row& row) {
                   take(line(row), row);
                   while (at_work > 0 && hear(false)) {
                   }
               }});
    while (at_work > 0) (void)hear(true);
    std::sort(rows.begin(), rows.end(),
              [](const Row& a, const Row& b) { return a.stop.number < b.stop.number; });
    return rows;
}

void follow(const Plan& plan, const Work& work, Team& team) {
    const StopsTable begun = parse_stops("the leading process", team.from_leader({}));
    const std::string differs = difference(identity_of(plan), begun.identity);
    if (!differs.empty() || begun.shard != work.shard)
        throw std::invalid_argument("this process was given another sweep than the leading one: " + differs);
    (void)run(plan, share_of(numbers_of(plan.stops(), work.shard), begun.rows, team),
              {.threads = work.threads, .stop = work.stop, .on_row = [&team](const Row& row) {
                   team.to_leader(line(row));
               }});
    team.to_leader({});
}

}  // namespace

std::vector<Row> run_together(const Plan& plan, const Work& work, Team& team) {
    if (team.rank() == 0) return lead(plan, work, team);
    follow(plan, work, team);
    return {};
}

}  // namespace sweep
