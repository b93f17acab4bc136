// Definitions of rbdyn/expression/series_abreast.hpp.
#pragma once

#include "rbdyn/expression/series_abreast.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/schedule.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/series/abreast.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What is computed at each order, in its order, and where: rows of vectors, the slots of the program first.
struct SeriesAbreast::Tape {
    /// What one operation does; but for those that follow it is that of an instruction.
    enum class Does : unsigned char { scale, sum, combine, instruct };
    struct Step {
        Does does;
        Code code = Code::combine;
        int out = -1, out2 = -1, a = -1, b = -1, c = -1, slope = -1;  // rows
        int weight = -1;
        int first = 0, last = 0;          // terms, or products
        int first_sum = 0, last_sum = 0;  // sums; of a sum that is a row by itself first_sum is that
        double value = 0.0;
    };
    struct Product {
        int x, y;  // rows
    };
    struct RowTerm {
        int row, weight;
    };
    struct alignas(64) Block {
        double lanes[most];
    };

    std::vector<Step> steps;
    std::vector<Product> products;
    std::vector<RowTerm> terms;
    std::vector<std::pair<int, int>> motion;  // rows of an input and of its rate
    std::vector<int> outputs;                 // rows of all, also of switches
    int rows = 0, sums = 0, time = -1;
    std::size_t stride = 0;
    // vectors one after the other, whatever their width
    std::vector<Block> cells, sum, next, weights;
    Block t{}, unit{}, check{};
    std::array<bool, most> begins_at_zero{};  // a norm
    void (*run)(Tape&, int order, bool whole) = nullptr;

    template <class Lanes>
    static Lanes* in(std::vector<Block>& blocks) {
        return reinterpret_cast<Lanes*>(blocks.data());
    }
    template <class Lanes>
    static Lanes& in(Block& block) {
        return reinterpret_cast<Lanes&>(block);
    }
};

/// Lists what a program computes, in the order of SeriesEvaluator.
class SeriesAbreast::Writer {
public:
    Writer(const Program& program, Tape& tape) : program_(program), schedule_(program), tape_(tape) {
        tape_.rows = program.slots();
        for (const Schedule::Stage& stage : schedule_.stages) write(stage);
        for (int i = 0; i < std::min(program.inputs(), program.outputs()); ++i)
            tape_.motion.emplace_back(i, program.output(i));
        const int outputs = program.outputs() + static_cast<int>(program.switches().size());
        for (int i = 0; i < outputs; ++i) tape_.outputs.push_back(program.output(i));
        if (program.uses_time()) tape_.time = program.time_slot();
    }

private:
    using Step = Tape::Step;
    using Does = Tape::Does;

    static int count(std::size_t size) { return static_cast<int>(size); }

    void write(const Schedule::Stage& stage) {
        std::map<const Instruction*, std::pair<int, int>> sums_of;
        for (std::size_t i = stage.combinations.first; i < stage.combinations.last; ++i) {
            const Schedule::Combination& c = schedule_.combinations[i];
            const Schedule::Range products = schedule_.sums[c.sum];
            const bool is_row = c.lanes == 1 && c.instruction->terms == 0 && c.instruction->weight < 0;
            const int first = tape_.sums;
            for (int lane = c.first_lane; lane < c.first_lane + c.lanes; ++lane)
                write_sum(products, static_cast<std::size_t>(lane), is_row ? c.instruction->out : -1);
            if (!is_row) sums_of[c.instruction] = {first, tape_.sums};
        }
        for (std::size_t i = stage.combinations.first; i < stage.combinations.last; ++i)
            if (const auto own = sums_of.find(schedule_.combinations[i].instruction); own != sums_of.end())
                write_combination(*own->first, own->second);
        for (std::size_t i = stage.others.first; i < stage.others.last; ++i) {
            const Instruction& other = *schedule_.others[i];
            if (other.code == Code::combine)
                write_combination(other, {0, 0});
            else
                tape_.steps.push_back({Does::instruct, other.code, other.out, other.out2, other.a, other.b, other.c,
                                       other.code == Code::norm ? -1 : other.extra, other.weight, 0, 0, 0, 0,
                                       other.value});
        }
    }

    /// The products of one lane of a sum of SeriesEvaluator.
    void write_sum(const Schedule::Range& products, std::size_t lane, int row) {
        Step sum{Does::sum};
        std::vector<Tape::Product> own;
        for (std::size_t p = products.first; p < products.last; ++p) {
            const Schedule::Product& product = schedule_.products[p];
            const Schedule::Weighted &x = schedule_.series[product.x][lane], &y = schedule_.series[product.y][lane];
            if (x.scalar != Schedule::zero) own.push_back({row_of(x), row_of(y)});
        }
        sum.first = count(tape_.products.size());
        tape_.products.insert(tape_.products.end(), own.begin(), own.end());
        sum.last = count(tape_.products.size());
        sum.out = tape_.sums++;
        sum.first_sum = row;
        tape_.steps.push_back(sum);
    }

    void write_combination(const Instruction& i, std::pair<int, int> sums) {
        Step step{Does::combine, Code::combine, i.out};
        step.weight = i.weight;
        step.first = count(tape_.terms.size());
        for (int t = 0; t < i.terms; ++t)
            tape_.terms.push_back({program_.terms(i)[t].slot, program_.terms(i)[t].weight});
        step.last = count(tape_.terms.size());
        step.first_sum = sums.first;
        step.last_sum = sums.second;
        tape_.steps.push_back(step);
    }

    /// A slot, or a row of it times its weight, which is written where it is used first.
    int row_of(const Schedule::Weighted& w) {
        if (w.scalar == Schedule::one) return w.slot;
        const auto [known, is_new] = weighted_.try_emplace(w, tape_.rows);
        if (is_new) {
            ++tape_.rows;
            Step scale{Does::scale};
            scale.out = known->second;
            scale.a = w.slot;
            scale.weight = w.scalar;
            tape_.steps.push_back(scale);
        }
        return known->second;
    }

    const Program& program_;
    Schedule schedule_;
    Tape& tape_;
    std::map<Schedule::Weighted, int> weighted_;
};

#ifdef RBDYN_HAS_LANES
namespace abreast {

namespace kernels = series::abreast;

template <class Lanes, class F>
RBDYN_ABREAST void each(const Lanes& x, Lanes& out, F f) {
    constexpr int width = sizeof(Lanes) / sizeof(double);
    for (int l = 0; l < width; ++l) out[l] = f(x[l]);
}

template <class Lanes, class Tape>
RBDYN_ABREAST void norm(const typename Tape::Step& s, Tape& tape, Lanes* cells, const Lanes* weights, int k) {
    constexpr int width = sizeof(Lanes) / sizeof(double);
    const std::size_t stride = tape.stride;
    const Lanes* part[3] = {cells + static_cast<std::size_t>(s.a) * stride,
                            cells + static_cast<std::size_t>(s.b) * stride,
                            cells + static_cast<std::size_t>(s.c) * stride};
    Lanes* out = cells + static_cast<std::size_t>(s.out) * stride;
    if (k == 0) {
        const Lanes square = part[0][0] * part[0][0] + part[1][0] * part[1][0] + part[2][0] * part[2][0];
        for (int l = 0; l < width; ++l) {
            const bool is_ignored = s.weight >= 0 && weights[s.weight][l] != 0.0,
                       is_zero = part[0][0][l] == 0.0 && part[1][0][l] == 0.0 && part[2][0][l] == 0.0;
            if (is_ignored || is_zero) tape.begins_at_zero[static_cast<std::size_t>(l)] = true;
            out[0][l] = std::sqrt(square[l]);
        }
        return;
    }
    Lanes square{}, sum;
    for (const Lanes* v : part) {
        kernels::dot(v, v + k, k + 1, sum);
        square += sum;
    }
    kernels::dot(out + 1, out + k - 1, k - 1, sum);
    out[k] = (square - sum) / (2.0 * out[0]);
}

/// Coefficient k of what an instruction that is no combination gives, as in SeriesEvaluator::compute().
template <class Lanes, class Tape>
RBDYN_ABREAST void instruct(const typename Tape::Step& s, Tape& tape, Lanes* cells, const Lanes* weights, int k) {
    const auto stride = static_cast<std::ptrdiff_t>(tape.stride);
    // of those that it has not nothing is read
    Lanes* out = cells + s.out * stride;
    Lanes* out2 = cells + (s.out2 < 0 ? 0 : s.out2) * stride;
    Lanes* slope = cells + (s.slope < 0 ? 0 : s.slope) * stride;
    const Lanes* a = cells + s.a * stride;
    const Lanes* b = cells + (s.b < 0 ? 0 : s.b) * stride;
    const Lanes* c = cells + (s.c < 0 ? 0 : s.c) * stride;
    const auto order = static_cast<double>(k);
    switch (s.code) {
        case Code::combine:
        case Code::call: break;
        case Code::divide: kernels::quotient(a, b, out, k, out[k]); break;
        case Code::square_root:
            if (k == 0)
                each(a[0], out[0], [](double x) { return std::sqrt(x); });
            else
                kernels::square_root(a[k], out, k, out[k]);
            break;
        case Code::norm: norm(s, tape, cells, weights, k); break;
        case Code::sine_cosine: {
            if (k == 0) {
                each(a[0], out[0], [](double x) { return std::sin(x); });
                each(a[0], out2[0], [](double x) { return std::cos(x); });
                break;
            }
            slope[k] = order * a[k];
            Lanes sine, cosine;
            kernels::integral_of_slope(slope, out2, k, sine);
            kernels::integral_of_slope(slope, out, k, cosine);
            out2[k] = -cosine;
            out[k] = sine;
            break;
        }
        case Code::hyperbolic: {
            slope[k] = order * a[k];
            if (k == 0) {
                each(a[0], out[0], [](double x) { return std::sinh(x); });
                each(a[0], out2[0], [](double x) { return std::cosh(x); });
                break;
            }
            Lanes sine, cosine;
            kernels::integral_of_slope(slope, out2, k, sine);
            kernels::integral_of_slope(slope, out, k, cosine);
            out2[k] = cosine;
            out[k] = sine;
            break;
        }
        case Code::tangent: {
            slope[k] = order * a[k];
            if (k == 0) {
                each(a[0], out[0], [](double x) { return std::tanh(x); });
                each(a[0], out2[0], [](double x) {
                    const double cosine = std::cosh(x);
                    return 1.0 / (cosine * cosine);
                });
                break;
            }
            kernels::integral_of_slope(slope, out2, k, out[k]);
            Lanes square;
            kernels::square(out, k, square);
            out2[k] = -square;
            break;
        }
        case Code::angle: {
            if (k == 0) {
                constexpr int width = sizeof(Lanes) / sizeof(double);
                for (int l = 0; l < width; ++l) out[0][l] = std::atan2(a[0][l], b[0][l]);
                break;
            }
            Lanes turn{}, sum;
            for (int j = 1; j <= k; ++j) turn += static_cast<double>(j) * (a[j] * b[k - j] - b[j] * a[k - j]);
            kernels::dot(slope + 1, c + k - 1, k - 1, sum);
            slope[k] = (turn - sum) / c[0];
            out[k] = slope[k] / order;
            break;
        }
        case Code::exponential:
            slope[k] = order * a[k];
            if (k == 0)
                each(a[0], out[0], [](double x) { return std::exp(x); });
            else
                kernels::integral_of_slope(slope, out, k, out[k]);
            break;
        case Code::logarithm: {
            if (k == 0) {
                each(a[0], out[0], [](double x) { return std::log(x); });
                break;
            }
            Lanes sum;
            kernels::dot(slope + 1, a + k - 1, k - 1, sum);
            out[k] = (a[k] - sum / order) / a[0];
            slope[k] = order * out[k];
            break;
        }
        case Code::power: {
            slope[k] = order * a[k];
            if (k == 0) {
                each(a[0], out[0], [power = s.value](double x) { return std::pow(x, power); });
                break;
            }
            Lanes weighted, plain;
            kernels::dot(slope + 1, out + k - 1, k, weighted);
            weighted = weighted / order;
            kernels::dot(a + 1, out + k - 1, k, plain);
            out[k] = ((s.value + 1.0) * weighted - plain) / a[0];
            break;
        }
    }
}

template <class Lanes, class Tape>
RBDYN_ABREAST void advance(Tape& tape, Lanes* cells, const Lanes* weights, Lanes* sums, Lanes* nexts, int k) {
    using Does = typename Tape::Does;
    const auto stride = static_cast<std::ptrdiff_t>(tape.stride);
    for (const typename Tape::Step& s : tape.steps) {
        switch (s.does) {
            case Does::scale: cells[s.out * stride + k] = weights[s.weight] * cells[s.a * stride + k]; break;
            case Does::sum: {
                Lanes sum{}, next{};
                const auto *p = tape.products.data() + s.first, *end = tape.products.data() + s.last;
                if (k % 2 == 0) {
                    for (; p != end; ++p)
                        kernels::even_order(cells + p->x * stride, cells + p->y * stride, k, sum, next);
                    nexts[s.out] = next;
                } else {
                    sum = nexts[s.out];
                    for (; p != end; ++p) kernels::odd_order(cells + p->x * stride, cells + p->y * stride, k, sum);
                }
                if (s.first_sum >= 0)
                    cells[s.first_sum * stride + k] = sum;
                else
                    sums[s.out] = sum;
                break;
            }
            case Does::combine: {
                Lanes sum{};
                if (k == 0 && s.weight >= 0) sum = weights[s.weight];
                const auto *t = tape.terms.data() + s.first, *end = tape.terms.data() + s.last;
                for (; t != end; ++t) sum += weights[t->weight] * cells[t->row * stride + k];
                for (int i = s.first_sum; i < s.last_sum; ++i) sum += sums[i];
                cells[s.out * stride + k] = sum;
                break;
            }
            case Does::instruct: instruct(s, tape, cells, weights, k); break;
        }
    }
}

template <class Lanes, class Tape>
RBDYN_ABREAST void expand(Tape& tape, int order, bool whole) {
    Lanes* cells = Tape::template in<Lanes>(tape.cells);
    const Lanes* weights = Tape::template in<Lanes>(tape.weights);
    Lanes *sums = Tape::template in<Lanes>(tape.sum), *nexts = Tape::template in<Lanes>(tape.next);
    const auto stride = static_cast<std::ptrdiff_t>(tape.stride);
    const Lanes unit = Tape::template in<Lanes>(tape.unit);
    if (tape.time >= 0) {
        Lanes* time = cells + tape.time * stride;
        time[0] = Tape::template in<Lanes>(tape.t);
        time[1] = unit;
        for (int k = 2; k <= order; ++k) time[k] = Lanes{};
    }
    for (int k = 0; k <= (whole ? order : order - 1); ++k) {
        advance(tape, cells, weights, sums, nexts, k);
        if (k == order) break;
        const Lanes factor = unit / static_cast<double>(k + 1);
        for (const auto& [input, rate] : tape.motion) cells[input * stride + k + 1] = cells[rate * stride + k] * factor;
    }
    Lanes check{};
    for (const auto& [input, rate] : tape.motion) check += 0.0 * cells[rate * stride + order - 1];
    if (whole)
        for (const int output : tape.outputs) check += 0.0 * cells[output * stride + order];
    Tape::template in<Lanes>(tape.check) = check;
}

template <class Tape>
void two_of_two(Tape& tape, int order, bool whole) {
    expand<kernels::Four>(tape, order, whole);
}
#if defined(__x86_64__)
template <class Tape>
__attribute__((target("avx2"))) void four(Tape& tape, int order, bool whole) {
    expand<kernels::Four>(tape, order, whole);
}
template <class Tape>
__attribute__((target("avx512f,prefer-vector-width=512"))) void eight(Tape& tape, int order, bool whole) {
    expand<kernels::Eight>(tape, order, whole);
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
      instructions_(program.instructions()),
      tape_(std::make_unique<Tape>()) {
    for (const Instruction& i : instructions_) {
        terms_.insert(terms_.end(), program.terms(i), program.terms(i) + i.terms);
        products_.insert(products_.end(), program.products(i), program.products(i) + i.products);
    }
    Writer(program, *tape_);
    Tape& tape = *tape_;
    tape.stride = static_cast<std::size_t>(stride_);
    const auto blocks = [&](std::size_t vectors) {
        return (vectors * static_cast<std::size_t>(width_) + most - 1) / most;
    };
    tape.cells.resize(blocks(static_cast<std::size_t>(tape.rows) * tape.stride));
    tape.sum.resize(blocks(static_cast<std::size_t>(tape.sums)));
    tape.next.resize(blocks(static_cast<std::size_t>(tape.sums)));
    tape.weights.resize(blocks(static_cast<std::size_t>(program.scalars())));
#ifdef RBDYN_HAS_LANES
    tape.run = abreast::two_of_two<Tape>;
#if defined(__x86_64__)
    if (processor == Processor::four) tape.run = abreast::four<Tape>;
    if (processor == Processor::eight) tape.run = abreast::eight<Tape>;
#endif
#endif
}

RBDYN_INLINE SeriesAbreast::~SeriesAbreast() = default;

RBDYN_INLINE bool SeriesAbreast::fits(const Program& program, int order) const {
    if (order != order_ || program.instructions().size() != instructions_.size() ||
        program.slots() + static_cast<int>(0) > tape_->rows ||
        static_cast<std::size_t>(std::min(program.inputs(), program.outputs())) != tape_->motion.size())
        return false;
    const std::vector<int>& outputs = tape_->outputs;
    const auto count = static_cast<std::size_t>(program.outputs()) + program.switches().size();
    if (count != outputs.size()) return false;
    for (std::size_t i = 0; i < count; ++i)
        if (program.output(static_cast<int>(i)) != outputs[i]) return false;
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
    Tape& tape = *tape_;
    const auto width = static_cast<std::size_t>(width_), stride = tape.stride;
    double *cells = tape.cells.data()->lanes, *weights = tape.weights.data()->lanes;
    for (std::size_t l = 0; l < width; ++l) {
        // lanes to spare have another one's
        const Motion& m = motions[l < motions.size() ? l : 0];
        tape.t.lanes[l] = m.t;
        tape.unit.lanes[l] = m.unit;
        for (std::size_t i = 0; i < m.state.size(); ++i) cells[i * stride * width + l] = m.state[i];
        for (std::size_t i = 0; i < m.weights.size(); ++i) weights[i * width + l] = m.weights[i];
    }
    tape.begins_at_zero.fill(false);
    tape.run(tape, order_, whole);
}

RBDYN_INLINE bool SeriesAbreast::is_good(int motion) const {
    const auto l = static_cast<std::size_t>(motion);
    return !tape_->begins_at_zero[l] && tape_->check.lanes[l] == 0.0;
}

RBDYN_INLINE void SeriesAbreast::give(int motion, SeriesEvaluator& series, bool whole) const {
    const Tape& tape = *tape_;
    const auto width = static_cast<std::size_t>(width_), stride = tape.stride;
    const double* cells = tape.cells.data()->lanes + motion;
    const auto copy = [&](int slot) {
        const double* from = cells + static_cast<std::size_t>(slot) * stride * width;
        double* to = series.row(slot);
        for (std::size_t k = 0; k < stride; ++k) to[k] = from[k * width];
    };
    if (whole) {
        for (int slot = 0; slot < series.program().slots(); ++slot) copy(slot);
        return;
    }
    for (const auto& [input, rate] : tape.motion) copy(input);
    const auto last = static_cast<std::size_t>(order_ - 1);
    for (const auto& [input, rate] : tape.motion) {
        const double* from = cells + static_cast<std::size_t>(rate) * stride * width;
        double* to = series.row(rate);
        to[0] = from[0];
        to[last] = from[last * width];
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
