// Definitions of rbdyn/expression/abreast_tape.hpp.
#pragma once

#include "rbdyn/expression/abreast_tape.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/schedule.hpp"

namespace rbdyn::inline RBDYN_FORM::abreast {

/// See write().
class Writer {
public:
    Writer(const Program& program, Tape& tape) : program_(program), schedule_(program), tape_(tape) {
        tape_.rows = program.slots();
        for (const Schedule::Stage& stage : schedule_.stages) write(stage);
        for (int i = 0; i < std::min(program.inputs(), program.outputs()); ++i)
            tape_.motion.emplace_back(at(i), at(program.output(i)));
        const int outputs = program.outputs() + static_cast<int>(program.switches().size());
        for (int i = 0; i < outputs; ++i) tape_.outputs.push_back(at(program.output(i)));
        if (program.uses_time()) tape_.time = at(program.time_slot());
        for (int i = 0; i < program.scalars(); ++i) {
            const double weight = program.constant(i);
            tape_.ones.push_back(weight == 1.0 ? 1 : weight == -1.0 ? -1 : 0);
        }
    }

private:
    using Place = Tape::Place;

    /// The place of a row; of none that of the first, of which nothing is read.
    Place at(int row) const { return row < 0 ? 0 : row * tape_.stride; }
    /// -1: none.
    Place weight_at(int weight) const { return weight < 0 ? -1 : weight * tape_.vector; }
    template <class T>
    static Place end(const std::vector<T>& list) {
        return static_cast<Place>(list.size());
    }

    void write(const Schedule::Stage& stage) {
        std::vector<std::pair<const Instruction*, std::pair<Place, Place>>> sums_of;
        const std::size_t first_product = tape_.products.size();
        for (std::size_t i = stage.combinations.first; i < stage.combinations.last; ++i) {
            const Schedule::Combination& c = schedule_.combinations[i];
            const bool is_series = c.lanes == 1 && c.instruction->terms == 0 && c.instruction->weight < 0;
            const Place first = tape_.sum_count * tape_.vector;
            for (int lane = c.first_lane; lane < c.first_lane + c.lanes; ++lane) {
                write_sum(schedule_.sums[c.sum], static_cast<std::size_t>(lane));
                if (is_series)
                    tape_.sums.back().out = at(c.instruction->out);
                else
                    tape_.sums.back().out = tape_.sum_count * tape_.vector;
                tape_.sums.back().is_series = is_series;
                ++tape_.sum_count;
            }
            if (!is_series) sums_of.push_back({c.instruction, {first, tape_.sum_count * tape_.vector}});
        }
        pair_products(first_product);
        for (const auto& [instruction, sums] : sums_of) write_combination(*instruction, sums.first, sums.second);
        for (std::size_t i = stage.others.first; i < stage.others.last; ++i) {
            const Instruction& other = *schedule_.others[i];
            if (other.code == Code::combine) {
                write_combination(other, 0, 0);
                continue;
            }
            const int slope = other.code == Code::norm ? -1 : other.extra;
            tape_.others.push_back({other.code, at(other.out), at(other.out2), at(other.a), at(other.b), at(other.c),
                                    at(slope), weight_at(other.weight), other.value,
                                    other.code == Code::exponential && other.b >= 0});
        }
        tape_.stages.push_back({tape_.scales.size(), tape_.singles.size(), tape_.pairs.size(), tape_.sums.size(),
                                tape_.combinations.size(), tape_.others.size()});
    }

    /// One lane of a sum of SeriesEvaluator.
    void write_sum(const Schedule::Range& products, std::size_t lane) {
        const Place first = end(tape_.products);
        for (std::size_t p = products.first; p < products.last; ++p) {
            const Schedule::Product& product = schedule_.products[p];
            const Schedule::Weighted &x = schedule_.series[product.x][lane], &y = schedule_.series[product.y][lane];
            if (x.scalar != Schedule::zero) tape_.products.push_back({place_of(x), place_of(y), 0});
        }
        tape_.sums.push_back({first, end(tape_.products), 0, false});
    }

    /// The products from one on, two by two where they have their second factor in common.
    void pair_products(std::size_t first) {
        Place part = 0;
        std::vector<Tape::Product*> waiting;
        for (std::size_t p = first; p < tape_.products.size(); ++p) waiting.push_back(&tape_.products[p]);
        while (!waiting.empty()) {
            Tape::Product& one = *waiting.front();
            waiting.erase(waiting.begin());
            one.part = part++ * tape_.vector;
            const auto other =
                std::find_if(waiting.begin(), waiting.end(), [&](const Tape::Product* p) { return p->y == one.y; });
            if (other == waiting.end()) {
                tape_.singles.push_back(one);
                continue;
            }
            (*other)->part = part++ * tape_.vector;
            tape_.pairs.push_back({one.x, (*other)->x, one.y, one.part});
            waiting.erase(other);
        }
        tape_.part_count = std::max(tape_.part_count, static_cast<int>(part));
    }

    void write_combination(const Instruction& i, Place first_sum, Place last_sum) {
        const Place first = end(tape_.multiples);
        for (int t = 0; t < i.terms; ++t)
            tape_.multiples.push_back({at(program_.terms(i)[t].slot), weight_at(program_.terms(i)[t].weight)});
        tape_.combinations.push_back(
            {at(i.out), weight_at(i.weight), first, end(tape_.multiples), first_sum, last_sum});
    }

    /// Of a slot, or of a row of it times its weight, which is written where it is used first.
    Place place_of(const Schedule::Weighted& w) {
        if (w.scalar == Schedule::one) return at(w.slot);
        const auto [known, is_new] = weighted_.try_emplace(w, tape_.rows);
        if (is_new) {
            ++tape_.rows;
            tape_.scales.push_back({at(known->second), at(w.slot), weight_at(w.scalar)});
        }
        return at(known->second);
    }

    const Program& program_;
    Schedule schedule_;
    Tape& tape_;
    std::map<Schedule::Weighted, int> weighted_;
};

RBDYN_INLINE void write(const Program& program, Tape& tape) { Writer(program, tape); }

}  // namespace rbdyn::inline RBDYN_FORM::abreast
