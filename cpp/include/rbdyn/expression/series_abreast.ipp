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

/// What is computed at each order, in its order: stage by stage, and in a stage one kind after the other. Where things
/// are is said in bytes from the first one on: of a series its coefficient 0.
struct SeriesAbreast::Tape {
    using Place = std::ptrdiff_t;

    /// A series times a weight.
    struct Scale {
        Place out, a, weight;
    };
    /// A product, and the place of its part of a sum. Those of two with a factor in common are side by side.
    struct Product {
        Place x, y, part;
    };
    struct Pair {
        Place x, z, y, part;
    };
    /// Of products [first, last); `series`: it is one by itself.
    struct Sum {
        Place first, last, out;
        bool is_series;
    };
    /// A constant, multiples of series and sums.
    struct Multiple {
        Place series, weight;
    };
    struct Combination {
        Place out, constant;  // -1: none
        Place first, last, first_sum, last_sum;
    };
    struct Other {
        Code code;
        Place out, out2, a, b, c, slope;  // 0 of those that it has not
        Place weight;
        double value;
    };
    struct Ends {
        std::size_t scales = 0, singles = 0, pairs = 0, sums = 0, combinations = 0, others = 0;
    };
    struct alignas(64) Block {
        double lanes[most];
    };

    std::vector<Scale> scales;
    std::vector<Product> products, singles;
    std::vector<Pair> pairs;
    std::vector<Sum> sums;
    std::vector<Multiple> multiples;
    std::vector<Combination> combinations;
    std::vector<Other> others;
    std::vector<Ends> stages;                     // where each of them ends
    std::vector<std::pair<Place, Place>> motion;  // an input and its rate
    std::vector<Place> outputs;                   // all, also switches
    int rows = 0, sum_count = 0, part_count = 0;
    Place vector = 0, stride = 0, time = -1;  // bytes of a vector, of a series
    // vectors one after the other, whatever their width
    std::vector<Block> cells, sum, next, weights, part, next_part;
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
            tape_.motion.emplace_back(at(i), at(program.output(i)));
        const int outputs = program.outputs() + static_cast<int>(program.switches().size());
        for (int i = 0; i < outputs; ++i) tape_.outputs.push_back(at(program.output(i)));
        if (program.uses_time()) tape_.time = at(program.time_slot());
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
                                    at(slope), weight_at(other.weight), other.value});
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

#ifdef RBDYN_HAS_LANES
namespace abreast {

namespace kernels = series::abreast;

/// The vector at a place.
template <class Lanes>
RBDYN_ABREAST Lanes* at(Lanes* first, std::ptrdiff_t place) {
    return reinterpret_cast<Lanes*>(reinterpret_cast<char*>(first) + place);
}
template <class Lanes>
RBDYN_ABREAST const Lanes* at(const Lanes* first, std::ptrdiff_t place) {
    return reinterpret_cast<const Lanes*>(reinterpret_cast<const char*>(first) + place);
}

template <class Lanes, class F>
RBDYN_ABREAST void each(const Lanes& x, Lanes& out, F f) {
    constexpr int width = sizeof(Lanes) / sizeof(double);
    for (int l = 0; l < width; ++l) out[l] = f(x[l]);
}

template <class Lanes, class Tape>
RBDYN_ABREAST void norm(const typename Tape::Other& s, Tape& tape, Lanes* cells, const Lanes* weights, int k) {
    constexpr int width = sizeof(Lanes) / sizeof(double);
    const Lanes* part[3] = {at(cells, s.a), at(cells, s.b), at(cells, s.c)};
    Lanes* out = at(cells, s.out);
    if (k == 0) {
        const Lanes square = part[0][0] * part[0][0] + part[1][0] * part[1][0] + part[2][0] * part[2][0];
        for (int l = 0; l < width; ++l) {
            const bool is_ignored = s.weight >= 0 && (*at(weights, s.weight))[l] != 0.0,
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
RBDYN_ABREAST void instruct(const typename Tape::Other& s, Tape& tape, Lanes* cells, const Lanes* weights, int k) {
    Lanes *out = at(cells, s.out), *out2 = at(cells, s.out2), *slope = at(cells, s.slope);
    const Lanes *a = at(cells, s.a), *b = at(cells, s.b), *c = at(cells, s.c);
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

/// Coefficient k of everything; `cells` begins with that one of the first series.
template <class Lanes, class Tape>
RBDYN_ABREAST void advance(Tape& tape, Lanes* cells, const Lanes* weights, int k) {
    Lanes* now = cells + k;
    Lanes *sums = Tape::template in<Lanes>(tape.sum), *nexts = Tape::template in<Lanes>(tape.next),
          *parts = Tape::template in<Lanes>(tape.part), *next_parts = Tape::template in<Lanes>(tape.next_part);
    const bool is_even = k % 2 == 0;
    const auto* scale = tape.scales.data();
    const auto *single = tape.singles.data(), *products = tape.products.data();
    const auto* pair = tape.pairs.data();
    const auto* sum = tape.sums.data();
    const auto* combination = tape.combinations.data();
    const auto* other = tape.others.data();
    Lanes* next = nexts;
    for (const typename Tape::Ends& stage : tape.stages) {
        for (const auto* end = tape.scales.data() + stage.scales; scale != end; ++scale)
            *at(now, scale->out) = *at(weights, scale->weight) * *at(now, scale->a);
        if (is_even && k > 0) {
            for (const auto* end = tape.singles.data() + stage.singles; single != end; ++single)
                kernels::even_order(at(cells, single->x), at(cells, single->y), k, *at(parts, single->part),
                                    *at(next_parts, single->part));
            for (const auto* end = tape.pairs.data() + stage.pairs; pair != end; ++pair)
                kernels::even_order(at(cells, pair->x), at(cells, pair->z), at(cells, pair->y), k,
                                    at(parts, pair->part), at(next_parts, pair->part));
        }
        for (const auto* end = tape.sums.data() + stage.sums; sum != end; ++sum, ++next) {
            const auto *p = products + sum->first, *last = products + sum->last;
            Lanes all{};
            if (!is_even) {
                all = *next;
                for (; p != last; ++p) kernels::odd_order(at(cells, p->x), at(cells, p->y), k, all);
            } else if (k > 0) {
                Lanes above{};
                for (; p != last; ++p) {
                    all += *at(parts, p->part);
                    above += *at(next_parts, p->part);
                }
                *next = above;
            } else {
                for (; p != last; ++p) all += *at(cells, p->x) * *at(cells, p->y);
                *next = Lanes{};
            }
            *at(sum->is_series ? now : sums, sum->out) = all;
        }
        for (const auto* end = tape.combinations.data() + stage.combinations; combination != end; ++combination) {
            Lanes all{};
            if (k == 0 && combination->constant >= 0) all = *at(weights, combination->constant);
            const auto *m = tape.multiples.data() + combination->first,
                       *last = tape.multiples.data() + combination->last;
            for (; m != last; ++m) all += *at(weights, m->weight) * *at(now, m->series);
            const Lanes *own = at(sums, combination->first_sum), *own_end = at(sums, combination->last_sum);
            for (; own != own_end; ++own) all += *own;
            *at(now, combination->out) = all;
        }
        for (const auto* end = tape.others.data() + stage.others; other != end; ++other)
            instruct(*other, tape, cells, weights, k);
    }
}

template <class Lanes, class Tape>
RBDYN_ABREAST void expand(Tape& tape, int order, bool whole) {
    Lanes* cells = Tape::template in<Lanes>(tape.cells);
    const Lanes* weights = Tape::template in<Lanes>(tape.weights);
    const Lanes unit = Tape::template in<Lanes>(tape.unit);
    if (tape.time >= 0) {
        Lanes* time = at(cells, tape.time);
        time[0] = Tape::template in<Lanes>(tape.t);
        time[1] = unit;
        for (int k = 2; k <= order; ++k) time[k] = Lanes{};
    }
    for (int k = 0; k <= (whole ? order : order - 1); ++k) {
        advance(tape, cells, weights, k);
        if (k == order) break;
        const Lanes factor = unit / static_cast<double>(k + 1);
        for (const auto& [input, rate] : tape.motion) at(cells, input)[k + 1] = at(cells, rate)[k] * factor;
    }
    Lanes check{};
    for (const auto& [input, rate] : tape.motion) check += 0.0 * at(cells, rate)[order - 1];
    if (whole)
        for (const auto output : tape.outputs) check += 0.0 * at(cells, output)[order];
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
    Tape& tape = *tape_;
    tape.vector = static_cast<Tape::Place>(static_cast<std::size_t>(width_) * sizeof(double));
    tape.stride = stride_ * tape.vector;
    Writer(program, tape);
    const auto blocks = [&](std::size_t vectors) {
        return (vectors * static_cast<std::size_t>(width_) + most - 1) / most;
    };
    tape.cells.resize(blocks(static_cast<std::size_t>(tape.rows) * static_cast<std::size_t>(stride_)));
    tape.sum.resize(blocks(static_cast<std::size_t>(tape.sum_count)));
    tape.next.resize(blocks(static_cast<std::size_t>(tape.sum_count)));
    tape.part.resize(blocks(static_cast<std::size_t>(tape.part_count)));
    tape.next_part.resize(blocks(static_cast<std::size_t>(tape.part_count)));
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
        static_cast<std::size_t>(std::min(program.inputs(), program.outputs())) != tape_->motion.size())
        return false;
    const std::vector<Tape::Place>& outputs = tape_->outputs;
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
    Tape& tape = *tape_;
    const auto width = static_cast<std::size_t>(width_), stride = static_cast<std::size_t>(stride_);
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

RBDYN_INLINE void SeriesAbreast::copy(int motion, int slot, std::size_t count, SeriesEvaluator& series) const {
    const auto width = static_cast<std::size_t>(width_);
    const double* from = tape_->cells.data()->lanes + static_cast<std::size_t>(slot * stride_) * width +
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
    for (int slot = 0; slot < series.program().inputs(); ++slot) copy(motion, slot, count, series);
    for (const int slot : slots) copy(motion, slot, whole ? count : count - 1, series);
    const auto width = static_cast<std::size_t>(width_), last = static_cast<std::size_t>(order_ - 1) * width;
    for (const auto& [input, rate] : tape_->motion) {
        const auto slot = static_cast<int>(rate / tape_->stride);
        const double* from = tape_->cells.data()->lanes + static_cast<std::size_t>(slot * stride_) * width +
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

RBDYN_INLINE std::size_t SeriesAbreast::bytes() const { return tape_->cells.size() * sizeof(Tape::Block); }

}  // namespace rbdyn::inline RBDYN_FORM
