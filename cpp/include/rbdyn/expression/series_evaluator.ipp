// Definitions of rbdyn/expression/series_evaluator.hpp.
#pragma once

#include "rbdyn/expression/series_evaluator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/machine_code.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/program_weights.hpp"
#include "rbdyn/expression/repeated_code.hpp"
#include "rbdyn/expression/schedule.hpp"
#include "rbdyn/expression/streamed_series.hpp"
#include "rbdyn/expression/wavefront.hpp"
#include "rbdyn/series/coefficients.hpp"
#include "rbdyn/series/lanes.hpp"
#include "rbdyn/series/product_sums.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE SeriesEvaluator::SeriesEvaluator(const Program& program, int max_order, Use use)
    : program_(&program),
      top_(max_order),
      stride_(2 * (max_order + 1)),
      use_(use),
      valuations_(static_cast<std::size_t>(program.states()), -1) {
    resolve();
}

RBDYN_INLINE SeriesEvaluator::~SeriesEvaluator() = default;

RBDYN_INLINE std::size_t SeriesEvaluator::bytes_of_lists() const {
    const auto sum = [](const auto&... list) { return (... + (list.size() * sizeof list[0])); };
    return sum(copies_, sums_, lane_outputs_, linear_, with_sums_, mixed_, steps_, motion_, terms_, lane_series_,
               lane_weights_, lane_spreads_, lane_products_, lane_sums_, blocks_, first_block_, scalars_) +
           (stream_ != nullptr ? stream_->bytes_of_lists() : 0) + (all_ != nullptr ? all_->bytes_of_lists() : 0);
}

RBDYN_INLINE void SeriesEvaluator::go_without_lanes_of_four() {
    run_ = &plain;
    repeated_ = nullptr;
    if (stream_ != nullptr) stream_->drop_code();
    if (all_ != nullptr) all_->go_without_lanes_of_four();
}

RBDYN_INLINE void SeriesEvaluator::use_machine_code(bool is_used) {
    run_ = is_used ? usual() : widest();
    expansions_ = MachineCode::expansions;
    if (!is_used) repeated_ = nullptr;
    if (!is_used && stream_ != nullptr) stream_->drop_code();
    if (all_ != nullptr) all_->use_machine_code(is_used);
}

RBDYN_INLINE void SeriesEvaluator::renew() {
    std::fill(storage_.begin(), storage_.end(), 0.0);
    run_ = usual();
    if (all_ != nullptr) all_->renew();
}

RBDYN_INLINE void SeriesEvaluator::set_parameters(std::span<const double> parameters, Program::Rounding rounding) {
    program_->set_parameters(parameters, scalars_, rounding);
    if (ring_ != nullptr) {
        parameters_.assign(parameters.begin(), parameters.end());
        rounding_ = rounding;
        if (all_ != nullptr) all_->set_parameters(parameters, rounding);
    }
    if (stream_ != nullptr) return stream_->set_weights(scalars_);
    if (repeated_ != nullptr) repeated_->set_weights(scalars_);
    const auto weight = [&](const Schedule::Weighted& w) {
        if (w.scalar < 0) return w.scalar == Schedule::one ? 1.0 : 0.0;
        return scalars_[static_cast<std::size_t>(w.scalar)];
    };
    for (std::size_t i = 0; i < lane_series_.size(); ++i) {
        const Schedule::Series& w = lane_weights_[i];
        lane_series_[i].weight = series::Quad{weight(w[0]), weight(w[1]), weight(w[2]), weight(w[3])};
    }
}

RBDYN_INLINE void SeriesEvaluator::begin(double t, double unit) {
    time_ = t;
    unit_ = unit;
    if (all_ != nullptr) {
        is_elsewhere_ = is_all_there_ = true;
        return all_->begin(t, unit);
    }
    for (int& m : valuations_) m = -1;
    if (program_->uses_time()) {
        const series::View time = slot(program_->time_slot());
        time.set(0, t);
        if (top_ >= 1) time.set(1, unit);
        for (int k = 2; k <= top_; ++k) time.set(k, 0.0);
    }
}

RBDYN_INLINE SeriesEvaluator::Run SeriesEvaluator::widest() {
#ifdef RBDYN_WIDE_LANES
    if (__builtin_cpu_supports("avx2")) return &wide;
#endif
    return &plain;
}

RBDYN_INLINE SeriesEvaluator::Run SeriesEvaluator::usual() {
#ifdef RBDYN_WIDE_LANES
    if (MachineCode::is_built() && widest() == &wide) return &by_code;
#endif
    return widest();
}

RBDYN_INLINE_LANES double SeriesEvaluator::linear(const ResolvedTerm* first, const ResolvedTerm* last, double sum,
                                                  std::ptrdiff_t k) const {
    const double* w = scalars_.data();
    for (; first != last; ++first) sum += w[first->weight] * first->series[k];
    return sum;
}

RBDYN_INLINE_LANES void SeriesEvaluator::mixed(const Mixed* first, const Mixed* last, std::ptrdiff_t k) const {
    for (const Mixed* c = first; c != last; ++c) {
        double sum = k == 0 && c->weight >= 0 ? scalars_[static_cast<std::size_t>(c->weight)] : 0.0;
        sum = linear(c->first, c->last, sum, k);
        for (const double *lane = c->lane, *end = c->lane_end; lane != end; ++lane) sum += *lane;
        c->out[k] = sum;
    }
}

RBDYN_INLINE void SeriesEvaluator::set_constants() {
    for (const Constant& c : constants_) c.out.set(0, scalars_[static_cast<std::size_t>(c.weight)]);
}

template <class Lanes>
RBDYN_INLINE_LANES void SeriesEvaluator::advance_in(std::ptrdiff_t k) {
    if (k == 0) set_constants();
    advance_blocks<Lanes>(blocks_.data(), blocks_.data() + blocks_.size(), k);
    if (k == 0 && may_overflow_) overflows_ = overflows();
}

template <class Lanes>
RBDYN_INLINE_LANES void SeriesEvaluator::advance_blocks(const Block* block, const Block* end, std::ptrdiff_t k) {
    const bool flattens = k > 0 && overflows_;
    for (; block != end; ++block) {
        // none is empty
        switch (block->kind) {
            case Kind::copies: {
                const auto *c = static_cast<const series::View*>(block->first),
                           *last = static_cast<const series::View*>(block->last);
                do c->last[-k] = c->forward[k];
                while (++c != last);
                break;
            }
            case Kind::sums: {
                const Sums& s = *static_cast<const Sums*>(block->first);
                series::lanes::advance(s.series, s.series_end, s.spread, s.spread_end, s.sum, s.sum_end, k);
                for (const Lane *l = s.lane, *last = s.lane_end; l != last; ++l) l->out[k] = *l->sum;
                mixed(s.mixed, s.mixed_end, k);
                break;
            }
            case Kind::linear: {
                const auto *c = static_cast<const Linear*>(block->first),
                           *last = static_cast<const Linear*>(block->last);
                do c->out[k] = linear(c->first, c->last, 0.0, k);
                while (++c != last);
                break;
            }
            case Kind::mixed:
                mixed(static_cast<const Mixed*>(block->first), static_cast<const Mixed*>(block->last), k);
                break;
            case Kind::steps: {
                const auto *s = static_cast<const Step*>(block->first), *last = static_cast<const Step*>(block->last);
                do compute<Lanes>(*s, static_cast<int>(k));
                while (++s != last);
                break;
            }
        }
        if (flattens) flatten(*block, k);
    }
}

namespace sweeps {

// so many orders are computed while what they read is in the first cache, along so much of the row
inline constexpr int orders_at_a_time = 3, fronts_at_a_time = 8;

}  // namespace sweeps

template <class Lanes>
RBDYN_INLINE_LANES void SeriesEvaluator::sweep(int orders) {
    using sweeps::orders_at_a_time, sweeps::fronts_at_a_time;
    set_constants();
    const Block* const blocks = blocks_.data();
    // of inputs
    advance_blocks<Lanes>(blocks, blocks + first_block_.front(), 0);
    checks_ = {};
    const int count = static_cast<int>(wavefront_->chunks.size());
    for (int from = 0; from < count + orders - 1; from += fronts_at_a_time) {
        Interruption::point();
        const int to = std::min(from + fronts_at_a_time, count + orders - 1);
        for (int lowest = 0; lowest < orders; lowest += orders_at_a_time)
            for (int front = from; front < to; ++front) {
                const int first = std::max(lowest, front - count + 1),
                          last = std::min({lowest + orders_at_a_time, orders, front + 1});
                for (int k = first; k < last; ++k) advance_chunk<Lanes>(static_cast<std::size_t>(front - k), k);
                if (ring_ != nullptr && last == orders) keep(static_cast<std::size_t>(front - orders + 1), orders);
            }
    }
}

template <class Lanes>
RBDYN_INLINE_LANES void SeriesEvaluator::advance_chunk(std::size_t place, int k) {
    if (repeated_ != nullptr && repeated_->run(*this, place, k)) return;
    const Wavefront::Chunk& chunk = wavefront_->chunks[place];
    advance_blocks<Lanes>(blocks_.data() + first_block_[chunk.stages.first],
                          blocks_.data() + first_block_[chunk.stages.last], k);
    if (k == top_) return;
    const double factor = unit_ / (k + 1);
    for (std::size_t i = chunk.inputs.first; i < chunk.inputs.last; ++i) {
        const Motion& m = motion_[i];
        m.input[k + 1] = m.rate[k] * factor;
        if (m.last != nullptr) m.last[-(k + 1)] = m.input[k + 1];
    }
}

template <class Lanes>
RBDYN_INLINE_LANES void SeriesEvaluator::run(int first, int last, bool integrates) {
    if (integrates && first == 0 && wavefront_ != nullptr) return sweep<Lanes>(last);
    // an order of as many takes much longer than to ask
    constexpr std::size_t many = 1000;
    const bool asks = program_->instructions().size() > many;
    for (int k = first; k < last; ++k) {
        if (asks) Interruption::point();
        advance_in<Lanes>(k);
        if (integrates) integrate(k);
    }
}

RBDYN_INLINE void SeriesEvaluator::plain(SeriesEvaluator& series, int first, int last, bool integrates) {
    if (series.stream_ != nullptr) return StreamedSeries::plain(series, first, last, integrates);
    series.run<series::FourByTwo>(first, last, integrates);
}
#ifdef RBDYN_WIDE_LANES
__attribute__((target("avx2"))) RBDYN_INLINE void SeriesEvaluator::wide(SeriesEvaluator& series, int first, int last,
                                                                        bool integrates) {
    if (series.stream_ != nullptr) return StreamedSeries::wide(series, first, last, integrates);
    series.run<series::Four>(first, last, integrates);
}
__attribute__((target("avx2"))) RBDYN_INLINE void SeriesEvaluator::compute_wide(SeriesEvaluator& series,
                                                                                const Step& step, int k) {
    series.compute<series::Four>(step, k);
}
RBDYN_INLINE void SeriesEvaluator::make_repeated() {
    if (stream_ != nullptr) return stream_->make_code(*this);
    // code is that of one of them, and what it gains goes with how many there are
    if (repeated_ != nullptr || expansions_++ < MachineCode::expansions / static_cast<int>(wavefront_->chunks.size()))
        return;
    repeated_ = RepeatedCode::of(*this);
    if (repeated_ == nullptr) expansions_ = std::numeric_limits<int>::min();  // not again
}
RBDYN_INLINE void SeriesEvaluator::by_code(SeriesEvaluator& series, int first, int last, bool integrates) {
    if (series.wavefront_ != nullptr) {
        if (first == 0 && integrates) series.make_repeated();
        return wide(series, first, last, integrates);
    }
    if (series.code_ == nullptr) {
        if (first > 0 || series.expansions_++ < MachineCode::expansions) return wide(series, first, last, integrates);
        series.code_ = MachineCode::of(series);
        if (series.code_ == nullptr) series.expansions_ = std::numeric_limits<int>::min();  // not again
    }
    // what may overflow is looked through where it begins
    const int by_lists = series.code_ == nullptr ? last : series.may_overflow_ ? std::min(last, 1) : first;
    const auto go_by_lists = [&series, integrates](int from, int to) {
        wide(series, from, to, integrates);
        if (series.code_ != nullptr) series.code_->pass();
    };
    if (first < by_lists)
        go_by_lists(first, by_lists);
    else if (first == 0)
        series.set_constants();
    first = std::max(first, by_lists);
    if (first >= last) return;
    // nor has machine code the powers of what stays at zero
    if (series.overflows_ || !series.code_->can_begin(first) ||
        std::ranges::any_of(series.bases_, [](const double* base) { return *base == 0.0; }))
        go_by_lists(first, last);
    else
        series.code_->run(series, first, last, integrates);
}
#endif

RBDYN_INLINE void SeriesEvaluator::flatten(const Block& block, std::ptrdiff_t k) {
    const auto each = [k](const auto* first, const void* last) {
        for (; first != last; ++first) flatten(first->out, k);
    };
    switch (block.kind) {
        case Kind::copies:
            for (const auto* c = static_cast<const series::View*>(block.first); c != block.last; ++c) flatten(*c, k);
            break;
        case Kind::sums: {
            const Sums& s = *static_cast<const Sums*>(block.first);
            each(s.lane, s.lane_end);
            each(s.mixed, s.mixed_end);
            break;
        }
        case Kind::linear: each(static_cast<const Linear*>(block.first), block.last); break;
        case Kind::mixed: each(static_cast<const Mixed*>(block.first), block.last); break;
        case Kind::steps:
            each(static_cast<const Step*>(block.first), block.last);
            for (const auto* s = static_cast<const Step*>(block.first); s != block.last; ++s) flatten(s->out2, k);
            break;
    }
}

RBDYN_INLINE bool SeriesEvaluator::may_overflow(const Program& program) {
    return std::ranges::any_of(program.instructions(), [](const Instruction& i) {
        return i.code == Code::exponential || i.code == Code::hyperbolic || i.code == Code::expm1 ||
               i.code == Code::power;
    });
}

RBDYN_INLINE bool SeriesEvaluator::overflows() {
    bool any = false;
    for (int i = program_->inputs(); i < program_->slots(); ++i) {
        const series::View s = slot(i);
        if (!(std::abs(s[0]) > largest)) continue;
        s.set(0, std::copysign(std::numeric_limits<double>::infinity(), s[0]));
        any = true;
    }
    return any;
}

template <class Lanes>
RBDYN_INLINE_LANES void SeriesEvaluator::compute(const Step& i, int k) {
    const series::View& out = i.out;
    switch (i.code) {
        case Code::combine: break;
        case Code::divide: out.set(k, series::quotient<Lanes>(i.a, i.b, out, k)); break;
        case Code::square_root: {
            const double a_k = i.a[k];
            if (k > 0 && stays_at_zero(i, k))
                out.set(k, 0.0);
            else
                out.set(k, k == 0 ? std::sqrt(a_k) : series::square_root<Lanes>(a_k, out, k));
            break;
        }
        case Code::norm: norm<Lanes>(i, out, k); break;
        case Code::sine_cosine: {
            const series::View &a = i.a, &cosine = i.out2;
            if (k == 0) {
                out.set(0, std::sin(a[0]));
                cosine.set(0, std::cos(a[0]));
                break;
            }
            double* slope = i.slope;
            slope[k] = k * a[k];
            const auto [s_k, c_k] = series::integrals_of_slope<Lanes>(slope, cosine, out, k);
            cosine.set(k, -c_k);
            out.set(k, s_k);
            break;
        }
        case Code::hyperbolic: {
            const series::View &a = i.a, &cosine = i.out2;
            double* slope = i.slope;
            slope[k] = k * a[k];
            if (k == 0) {
                out.set(0, std::sinh(a[0]));
                cosine.set(0, std::cosh(a[0]));
                break;
            }
            const auto [s_k, c_k] = series::integrals_of_slope<Lanes>(slope, cosine, out, k);
            cosine.set(k, c_k);
            out.set(k, s_k);
            break;
        }
        case Code::tangent: {
            // t' = (1 - t^2) a'
            const series::View &a = i.a, &rest = i.out2;
            double* slope = i.slope;
            slope[k] = k * a[k];
            if (k == 0) {
                const double t = std::tanh(a[0]), c = std::cosh(a[0]);
                out.set(0, t);
                rest.set(0, 1.0 / (c * c));
                break;
            }
            out.set(k, series::integral_of_slope<Lanes>(slope, rest, k));
            rest.set(k, -series::square<Lanes>(out, k));
            break;
        }
        case Code::angle: {
            // (x^2 + y^2) p' = x y' - y x'
            const series::View &y = i.a, &x = i.b, &square = i.c;
            double* slope = i.slope;
            if (k == 0) {
                out.set(0, std::atan2(y[0], x[0]));
                break;
            }
            double turn = 0.0;
            for (int j = 1; j <= k; ++j) turn += j * (y[j] * x[k - j] - x[j] * y[k - j]);
            const double sum = series::dot<Lanes>(slope + 1, square.from(k - 1), k - 1);
            slope[k] = (turn - sum) / square[0];
            out.set(k, slope[k] / k);
            break;
        }
        case Code::call: call(*i.call, k); break;
        case Code::exponential: {
            const series::View& a = i.a;
            double* slope = i.slope;
            slope[k] = k * a[k];
            if (k == 0)
                out.set(0, i.b.forward != nullptr ? std::pow(i.b[0], i.c[0]) : std::exp(a[0]));
            else
                out.set(k, series::integral_of_slope<Lanes>(slope, out, k));
            break;
        }
        case Code::expm1: {
            const series::View &a = i.a, &all = i.out2;
            double* slope = i.slope;
            slope[k] = k * a[k];
            if (k == 0) {
                out.set(0, std::expm1(a[0]));
                all.set(0, std::exp(a[0]));
                break;
            }
            out.set(k, series::integral_of_slope<Lanes>(slope, all, k));
            all.set(k, out[k]);
            break;
        }
        case Code::log1p:
        case Code::arsinh:
        case Code::artanh: {
            // d y' = a', d = 1 + a, sqrt(1 + a^2), for which d' = a y', or 1 - a^2
            const series::View &a = i.a, &divisor = i.out2;
            double* slope = i.slope;
            if (k == 0) {
                out.set(0, inverse(i.code, a[0]));
                divisor.set(0, inverse_divisor(i.code, a[0]));
                break;
            }
            const double sum = series::dot<Lanes>(slope + 1, divisor.from(k - 1), k - 1);
            out.set(k, (a[k] - sum / k) / divisor[0]);
            slope[k] = k * out[k];
            if (i.code == Code::log1p)
                divisor.set(k, a[k]);
            else if (i.code == Code::arsinh)
                divisor.set(k, series::integral_of_slope<Lanes>(slope, a, k));
            else
                divisor.set(k, -series::square<Lanes>(a, k));
            break;
        }
        case Code::logarithm: {
            // a l' = a'
            const series::View& a = i.a;
            double* slope = i.slope;
            if (k == 0) {
                out.set(0, std::log(a[0]));
                break;
            }
            const double sum = series::dot<Lanes>(slope + 1, a.from(k - 1), k - 1);
            out.set(k, (a[k] - sum / k) / a[0]);
            slope[k] = k * out[k];
            break;
        }
        case Code::power: {
            // a p' = r a' p
            const series::View& a = i.a;
            double* slope = i.slope;
            slope[k] = k * a[k];
            if (k == 0) {
                out.set(0, std::pow(a[0], i.value));
                break;
            }
            if (stays_at_zero(i, k)) {
                out.set(k, 0.0);
                break;
            }
            const double weighted = series::dot<Lanes>(slope + 1, out.from(k - 1), k) / k;
            const double plain = series::dot<Lanes>(a.forward + 1, out.from(k - 1), k);
            out.set(k, ((i.value + 1.0) * weighted - plain) / a[0]);
            break;
        }
    }
}

RBDYN_INLINE void SeriesEvaluator::call(const Program::Call& c, int k) {
    std::vector<double> x, y(c.results.size(), std::numeric_limits<double>::quiet_NaN());
    if (k == 0) {
        for (const int argument : c.arguments) x.push_back(slot(argument)[0]);
        (*c.function)(x.data(), y.data());
    }
    for (std::size_t i = 0; i < y.size(); ++i) slot(c.results[i]).set(k, y[i]);
}

template <class Lanes>
RBDYN_INLINE_LANES void SeriesEvaluator::norm(const Step& i, const series::View& out, int k) {
    int& m = *i.valuation;
    const series::View part[3] = {i.a, i.b, i.c};
    if (m < 0) {
        const bool ignored = i.weight >= 0 && k < scalars_[static_cast<std::size_t>(i.weight)];
        const double x = part[0][k], y = part[1][k], z = part[2][k];
        if (ignored || (x == 0.0 && y == 0.0 && z == 0.0)) {
            out.set(k, 0.0);
        } else {
            m = k;
            out.set(k, std::sqrt(x * x + y * y + z * z));
        }
        return;
    }
    const int j = k - m;
    double square = 0.0;
    for (const series::View& v : part) square += series::dot<Lanes>(v.forward + m, v.from(k), j + 1);
    const double inner = series::dot<Lanes>(out.forward + m + 1, out.from(k - 1), j - 1);
    out.set(k, (square - inner) / (2.0 * out[m]));
}

RBDYN_INLINE void SeriesEvaluator::resolve() {
    Schedule schedule(*program_);
    may_overflow_ = may_overflow(*program_);
    // what fits the caches is at hand anyway; who has to see all of order 0 first has to see all
    constexpr std::size_t large = 0x1p20;
    const std::size_t size =
        sizeof(double) * static_cast<std::size_t>(program_->slots()) * static_cast<std::size_t>(stride_) +
        sizeof(series::LaneValues) * schedule.series.size() * static_cast<std::size_t>(top_ + 1);
    const std::vector<int> backwards = read_backwards(*program_);
    is_large_ = size > large;
    const bool may_repeat =
        program_->instructions().size() >= RepeatedCode::fewest_instructions && RepeatedCode::is_usable();
    if ((is_large_ || may_repeat) && !may_overflow_ && !program_->has_calls()) {
        auto wavefront = std::make_unique<const Wavefront>(*program_, schedule, top_,
                                                           may_repeat ? RepeatedCode::fewest_chunks : 0, is_large_);
        if (!wavefront->chunks.empty()) wavefront_ = std::move(wavefront);
    }
    is_large_ = is_large_ && wavefront_ != nullptr;
    make_room(wavefront_ != nullptr, backwards, schedule);
    if (wavefront_ != nullptr && !wavefront_->is_skewed) {
        stream_ = std::make_unique<StreamedSeries>(*program_, schedule, *wavefront_, top_, backwards);
        for (const Instruction* i : stream_->steps()) steps_.push_back(step(*i));
        for (const Instruction* i : schedule.others)
            if (i->code == Code::combine && i->terms == 0 && i->weight >= 0)
                constants_.push_back({slot(i->out), i->weight});
        return add_motion(backwards);
    }
    std::size_t terms = 0;
    for (const Instruction& i : program_->instructions()) terms += static_cast<std::size_t>(i.terms);
    terms_.reserve(terms);
    // what points into a list comes after the list is whole
    const auto length = static_cast<std::size_t>(top_ + 1);
    const auto [lane_place, places] = lane_places(schedule);
    lanes_.resize(places * length);
    lane_series_.reserve(schedule.series.size());
    lane_products_.reserve(schedule.products.size());
    lane_sums_.reserve(schedule.sums.size());
    sums_.reserve(schedule.stages.size());
    with_sums_.reserve(schedule.combinations.size());
    const auto is_step = [](const Instruction* i) { return i->code != Code::combine; };
    const auto steps = static_cast<std::size_t>(std::ranges::count_if(schedule.others, is_step));
    steps_.reserve(steps);
    linear_.reserve(schedule.others.size() - steps);
    motion_.reserve(static_cast<std::size_t>(program_->inputs()));
    std::vector<std::pair<std::size_t, std::size_t>> before{{0, 0}};  // each: so many with weights, so many spread
    for (std::size_t i = 0; i < schedule.series.size(); ++i) {
        const Schedule::Series& s = schedule.series[i];
        series::LaneValues* const values = lanes_.data() + lane_place[i] * length;
        if (s[0].scalar == Schedule::one && std::count(s.begin(), s.end(), s[0]) == Schedule::lanes) {
            lane_spreads_.push_back({slot(s[0].slot).forward, values});
        } else {
            series::LaneSeries lane{{}, {}, values};
            for (std::size_t l = 0; l < s.size(); ++l) lane.from[l] = slot(s[l].slot).forward;
            lane_series_.push_back(lane);
            lane_weights_.push_back(s);
        }
        before.emplace_back(lane_series_.size(), lane_spreads_.size());
    }
    for (const auto& [x, y] : schedule.products)
        lane_products_.push_back({lanes_.data() + lane_place[x] * length, lanes_.data() + lane_place[y] * length});
    for (const auto& [first, last] : schedule.sums)
        lane_sums_.push_back(
            {lane_products_.data() + first, lane_products_.data() + last, series::Quad{}, series::Quad{}});
    // where each stage's begin, by kind; a copy comes after the stage that writes its series, those of inputs first
    const auto add_copies = [&](int from, int to) {
        for (int one = from; one < to; ++one)
            if (std::binary_search(backwards.begin(), backwards.end(), one)) copies_.push_back(slot(one));
    };
    struct Counts {
        std::size_t copies, sums, lanes, with_sums, linear, mixed, steps;
    };
    const auto counts = [&]() -> Counts {
        return {copies_.size(), sums_.size(),  lane_outputs_.size(), with_sums_.size(),
                linear_.size(), mixed_.size(), steps_.size()};
    };
    std::vector<Counts> ends{counts()};
    add_copies(0, program_->inputs() + 1);
    ends.push_back(counts());
    for (const Schedule::Stage& stage : schedule.stages) {
        if (stage.sums.first != stage.sums.last) {
            const auto [series_from, spread_from] = before[stage.series.first];
            const auto [series_to, spread_to] = before[stage.series.last];
            sums_.push_back({lane_series_.data() + series_from, lane_series_.data() + series_to,
                             lane_spreads_.data() + spread_from, lane_spreads_.data() + spread_to,
                             lane_sums_.data() + stage.sums.first, lane_sums_.data() + stage.sums.last, nullptr,
                             nullptr, nullptr, nullptr});
        }
        for (std::size_t i = stage.combinations.first; i < stage.combinations.last; ++i) {
            const Schedule::Combination& c = schedule.combinations[i];
            const double* sum = reinterpret_cast<const double*>(&lane_sums_[c.sum].sum) + c.first_lane;
            double* const out = slot(c.instruction->out).forward;
            if (c.lanes == 1 && c.instruction->terms == 0 && c.instruction->weight < 0) {
                lane_outputs_.push_back({out, sum});
            } else {
                const ResolvedTerm* const first = add_terms(*c.instruction);
                with_sums_.push_back(
                    {out, c.instruction->weight, first, terms_.data() + terms_.size(), sum, sum + c.lanes});
            }
            add_copies(c.instruction->out, c.instruction->out + 1);
        }
        for (std::size_t i = stage.others.first; i < stage.others.last; ++i) {
            const Instruction& other = *schedule.others[i];
            if (other.code != Code::combine) {
                steps_.push_back(step(other));
                continue;
            }
            if (other.terms == 0) {
                if (other.weight >= 0) constants_.push_back({slot(other.out), other.weight});
                continue;
            }
            const ResolvedTerm* const first = add_terms(other);
            if (other.weight < 0)
                linear_.push_back({slot(other.out).forward, first, terms_.data() + terms_.size()});
            else
                mixed_.push_back(
                    {slot(other.out).forward, other.weight, first, terms_.data() + terms_.size(), nullptr, nullptr});
            add_copies(other.out, other.out + 1);
        }
        ends.push_back(counts());
    }
    // of sums, combinations and steps, then copies
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        const Counts &from = ends[i], &to = ends[i + 1];
        if (i > 0) first_block_.push_back(blocks_.size());
        const auto add = [&](Kind kind, const auto& list, std::size_t Counts::*count) {
            if (from.*count != to.*count) blocks_.push_back({kind, list.data() + from.*count, list.data() + to.*count});
        };
        for (std::size_t s = from.sums; s < to.sums; ++s) {
            sums_[s].lane = lane_outputs_.data() + from.lanes;
            sums_[s].lane_end = lane_outputs_.data() + to.lanes;
            sums_[s].mixed = with_sums_.data() + from.with_sums;
            sums_[s].mixed_end = with_sums_.data() + to.with_sums;
        }
        add(Kind::sums, sums_, &Counts::sums);
        add(Kind::linear, linear_, &Counts::linear);
        add(Kind::mixed, mixed_, &Counts::mixed);
        add(Kind::steps, steps_, &Counts::steps);
        add(Kind::copies, copies_, &Counts::copies);
    }
    first_block_.push_back(blocks_.size());
    add_motion(backwards);
}

RBDYN_INLINE std::pair<std::vector<std::size_t>, std::size_t> SeriesEvaluator::lane_places(
    const Schedule& schedule) const {
    const std::size_t all = schedule.series.size();
    std::vector<std::size_t> place(all);
    if (!is_large_ || use_ == Use::any) {
        std::iota(place.begin(), place.end(), std::size_t{0});
        return {std::move(place), all};
    }
    // of each chunk the first series; of each series its chunk, and the last one that reads it
    const std::vector<Wavefront::Chunk>& chunks = wavefront_->chunks;
    std::vector<std::size_t> first{0}, chunk_of(all, 0), last_reader(all, 0);
    std::size_t most = 1;
    for (std::size_t c = 0; c < chunks.size(); ++c) {
        std::size_t end = first.back();
        for (std::size_t s = chunks[c].stages.first; s < chunks[c].stages.last; ++s) {
            const Schedule::Stage& stage = schedule.stages[s];
            for (std::size_t sum = stage.sums.first; sum < stage.sums.last; ++sum)
                for (std::size_t p = schedule.sums[sum].first; p < schedule.sums[sum].last; ++p)
                    last_reader[schedule.products[p].x] = last_reader[schedule.products[p].y] = c;
            end = stage.series.last;
        }
        std::fill(chunk_of.begin() + static_cast<std::ptrdiff_t>(first.back()),
                  chunk_of.begin() + static_cast<std::ptrdiff_t>(end), c);
        most = std::max(most, end - first.back());
        first.push_back(end);
    }
    // it does so at its last order so many chunks later (sweep()); a chunk's are side by side
    const std::size_t behind = static_cast<std::size_t>(top_ + sweeps::fronts_at_a_time);
    std::size_t chunks_apart = 1;
    for (std::size_t i = 0; i < all; ++i)
        chunks_apart = std::max(chunks_apart, std::min(last_reader[i] + behind, chunks.size()) - chunk_of[i]);
    for (std::size_t i = 0; i < all; ++i) place[i] = chunk_of[i] % chunks_apart * most + (i - first[chunk_of[i]]);
    return {std::move(place), chunks_apart * most};
}

RBDYN_INLINE void SeriesEvaluator::make_room(bool is_large, const std::vector<int>& backwards,
                                             const Schedule& schedule) {
    const auto slots = static_cast<std::size_t>(program_->slots());
    if (!is_large) {
        storage_.assign(slots * static_cast<std::size_t>(stride_), 0.0);
        return;
    }
    is_both_ways_.assign(slots, 0);
    const auto mark = [&](int slot) {
        if (slot >= 0) is_both_ways_[static_cast<std::size_t>(slot)] = 1;
    };
    for (const int slot : backwards) mark(slot);
    mark(program_->time_slot());
    for (const Instruction& i : program_->instructions()) {
        if (i.code == Code::combine) continue;
        mark(i.out);
        mark(i.out2);
    }
    // inputs lie as far from one another, all of them
    const auto inputs = is_both_ways_.begin() + program_->inputs();
    if (std::find(is_both_ways_.begin(), inputs, 1) != inputs) std::fill(is_both_ways_.begin(), inputs, 1);
    const auto row = [&](std::size_t slot) { return is_both_ways_[slot] != 0 ? 2 * (top_ + 1) : top_ + 1; };
    stride_ = row(0);
    if (is_large_ && use_ == Use::states && wavefront_->is_skewed) {
        std::vector<int> rows(slots);
        for (std::size_t slot = 0; slot < slots; ++slot) rows[slot] = row(slot);
        ring_ = SlotRing::of(*program_, schedule, *wavefront_, top_,
                             static_cast<std::size_t>(top_ + sweeps::fronts_at_a_time), rows);
        if (ring_ != nullptr) return storage_.assign(static_cast<std::size_t>(ring_->size()), 0.0);
    }
    places_.resize(slots + 1);
    for (std::size_t slot = 0; slot < slots; ++slot) places_[slot + 1] = places_[slot] + row(slot);
    storage_.assign(static_cast<std::size_t>(places_.back()), 0.0);
}

RBDYN_INLINE void SeriesEvaluator::keep(std::size_t chunk, int orders) {
    const Schedule::Range& inputs = wavefront_->chunks[chunk].inputs;
    for (std::size_t i = inputs.first; i < inputs.last; ++i) {
        checks_[0] += 0.0 * motion_[i].rate[0];
        checks_[1] += 0.0 * motion_[i].rate[top_ - 1];
    }
    for (const auto& [from, to] : ring_->copies(chunk))
        std::copy_n(storage_.data() + from, orders, storage_.data() + to);
}

RBDYN_INLINE SeriesEvaluator& SeriesEvaluator::all_slots() const {
    if (all_ == nullptr) {
        all_ = std::make_unique<SeriesEvaluator>(*program_, top_, Use::expansion);
        all_->run_ = run_;
        all_->set_parameters(parameters_, rounding_);
    }
    if (!is_all_there_) {
        is_all_there_ = true;
        all_->let_zeros_stay(zeros_stay_);
        all_->begin(time_, unit_);
        for (int i = 0; i < program_->inputs(); ++i)
            all_->set_input(i, 0, storage_[static_cast<std::size_t>(ring_->kept(i))]);
        all_->expand(top_, is_whole_);
    }
    return *all_;
}

RBDYN_INLINE const double* SeriesEvaluator::ring_coefficients(int slot_index) const {
    const std::ptrdiff_t kept = ring_->kept(slot_index);
    if (!is_elsewhere_ && kept >= 0) return storage_.data() + kept;
    return all_slots().coefficients(slot_index);
}

RBDYN_INLINE double* SeriesEvaluator::ring_row(int slot_index) {
    const std::ptrdiff_t kept = ring_->kept(slot_index);
    if (!is_elsewhere_ && kept >= 0) return storage_.data() + kept;
    return all_slots().row(slot_index);
}

RBDYN_INLINE void SeriesEvaluator::add_motion(const std::vector<int>& backwards) {
    for (int i = 0; i < std::min(program_->inputs(), program_->outputs()); ++i) {
        const int input = wavefront_ == nullptr ? i : wavefront_->inputs[static_cast<std::size_t>(i)];
        const bool is_copied = std::binary_search(backwards.begin(), backwards.end(), input);
        motion_.push_back(
            {slot(input).forward, slot(program_->output(input)).forward, is_copied ? slot(input).last : nullptr});
    }
}

RBDYN_INLINE const SeriesEvaluator::ResolvedTerm* SeriesEvaluator::add_terms(const Instruction& i) {
    const ResolvedTerm* first = terms_.data() + terms_.size();
    for (int j = 0; j < i.terms; ++j) {
        const Term& t = program_->terms(i)[j];
        terms_.push_back({slot(t.slot).forward, t.weight});
    }
    return first;
}

RBDYN_INLINE std::vector<int> SeriesEvaluator::read_backwards(const Program& program) {
    std::vector<int> slots;
    for (const Instruction& i : program.instructions()) {
        if (i.code == Code::norm) slots.insert(slots.end(), {i.a, i.b, i.c});
        if (i.code == Code::logarithm || i.code == Code::arsinh || i.code == Code::artanh) slots.push_back(i.a);
        if (i.code == Code::angle) slots.push_back(i.c);
    }
    std::sort(slots.begin(), slots.end());
    slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
    return slots;
}

RBDYN_INLINE SeriesEvaluator::Step SeriesEvaluator::step(const Instruction& i) {
    const auto view = [&](int index) { return index >= 0 ? slot(index) : series::View{nullptr, nullptr}; };
    Step s{i.code,    i.weight, view(i.out), view(i.out2), view(i.a), view(i.b),
           view(i.c), nullptr,  nullptr,     i.value,      nullptr};
    if (i.code == Code::norm)
        s.valuation = &valuations_[static_cast<std::size_t>(i.extra)];
    else if (i.code == Code::call)
        s.call = &program_->calls()[static_cast<std::size_t>(i.extra)];
    else if (i.extra >= 0)
        s.slope = slot(i.extra).forward;
    if (i.code == Code::power) bases_.push_back(s.a.forward);
    return s;
}

}  // namespace rbdyn::inline RBDYN_FORM
