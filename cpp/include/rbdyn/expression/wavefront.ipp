// Definitions of rbdyn/expression/wavefront.hpp.
#pragma once

#include "rbdyn/expression/wavefront.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "rbdyn/expression/operands.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/schedule.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace wavefronts {

inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace wavefronts

RBDYN_INLINE Wavefront::Wavefront(const Program& program, Schedule& schedule, int order, std::size_t fewest,
                                  bool is_large) {
    std::vector<Part> row = parts_of(program, schedule);
    std::stable_sort(row.begin(), row.end(), [](const Part& a, const Part& b) { return a.key < b.key; });
    const std::size_t most_reach = reach(program, schedule, row), repeats_after = period(schedule, row);
    std::size_t length = std::max(most_reach, shortest);
    // chunks of whole periods are all alike (repetition.hpp)
    if (repeats_after > 0)
        length = (std::max(most_reach, shortest_alike) + repeats_after - 1) / repeats_after * repeats_after;
    is_skewed = (is_large && part_at_work * length * wavefronts::at(order + 1) < row.size()) ||
                (fewest > 0 && repeats_after > 0 && row.size() >= fewest * length);
    if (is_skewed)
        cut(row, length, schedule);
    else if (is_large && plain < row.size())
        cut(row, plain, schedule);
}

RBDYN_INLINE std::vector<Wavefront::Part> Wavefront::parts_of(const Program& program, const Schedule& schedule) {
    using wavefronts::at;
    std::vector<Part> parts;
    std::vector<std::uint32_t> of_slot(at(program.slots()), 0), of_series(schedule.series.size(), 0);
    const auto needed = [&](const Instruction& i) {
        auto key = static_cast<std::uint32_t>(&i - program.instructions().data());
        operands::reads(program, i, [&](int slot) { key = std::max(key, of_slot[at(slot)]); });
        return key;
    };
    const auto give = [&](const Instruction& i, std::uint32_t key) {
        operands::writes(program, i, [&](int slot) { of_slot[at(slot)] = key; });
    };
    for (std::uint32_t n = 0; n < schedule.stages.size(); ++n) {
        const Schedule::Stage& stage = schedule.stages[n];
        for (std::size_t s = stage.sums.first; s < stage.sums.last; ++s) {
            const auto& [series, combinations] = schedule.parts[s];
            std::uint32_t key = 0;
            for (std::size_t c = combinations.first; c < combinations.last; ++c)
                key = std::max(key, needed(*schedule.combinations[c].instruction));
            // a series that another sum has laid out comes with that
            for (std::size_t p = schedule.sums[s].first; p < schedule.sums[s].last; ++p)
                for (const std::size_t x : {schedule.products[p].x, schedule.products[p].y})
                    key = std::max(key, of_series[x]);
            std::fill(of_series.begin() + static_cast<std::ptrdiff_t>(series.first),
                      of_series.begin() + static_cast<std::ptrdiff_t>(series.last), key);
            for (std::size_t c = combinations.first; c < combinations.last; ++c)
                give(*schedule.combinations[c].instruction, key);
            parts.push_back({Part::Kind::sum, n, static_cast<std::uint32_t>(s), key});
        }
        for (std::size_t i = stage.others.first; i < stage.others.last; ++i) {
            const std::uint32_t key = needed(*schedule.others[i]);
            give(*schedule.others[i], key);
            parts.push_back({Part::Kind::other, n, static_cast<std::uint32_t>(i), key});
        }
    }
    const auto last = static_cast<std::uint32_t>(schedule.stages.size());
    for (int i = 0; i < operands::moving(program); ++i) {
        // a rate that is an input itself is where the rate of that one is
        int rate = program.output(i);
        if (rate < operands::moving(program)) rate = program.output(rate);
        parts.push_back({Part::Kind::input, last, static_cast<std::uint32_t>(i), of_slot[at(rate)]});
    }
    return parts;
}

RBDYN_INLINE std::size_t Wavefront::period(const Schedule& schedule, const std::vector<Part>& row) {
    // two parts of another kind may have the same number here: then their chunks are found to be unlike
    std::vector<std::uint32_t> kind_of;
    kind_of.reserve(row.size());
    const auto with = [](std::uint32_t kind, const Instruction& i) {
        for (const int number : {static_cast<int>(i.code), i.terms, i.products})
            kind = 31 * kind + static_cast<std::uint32_t>(number);
        return kind;
    };
    for (const Part& part : row) {
        auto kind = static_cast<std::uint32_t>(part.kind);
        if (part.kind == Part::Kind::other) kind = with(kind, *schedule.others[part.index]);
        if (part.kind == Part::Kind::sum) {
            const Schedule::Part& sum = schedule.parts[part.index];
            kind += 31 * static_cast<std::uint32_t>(sum.series.last - sum.series.first);
            for (std::size_t c = sum.combinations.first; c < sum.combinations.last; ++c)
                kind = with(kind, *schedule.combinations[c].instruction);
        }
        kind_of.push_back(kind);
    }
    // where it begins and ends it is another
    const auto first = kind_of.begin() + static_cast<std::ptrdiff_t>(row.size() / 4),
               last = kind_of.begin() + static_cast<std::ptrdiff_t>(3 * row.size() / 4);
    constexpr std::size_t often = 6;
    for (std::size_t p = 1; p <= std::min(longest, row.size() / often); ++p)
        if (std::equal(first, last, first + static_cast<std::ptrdiff_t>(p))) return p;
    return 0;
}

RBDYN_INLINE std::size_t Wavefront::reach(const Program& program, const Schedule& schedule,
                                          const std::vector<Part>& row) {
    using wavefronts::at;
    std::vector<std::size_t> made(at(operands::moving(program)), 0);
    for (std::size_t place = 0; place < row.size(); ++place)
        if (row[place].kind == Part::Kind::input) made[row[place].index] = place;
    std::size_t most = 0;
    for (std::size_t place = 0; place < row.size(); ++place) {
        const Part& part = row[place];
        const auto read = [&](int slot) {
            if (at(slot) < made.size() && made[at(slot)] > place) most = std::max(most, made[at(slot)] - place);
        };
        if (part.kind == Part::Kind::input) read(program.output(static_cast<int>(part.index)));
        if (part.kind == Part::Kind::other) operands::reads(program, *schedule.others[part.index], read);
        if (part.kind != Part::Kind::sum) continue;
        const Schedule::Range& combinations = schedule.parts[part.index].combinations;
        for (std::size_t c = combinations.first; c < combinations.last; ++c)
            operands::reads(program, *schedule.combinations[c].instruction, read);
    }
    return most;
}

RBDYN_INLINE void Wavefront::cut(const std::vector<Part>& row, std::size_t length, Schedule& schedule) {
    const std::vector<Schedule::Series> series = std::exchange(schedule.series, {});
    const std::vector<Schedule::Product> products = std::exchange(schedule.products, {});
    const std::vector<Schedule::Range> sums = std::exchange(schedule.sums, {});
    const std::vector<Schedule::Part> of_sums = std::exchange(schedule.parts, {});
    const std::vector<Schedule::Combination> combinations = std::exchange(schedule.combinations, {});
    const std::vector<const Instruction*> others = std::exchange(schedule.others, {});
    schedule.stages.clear();
    schedule.series.reserve(series.size());
    schedule.products.reserve(products.size());
    schedule.sums.reserve(sums.size());
    schedule.parts.reserve(of_sums.size());
    schedule.combinations.reserve(combinations.size());
    schedule.others.reserve(others.size());
    std::vector<std::size_t> place_of(series.size(), 0);
    const auto take_sum = [&](std::size_t s) {
        Schedule::Part part{{schedule.series.size(), 0}, {schedule.combinations.size(), 0}};
        for (std::size_t i = of_sums[s].series.first; i < of_sums[s].series.last; ++i) {
            place_of[i] = schedule.series.size();
            schedule.series.push_back(series[i]);
        }
        for (std::size_t i = of_sums[s].combinations.first; i < of_sums[s].combinations.last; ++i) {
            schedule.combinations.push_back(combinations[i]);
            schedule.combinations.back().sum = schedule.sums.size();
        }
        const std::size_t first = schedule.products.size();
        for (std::size_t i = sums[s].first; i < sums[s].last; ++i)
            schedule.products.push_back({place_of[products[i].x], place_of[products[i].y]});
        schedule.sums.push_back({first, schedule.products.size()});
        part.series.last = schedule.series.size();
        part.combinations.last = schedule.combinations.size();
        schedule.parts.push_back(part);
    };
    std::vector<Part> here;
    for (std::size_t from = 0; from < row.size(); from += length) {
        const std::size_t to = std::min(from + length, row.size());
        here.assign(row.begin() + static_cast<std::ptrdiff_t>(from), row.begin() + static_cast<std::ptrdiff_t>(to));
        std::stable_sort(here.begin(), here.end(), [](const Part& a, const Part& b) { return a.stage < b.stage; });
        Chunk chunk{{schedule.stages.size(), 0}, {inputs.size(), 0}};
        for (std::size_t i = 0; i < here.size();) {
            Schedule::Stage stage{{schedule.series.size(), 0},
                                  {schedule.sums.size(), 0},
                                  {schedule.combinations.size(), 0},
                                  {schedule.others.size(), 0}};
            for (const std::uint32_t n = here[i].stage; i < here.size() && here[i].stage == n; ++i) {
                if (here[i].kind == Part::Kind::sum) take_sum(here[i].index);
                if (here[i].kind == Part::Kind::other) schedule.others.push_back(others[here[i].index]);
                if (here[i].kind == Part::Kind::input) inputs.push_back(static_cast<int>(here[i].index));
            }
            stage.series.last = schedule.series.size();
            stage.sums.last = schedule.sums.size();
            stage.combinations.last = schedule.combinations.size();
            stage.others.last = schedule.others.size();
            schedule.stages.push_back(stage);
        }
        chunk.stages.last = schedule.stages.size();
        chunk.inputs.last = inputs.size();
        chunks.push_back(chunk);
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
