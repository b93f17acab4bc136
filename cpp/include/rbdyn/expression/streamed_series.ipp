// Definitions of rbdyn/expression/streamed_series.hpp.
#pragma once

#include "rbdyn/expression/streamed_series.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/schedule.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/stream_kinds.hpp"
#include "rbdyn/expression/streamed_code.hpp"
#include "rbdyn/expression/wavefront.hpp"
#include "rbdyn/series/coefficients.hpp"
#include "rbdyn/series/lanes.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Where in each list an order is.
struct StreamedSeries::Cursor {
    double *now, *made;  // values of this order; the next one to be made
    Line* line;
    const Series* series;
    const Index* spread;
    const Index* size;
    const Product* product;
    series::LaneValues* next;
    const Index* lane;
    const Combination* combination;
    const Weighted* term;
    std::size_t step = 0;
    const Row* row;
};

RBDYN_INLINE StreamedSeries::StreamedSeries(const Program& program, const Schedule& schedule,
                                            const Wavefront& wavefront, int max_order, std::span<const int> backwards) {
    const auto index = [](auto i) { return static_cast<Index>(i); };
    const auto is_copied = [&](int slot) { return std::binary_search(backwards.begin(), backwards.end(), slot); };
    // places are counted as they are made: what is given first
    std::vector<Index> place(static_cast<std::size_t>(program.slots()), none);
    Index places = 0;
    const auto take_place = [&](int slot) { place[static_cast<std::size_t>(slot)] = places++; };
    const auto place_of = [&](int slot) { return place[static_cast<std::size_t>(slot)]; };
    const int moving = std::min(program.inputs(), program.outputs());
    const auto give = [&](std::vector<Row>& rows, int slot) {
        take_place(slot);
        rows.push_back({place_of(slot), index(slot), is_copied(slot)});
    };
    for (int i = 0; i < moving; ++i) give(inputs_, i);
    for (int i = moving; i <= program.inputs(); ++i)
        if (i < program.inputs() || program.uses_time()) give(others_, i);
    const auto is_constant = [](const Instruction& i) {
        return i.code == Code::combine && i.terms == 0 && i.products == 0;
    };
    for (const Instruction* i : schedule.others)
        if (is_constant(*i)) give(others_, i->out);
    first_made_ = places;
    // then what each stage makes, in the order in which it does
    made_at_.assign(place.size(), none);
    const auto make = [&](int slot) {
        take_place(slot);
        made_at_[static_cast<std::size_t>(slot)] = place_of(slot);
    };
    std::map<Schedule::Series, Index> known_weights;
    const auto weight_of = [&](const Schedule::Series& s) {
        Schedule::Series scalars = s;
        for (Schedule::Weighted& w : scalars) w.slot = 0;
        const auto [found, is_new] = known_weights.try_emplace(scalars, index(weight_scalars_.size()));
        if (is_new) weight_scalars_.push_back(scalars);
        return found->second;
    };
    std::vector<Index> line_of(schedule.series.size(), 0);
    Index lines = 0;
    std::size_t most_sums = 0;
    const auto add_terms = [&](const Instruction& i) {
        for (int t = 0; t < i.terms; ++t)
            terms_.push_back({place_of(program.terms(i)[t].slot), index(program.terms(i)[t].weight)});
    };
    const auto add_stage = [&](const Schedule::Stage& from) {
        Stage stage;
        const auto is_spread = [](const Schedule::Series& s) {
            return s[0].scalar == Schedule::one && std::count(s.begin(), s.end(), s[0]) == Schedule::lanes;
        };
        for (const bool spreads : {false, true})
            for (std::size_t i = from.series.first; i < from.series.last; ++i) {
                const Schedule::Series& s = schedule.series[i];
                if (is_spread(s) != spreads) continue;
                line_of[i] = lines++;
                if (spreads) {
                    spreads_.push_back(place_of(s[0].slot));
                    ++stage.spreads;
                } else {
                    series_.push_back(
                        {{place_of(s[0].slot), place_of(s[1].slot), place_of(s[2].slot), place_of(s[3].slot)},
                         weight_of(s)});
                    ++stage.series;
                }
            }
        stage.sums = index(from.sums.last - from.sums.first);
        most_sums = std::max<std::size_t>(most_sums, stage.sums);
        for (std::size_t s = from.sums.first; s < from.sums.last; ++s) {
            const auto [first, last] = schedule.sums[s];
            sizes_.push_back(index(last - first));
            for (std::size_t p = first; p < last; ++p)
                products_.push_back({line_of[schedule.products[p].x], line_of[schedule.products[p].y]});
        }
        // one lane alone is copied, its sign of zero, too
        const auto is_lane = [](const Schedule::Combination& c) {
            return c.lanes == 1 && c.instruction->terms == 0 && c.instruction->weight < 0;
        };
        for (const bool lanes : {true, false})
            for (std::size_t i = from.combinations.first; i < from.combinations.last; ++i) {
                const Schedule::Combination& c = schedule.combinations[i];
                if (is_lane(c) != lanes) continue;
                const Index lane = index(Schedule::lanes * (c.sum - from.sums.first)) + index(c.first_lane);
                if (lanes) {
                    lanes_.push_back(lane);
                    ++stage.lanes;
                } else {
                    combinations_.push_back({c.instruction->weight, index(c.instruction->terms), lane, index(c.lanes)});
                    ++stage.combinations;
                    add_terms(*c.instruction);
                }
                make(c.instruction->out);
            }
        for (std::size_t i = from.others.first; i < from.others.last; ++i) {
            const Instruction& other = *schedule.others[i];
            if (other.code != Code::combine || is_constant(other)) continue;
            combinations_.push_back({other.weight, index(other.terms), 0, 0});
            ++stage.combinations;
            add_terms(other);
            make(other.out);
        }
        for (std::size_t i = from.others.first; i < from.others.last; ++i) {
            const Instruction& other = *schedule.others[i];
            if (other.code == Code::combine) continue;
            Operands operands{0, 0};
            for (const int slot : {other.a, other.b, other.c}) {
                if (slot < 0) continue;
                step_rows_.push_back({place_of(slot), index(slot), is_copied(slot)});
                ++operands.reads;
            }
            for (const int slot : {other.out, other.out2}) {
                if (slot < 0) continue;
                take_place(slot);
                step_rows_.push_back({place_of(slot), index(slot), false});
                ++operands.writes;
            }
            steps_.push_back(&other);
            operands_.push_back(operands);
            ++stage.steps;
        }
        stages_.push_back(stage);
    };
    // for code a stage is a sum with what comes with it, or another instruction: of these there are few kinds
    const bool are_small = CodeMemory::is_built() && CodeMemory::is_usable();
    for (const Wavefront::Chunk& chunk : wavefront.chunks) {
        for (std::size_t n = chunk.stages.first; n < chunk.stages.last; ++n) {
            const Schedule::Stage& stage = schedule.stages[n];
            if (!are_small) {
                add_stage(stage);
                continue;
            }
            for (std::size_t s = stage.sums.first; s < stage.sums.last; ++s)
                add_stage({schedule.parts[s].series, {s, s + 1}, schedule.parts[s].combinations, {}});
            for (std::size_t i = stage.others.first; i < stage.others.last; ++i)
                if (!is_constant(*schedule.others[i])) add_stage({{}, {}, {}, {i, i + 1}});
        }
        ends_.push_back(index(stages_.size()));
        input_ends_.push_back(index(chunk.inputs.last));
    }
    for (const int input : wavefront.inputs) motion_.push_back({place_of(program.output(input)), place_of(input)});
    // an odd number of lines keeps those of all orders in different sets of a cache
    places_ = (static_cast<std::size_t>(places) + 7) / 8 * 8;
    if (places_ % 16 == 0) places_ += 8;
    row_ = lines | 1U;
    values_.resize((static_cast<std::size_t>(max_order) + 2) * places_);
    given_.resize(place.size(), 0);
    lines_.resize((static_cast<std::size_t>(max_order) / 2 + 1) * row_);
    next_.resize(sizes_.size());
    sums_.resize(most_sums);
    weights_.resize(weight_scalars_.size());
}

RBDYN_INLINE void StreamedSeries::set_weights(std::span<const double> scalars) {
    const auto weight = [&](const Schedule::Weighted& w) {
        if (w.scalar < 0) return w.scalar == Schedule::one ? 1.0 : 0.0;
        return scalars[static_cast<std::size_t>(w.scalar)];
    };
    for (std::size_t i = 0; i < weights_.size(); ++i) {
        const Schedule::Series& w = weight_scalars_[i];
        weights_[i].value = series::Quad{weight(w[0]), weight(w[1]), weight(w[2]), weight(w[3])};
    }
}

RBDYN_INLINE_LANES void StreamedSeries::first_order(const Stage& stage, Cursor& at) {
    const Line* const base = lines_.data();
    for (Index s = 0; s < stage.sums; ++s) {
        series::Quad sum{};
        for (const Product* const end = at.product + *at.size++; at.product != end; ++at.product)
            sum += base[at.product->x].orders[0] * base[at.product->y].orders[0];
        sums_[s].value = sum;
        (at.next++)->value = series::Quad{};
    }
}

RBDYN_INLINE_LANES void StreamedSeries::even_order(const Stage& stage, Cursor& at, int k) {
    // as series::lanes::even_order, over lines that are a row apart
    const Line* const base = lines_.data();
    const auto row = static_cast<std::ptrdiff_t>(row_), newest = k / 2 * row;
    for (Index s = 0; s < stage.sums; ++s) {
        series::Quad sum{}, next{};
        for (const Product* const last = at.product + *at.size++; at.product != last; ++at.product) {
            const Line *const x = base + at.product->x, *const y = base + at.product->y, *right = y + newest - row;
            const series::Quad x_k = x[newest].orders[0], y_k = y[newest].orders[0];
            series::Quad above = right->orders[1], a{}, b = x->orders[1] * above, c{}, d{};
            for (const Line *left = x + row, *end = x + newest; left != end; left += row) {
                const series::Quad first = right->orders[0], even = left->orders[0], odd = left->orders[1];
                right -= row;
                const series::Quad second = right->orders[1];
                a += even * first;
                c += even * above;
                b += odd * second;
                d += odd * first;
                above = second;
            }
            c += x->orders[1] * y_k;
            d += x_k * y->orders[1];
            a += x->orders[0] * y_k;
            b += x_k * y->orders[0];
            sum += a + b;
            next += c + d;
        }
        sums_[s].value = sum;
        (at.next++)->value = next;
    }
}

RBDYN_INLINE_LANES void StreamedSeries::odd_order(const Stage& stage, Cursor& at, int k) {
    const Line* const base = lines_.data();
    const auto newest = k / 2 * static_cast<std::ptrdiff_t>(row_);
    for (Index s = 0; s < stage.sums; ++s) {
        series::Quad sum = (at.next++)->value;
        for (const Product* const end = at.product + *at.size++; at.product != end; ++at.product) {
            const Line *const x = base + at.product->x, *const y = base + at.product->y;
            sum += x->orders[0] * y[newest].orders[1] + x[newest].orders[1] * y->orders[0];
        }
        sums_[s].value = sum;
    }
}

template <class Lanes>
RBDYN_INLINE_LANES void StreamedSeries::advance_stage(SeriesEvaluator& series, const Stage& stage, Cursor& at, int k) {
    const double* const now = at.now;
    for (Index i = 0; i < stage.series; ++i, ++at.series) {
        const auto& [from, weight] = *at.series;
        (at.line++)->orders[k % 2] =
            weights_[weight].value * series::Quad{now[from[0]], now[from[1]], now[from[2]], now[from[3]]};
    }
    for (Index i = 0; i < stage.spreads; ++i) {
        const double value = now[*at.spread++];
        (at.line++)->orders[k % 2] = series::Quad{value, value, value, value};
    }
    if (k == 0)
        first_order(stage, at);
    else if (k % 2 == 0)
        even_order(stage, at, k);
    else
        odd_order(stage, at, k);
    const auto* const lanes = reinterpret_cast<const double*>(sums_.data());
    for (Index i = 0; i < stage.lanes; ++i) *at.made++ = lanes[*at.lane++];
    const double* const scalars = series.scalars_.data();
    for (Index i = 0; i < stage.combinations; ++i) {
        const Combination& c = *at.combination++;
        double sum = k == 0 && c.weight >= 0 ? scalars[c.weight] : 0.0;
        for (const Weighted* const end = at.term + c.terms; at.term != end; ++at.term)
            sum += scalars[at.term->weight] * now[at.term->place];
        for (Index l = 0; l < c.lanes; ++l) sum += lanes[c.first_lane + l];
        *at.made++ = sum;
    }
    for (Index i = 0; i < stage.steps; ++i) advance_step<Lanes>(series, at, k);
}

template <class Lanes>
RBDYN_INLINE_LANES void StreamedSeries::advance_step(SeriesEvaluator& series, Cursor& at, int k) {
    const SeriesEvaluator::Step& step = series.steps_[at.step++];
    for (const series::View* to : {&step.a, &step.b, &step.c}) {
        if (to->forward == nullptr) continue;
        to->forward[k] = at.now[at.row->place];
        if ((at.row++)->is_copied) to->last[-k] = to->forward[k];
    }
    series.compute<Lanes>(step, k);
    for (const series::View* from : {&step.out, &step.out2}) {
        if (from->forward == nullptr) continue;
        *at.made++ = (*from)[k];
        ++at.row;
    }
}

RBDYN_INLINE StreamedSeries::Cursor StreamedSeries::begin(int k) {
    double* const now = values(k);
    return {now,
            now + first_made_,
            lines_.data() + static_cast<std::size_t>(k) / 2 * row_,
            series_.data(),
            spreads_.data(),
            sizes_.data(),
            products_.data(),
            next_.data(),
            lanes_.data(),
            combinations_.data(),
            terms_.data(),
            0,
            step_rows_.data()};
}

template <class Lanes>
RBDYN_INLINE_LANES void StreamedSeries::advance(SeriesEvaluator& series, int k, bool integrates) {
    double *const now = values(k), *const coming = values(k + 1);
    if (k == 0) series.set_constants();
    take_rows(series, others_, k);
    if (k == 0 || !integrates) take_rows(series, inputs_, k);
    if (code_ != nullptr) code_->begin(k);
    Cursor at = begin(k);
    const double factor = series.unit_ / (k + 1);
    Index stage = 0, input = 0;
    for (std::size_t chunk = 0; chunk < ends_.size(); ++chunk) {
        Interruption::point();
        if (code_ != nullptr)
            code_->run();
        else
            for (; stage < ends_[chunk]; ++stage) advance_stage<Lanes>(series, stages_[stage], at, k);
        if (!integrates) continue;
        for (; input < input_ends_[chunk]; ++input) {
            const SeriesEvaluator::Motion& m = series.motion_[input];
            const double value = now[motion_[input].rate] * factor;
            coming[motion_[input].input] = value;
            m.input[k + 1] = value;
            if (m.last != nullptr) m.last[-(k + 1)] = value;
        }
    }
}

template <class Lanes>
RBDYN_INLINE_LANES void StreamedSeries::run(SeriesEvaluator& series, int first, int last, bool integrates) {
    StreamedSeries& stream = *series.stream_;
    for (int k = first; k < last; ++k) stream.advance<Lanes>(series, k, integrates);
    stream.orders_ = last;
    ++stream.newest_;
    // these are read by their places
    for (std::size_t i = 0; i < stream.motion_.size(); ++i) series.output(static_cast<int>(i));
}

RBDYN_INLINE void StreamedSeries::plain(SeriesEvaluator& series, int first, int last, bool integrates) {
    run<series::FourByTwo>(series, first, last, integrates);
}
#ifdef RBDYN_WIDE_LANES
__attribute__((target("avx2"))) RBDYN_INLINE void StreamedSeries::wide(SeriesEvaluator& series, int first, int last,
                                                                       bool integrates) {
    run<series::Four>(series, first, last, integrates);
}
__attribute__((target("avx2"))) RBDYN_INLINE double* StreamedCode::step(const Frame* frame,
                                                                        const SeriesEvaluator::Step* step,
                                                                        std::uint64_t row, double* made) {
    SeriesEvaluator& series = frame->self->series_;
    StreamedSeries& stream = *series.stream_;
    StreamedSeries::Cursor at;
    at.now = frame->now;
    at.made = made;
    at.step = static_cast<std::size_t>(step - frame->steps);
    at.row = stream.step_rows_.data() + row;
    stream.advance_step<series::Four>(series, at, static_cast<int>(frame->k));
    return at.made;
}
__attribute__((target("avx2"))) RBDYN_INLINE void StreamedCode::stage(Frame* frame, std::uint64_t left) {
    const StreamedCode& self = *frame->self;
    const StreamKinds::Place& place = self.kinds_.left[left];
    StreamedSeries& stream = *self.series_.stream_;
    const StreamedSeries::Stage& stage = stream.stages_[place.stage];
    const int k = static_cast<int>(frame->k);
    StreamedSeries::Cursor at = stream.begin(k);
    at.made = frame->made;
    at.line += place.line;
    at.series += place.series;
    at.spread += place.spread;
    at.size += place.sum;
    at.product += place.product;
    at.next = frame->next;
    at.lane += place.lane;
    at.combination += place.combination;
    at.term += place.term;
    at.step = place.step;
    at.row += place.row;
    stream.advance_stage<series::Four>(self.series_, stage, at, k);
    frame->made = at.made;
    frame->line += stage.series + stage.spreads;
    frame->next = at.next;
    frame->operand = self.kinds_.operands.data() + place.next_operand;
}
#endif

RBDYN_INLINE StreamedSeries::~StreamedSeries() = default;

RBDYN_INLINE std::size_t StreamedSeries::bytes_of_lists() const {
    const auto sum = [](const auto&... list) { return (... + (list.size() * sizeof list[0])); };
    return sum(next_, stages_, series_, spreads_, sizes_, products_, lanes_, combinations_, terms_, steps_, operands_,
               step_rows_, motion_, inputs_, others_, made_at_, given_) +
           (code_ != nullptr ? code_->bytes() : 0);
}

RBDYN_INLINE void StreamedSeries::make_code(SeriesEvaluator& series) {
    if (may_have_code_ && code_ == nullptr) code_ = StreamedCode::of(series);
    may_have_code_ = false;
}

RBDYN_INLINE void StreamedSeries::drop_code() {
    code_ = nullptr;
    may_have_code_ = false;
}

RBDYN_INLINE void StreamedSeries::take_rows(SeriesEvaluator& series, const std::vector<Row>& rows, int k) {
    double* const now = values(k);
    for (const Row& row : rows) now[row.place] = series.coefficients(static_cast<int>(row.slot))[k];
}

RBDYN_INLINE void StreamedSeries::write(int slot, Index place, double* row) {
    for (int k = 0; k < orders_; ++k) row[k] = values(k)[place];
    given_[static_cast<std::size_t>(slot)] = newest_;
}

}  // namespace rbdyn::inline RBDYN_FORM
