// Definitions of rbdyn/expression/series_abreast.hpp.
#pragma once

#include "rbdyn/expression/series_abreast.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/expression/abreast_code.hpp"
#include "rbdyn/expression/abreast_run.hpp"
#include "rbdyn/expression/abreast_tape.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/series/abreast.hpp"

namespace rbdyn::inline RBDYN_FORM {

#ifdef RBDYN_HAS_LANES
namespace abreast {

template <class Lanes>
RBDYN_ABREAST void instruct(Tape& tape, const Tape::Other& other, int k) {
    instruct(other, tape, Tape::in<Lanes>(tape.cells), Tape::in<Lanes>(tape.weights), k);
}

inline void two_of_two(Tape& tape, int order, bool whole, const AbreastCode*) {
    expand<kernels::Four>(tape, order, whole, nullptr);
}
inline void log_steps_two_of_two(Tape::Sizes& s, int order, const Tape::Block& scale,
                                 const Tape::Block& log_tolerance) {
    log_steps<kernels::Four>(s, order, scale, log_tolerance);
}
inline void increments_two_of_two(Tape& tape, int count, int order, const Tape::Block& place, Tape::Block* out) {
    increments<kernels::Four>(tape, count, order, place, out);
}
inline void rows_two_of_two(Tape& tape, Tape::Place series, int count, double* const* to) {
    rows<kernels::Four>(tape, series, count, to);
}
inline void sizes_two_of_two(Tape& tape, Tape::Place first, int count, int order, Tape::Block* out) {
    sizes<kernels::Four>(tape, first, count, order, out);
}
#if defined(__x86_64__)
__attribute__((target("avx2"))) inline void sizes_four(Tape& tape, Tape::Place first, int count, int order,
                                                       Tape::Block* out) {
    sizes<kernels::Four>(tape, first, count, order, out);
}
__attribute__((target("avx512f"))) inline void sizes_eight(Tape& tape, Tape::Place first, int count, int order,
                                                           Tape::Block* out) {
    sizes<kernels::Eight>(tape, first, count, order, out);
}
__attribute__((target("avx2"))) inline void log_steps_four(Tape::Sizes& s, int order, const Tape::Block& scale,
                                                           const Tape::Block& log_tolerance) {
    log_steps<kernels::Four>(s, order, scale, log_tolerance);
}
__attribute__((target("avx512f"))) inline void log_steps_eight(Tape::Sizes& s, int order, const Tape::Block& scale,
                                                               const Tape::Block& log_tolerance) {
    log_steps<kernels::Eight>(s, order, scale, log_tolerance);
}
__attribute__((target("avx2"))) inline void increments_four(Tape& tape, int count, int order, const Tape::Block& place,
                                                            Tape::Block* out) {
    increments<kernels::Four>(tape, count, order, place, out);
}
__attribute__((target("avx2"))) inline void rows_four(Tape& tape, Tape::Place series, int count, double* const* to) {
    rows<kernels::Four>(tape, series, count, to);
}
__attribute__((target("avx512f"))) inline void increments_eight(Tape& tape, int count, int order,
                                                                const Tape::Block& place, Tape::Block* out) {
    increments<kernels::Eight>(tape, count, order, place, out);
}
__attribute__((target("avx512f"))) inline void rows_eight(Tape& tape, Tape::Place series, int count,
                                                          double* const* to) {
    rows<kernels::Eight>(tape, series, count, to);
}
__attribute__((target("avx2"))) inline void four(Tape& tape, int order, bool whole, const AbreastCode* code) {
    expand<kernels::Four>(tape, order, whole, code);
}
__attribute__((target("avx2"))) inline void instruct_four(Tape& tape, const Tape::Other& other, int k) {
    instruct<kernels::Four>(tape, other, k);
}
__attribute__((target("avx512f"))) inline void eight(Tape& tape, int order, bool whole, const AbreastCode* code) {
    expand<kernels::Eight>(tape, order, whole, code);
}
__attribute__((target("avx512f"))) inline void instruct_eight(Tape& tape, const Tape::Other& other, int k) {
    instruct<kernels::Eight>(tape, other, k);
}
#endif

}  // namespace abreast
#endif

RBDYN_INLINE std::vector<SeriesAbreast::Processor> SeriesAbreast::processors() {
    std::vector<Processor> all = {Processor::any};
#if defined(RBDYN_HAS_LANES) && defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) all.push_back(Processor::four);
    if (__builtin_cpu_supports("avx512f")) all.push_back(Processor::eight);
#endif
    return all;
}

RBDYN_INLINE SeriesAbreast::Processor SeriesAbreast::widest() {
    static const Processor known = processors().back();
    return known;
}

RBDYN_INLINE bool SeriesAbreast::takes(const Program& program) {
#ifdef RBDYN_HAS_LANES
    return !program.has_calls() && program.outputs() >= program.inputs();
#else
    return false;
#endif
}

RBDYN_INLINE SeriesAbreast::SeriesAbreast(const Program& program, int order, Processor processor)
    : order_(order),
      width_(processor == Processor::eight ? 8 : 4),
      stride_(order + 1),
      inputs_(program.inputs()),
      slots_(program.slots()),
      may_overflow_(SeriesEvaluator::may_overflow(program)),
      instructions_(program.instructions()),
      tape_(std::make_unique<abreast::Tape>()) {
    for (const Instruction& i : instructions_) {
        terms_.insert(terms_.end(), program.terms(i), program.terms(i) + i.terms);
        products_.insert(products_.end(), program.products(i), program.products(i) + i.products);
    }
    abreast::Tape& tape = *tape_;
    tape.vector = static_cast<abreast::Tape::Place>(static_cast<std::size_t>(width_) * sizeof(double));
    tape.stride = stride_ * tape.vector;
    abreast::write(program, tape);
    const auto blocks = [&](std::size_t vectors) {
        return (vectors * static_cast<std::size_t>(width_) + most - 1) / most;
    };
    tape.cells.resize(blocks(static_cast<std::size_t>(tape.rows) * static_cast<std::size_t>(stride_)));
    tape.sum.resize(blocks(static_cast<std::size_t>(tape.sum_count)));
    tape.next.resize(blocks(static_cast<std::size_t>(tape.sum_count)));
    tape.part.resize(blocks(static_cast<std::size_t>(tape.part_count)));
    tape.next_part.resize(blocks(static_cast<std::size_t>(tape.part_count)));
    tape.powers.resize(blocks(static_cast<std::size_t>(order)));
    tape.increments_there.resize(blocks(static_cast<std::size_t>(inputs_)));
    tape.weights.resize(blocks(static_cast<std::size_t>(program.scalars())));
#ifdef RBDYN_HAS_LANES
    tape.run = abreast::two_of_two;
    tape.sizes = abreast::sizes_two_of_two;
    tape.log_steps = abreast::log_steps_two_of_two;
    tape.to_rows = abreast::rows_two_of_two;
    tape.increments = abreast::increments_two_of_two;
#if defined(__x86_64__)
    if (processor == Processor::four) {
        tape.run = abreast::four;
        tape.sizes = abreast::sizes_four;
        tape.log_steps = abreast::log_steps_four;
        tape.to_rows = abreast::rows_four;
        tape.increments = abreast::increments_four;
        tape.instruct = abreast::instruct_four;
    }
    if (processor == Processor::eight) {
        tape.run = abreast::eight;
        tape.sizes = abreast::sizes_eight;
        tape.log_steps = abreast::log_steps_eight;
        tape.to_rows = abreast::rows_eight;
        tape.increments = abreast::increments_eight;
        tape.instruct = abreast::instruct_eight;
    }
#endif
#endif
}

RBDYN_INLINE SeriesAbreast::~SeriesAbreast() = default;

RBDYN_INLINE bool SeriesAbreast::fits(const Program& program, int order) const {
    if (order != order_ || program.instructions().size() != instructions_.size() ||
        static_cast<std::size_t>(std::min(program.inputs(), program.outputs())) != tape_->motion.size())
        return false;
    const std::vector<abreast::Tape::Place>& outputs = tape_->outputs;
    const auto count = static_cast<std::size_t>(program.outputs()) + program.switches().size();
    if (count != outputs.size()) return false;
    for (std::size_t i = 0; i < count; ++i)
        if (program.output(static_cast<int>(i)) * tape_->stride != outputs[i]) return false;
    std::size_t term = 0, product = 0;
    for (std::size_t n = 0; n < instructions_.size(); ++n) {
        const Instruction &i = program.instructions()[n], &own = instructions_[n];
        if (i.code != own.code || i.out != own.out || i.out2 != own.out2 || i.a != own.a || i.b != own.b ||
            i.c != own.c || i.terms != own.terms || i.products != own.products || i.weight != own.weight ||
            i.extra != own.extra || i.value != own.value)
            return false;
        for (int k = 0; k < i.terms; ++k, ++term)
            if (program.terms(i)[k].slot != terms_[term].slot || program.terms(i)[k].weight != terms_[term].weight)
                return false;
        for (int k = 0; k < i.products; ++k, ++product) {
            const ProductTerm &p = program.products(i)[k], &q = products_[product];
            if (p.a != q.a || p.b != q.b || p.weight != q.weight) return false;
        }
    }
    return true;
}

RBDYN_INLINE void SeriesAbreast::expand(std::span<const Motion> motions, bool whole) {
    abreast::Tape& tape = *tape_;
    const auto width = static_cast<std::size_t>(width_), stride = static_cast<std::size_t>(stride_);
    double *cells = abreast::Tape::lanes_of(tape.cells), *weights = abreast::Tape::lanes_of(tape.weights);
    for (std::size_t l = 0; l < width; ++l) {
        // lanes to spare have another one's
        const Motion& m = motions[l < motions.size() ? l : 0];
        tape.t.lanes[l] = m.t;
        tape.unit.lanes[l] = m.unit;
        for (std::size_t i = 0; i < m.state.size(); ++i) cells[i * stride * width + l] = m.state[i];
        for (std::size_t i = 0; i < m.weights.size(); ++i) weights[i * width + l] = m.weights[i];
    }
    tape.begins_at_zero.fill(false);
    tape.known_sizes = 0;
    const bool are_its_ones = std::ranges::all_of(motions, [this](const Motion& m) { return has_its_ones(m.weights); });
    tape.run(tape, order_, whole, are_its_ones ? code() : nullptr);
}

RBDYN_INLINE bool SeriesAbreast::has_its_ones(std::span<const double> weights) const {
    const std::vector<signed char>& ones = tape_->ones;
    for (std::size_t i = 0; i < ones.size(); ++i)
        if (ones[i] != 0 && weights[i] != ones[i]) return false;
    return true;
}

RBDYN_INLINE const abreast::AbreastCode* SeriesAbreast::code() {
    if (code_ == nullptr && tape_->instruct != nullptr && expansions_++ == abreast::AbreastCode::expansions)
        code_ = abreast::AbreastCode::of(*tape_, order_);
    return code_.get();
}

RBDYN_INLINE void SeriesAbreast::use_machine_code(bool is_used) {
    code_.reset();
    expansions_ = is_used ? abreast::AbreastCode::expansions : abreast::AbreastCode::expansions + 1;
}

RBDYN_INLINE bool SeriesAbreast::is_good(int motion) const {
    const auto l = static_cast<std::size_t>(motion);
    if (tape_->begins_at_zero[l] || tape_->check.lanes[l] != 0.0) return false;
    if (!may_overflow_) return true;
    // one motion alone has no slopes where a denominator is that large
    const auto width = static_cast<std::size_t>(width_);
    const double* cells = abreast::Tape::lanes_of(tape_->cells);
    for (int slot = inputs_; slot < slots_; ++slot)
        if (!(std::abs(cells[static_cast<std::size_t>(slot * stride_) * width + l]) <= SeriesEvaluator::largest))
            return false;
    return true;
}

RBDYN_INLINE void SeriesAbreast::copy(int motion, int slot, std::size_t count, SeriesEvaluator& series) const {
    const auto width = static_cast<std::size_t>(width_);
    const double* from = abreast::Tape::lanes_of(tape_->cells) + static_cast<std::size_t>(slot * stride_) * width +
                         static_cast<std::size_t>(motion);
    double* to = series.row(slot);
#ifdef RBDYN_HAS_LANES
#pragma GCC unroll 4
#endif
    for (std::size_t k = 0; k < count; ++k) to[k] = from[k * width];
}

RBDYN_INLINE void SeriesAbreast::give(int motion, SeriesEvaluator& series, std::span<const int> slots,
                                      bool whole) const {
    const auto count = static_cast<std::size_t>(stride_);
    for (const int slot : slots) copy(motion, slot, whole ? count : count - 1, series);
    const auto width = static_cast<std::size_t>(width_), last = static_cast<std::size_t>(order_ - 1) * width;
    for (const auto& [input, rate] : tape_->motion) {
        const auto slot = static_cast<int>(rate / tape_->stride);
        const double* from = abreast::Tape::lanes_of(tape_->cells) + static_cast<std::size_t>(slot * stride_) * width +
                             static_cast<std::size_t>(motion);
        double* to = series.row(slot);
        to[0] = from[0];
        to[order_ - 1] = from[last];
    }
}

RBDYN_INLINE void SeriesAbreast::give_all(int motion, SeriesEvaluator& series, bool whole) const {
    const auto count = static_cast<std::size_t>(stride_);
    const int inputs = series.program().inputs();
    for (int slot = 0; slot < series.program().slots(); ++slot)
        copy(motion, slot, whole || slot < inputs ? count : count - 1, series);
}

RBDYN_INLINE void SeriesAbreast::give_states(std::span<SeriesEvaluator* const> series) const {
    std::array<double*, most> to{};
    for (int slot = 0; slot < inputs_; ++slot) {
        for (std::size_t l = 0; l < series.size(); ++l) to[l] = series[l]->row(slot);
        tape_->to_rows(*tape_, slot * tape_->stride, stride_, to.data());
    }
}

RBDYN_INLINE void SeriesAbreast::find_log_steps(int first, int count, std::span<const double> scales,
                                                std::span<const double> log_tolerances) const {
    abreast::Tape::Block scale, log_tolerance;
    for (std::size_t l = 0; l < most; ++l) {
        // lanes to spare have another one's
        const std::size_t motion = l < scales.size() ? l : 0;
        scale.lanes[l] = scales[motion];
        log_tolerance.lanes[l] = log_tolerances[motion];
    }
    abreast::Tape::Sizes& s = tape_->all_sizes[sizes_of(first, count)];
    tape_->log_steps(s, order_, scale, log_tolerance);
    s.has_steps = true;
}

RBDYN_INLINE std::optional<double> SeriesAbreast::log_step(int motion, int first, int count) const {
    const abreast::Tape::Sizes& s = tape_->all_sizes[sizes_of(first, count)];
    if (!s.has_steps || std::bit_cast<std::uint64_t>(s.is_known.lanes[motion]) == 0) return std::nullopt;
    return s.log_step.lanes[motion];
}

RBDYN_INLINE void SeriesAbreast::find_increments(std::span<const double> places) const {
    for (std::size_t l = 0; l < most; ++l) tape_->places.lanes[l] = places[l < places.size() ? l : 0];
    tape_->increments(*tape_, inputs_, order_, tape_->places, tape_->increments_there.data());
}

RBDYN_INLINE double SeriesAbreast::increment(int motion, int input) const {
    return abreast::Tape::lanes_of(tape_->increments_there)[input * width_ + motion];
}

RBDYN_INLINE std::size_t SeriesAbreast::sizes_of(int first, int count) const {
    abreast::Tape& tape = *tape_;
    std::size_t i = 0;
    while (i < tape.known_sizes && (tape.all_sizes[i].first != first || tape.all_sizes[i].count != count)) ++i;
    if (i == tape.known_sizes) {
        if (++tape.known_sizes > tape.all_sizes.size()) tape.all_sizes.emplace_back();
        abreast::Tape::Sizes& s = tape.all_sizes[i];
        s.first = first;
        s.count = count;
        s.values.resize(static_cast<std::size_t>(order_ + 1));
        s.has_steps = false;
        tape.sizes(tape, first * tape.stride, count, order_, s.values.data());
    }
    return i;
}

RBDYN_INLINE void SeriesAbreast::sizes(int motion, int first, int count, double* out) const {
    const double* from = abreast::Tape::lanes_of(tape_->all_sizes[sizes_of(first, count)].values) + motion;
    for (int k = 0; k <= order_; ++k, from += width_) out[k] = *from;
}

RBDYN_INLINE std::size_t SeriesAbreast::bytes() const { return tape_->cells.size() * sizeof(abreast::Tape::Block); }

}  // namespace rbdyn::inline RBDYN_FORM
