// Runs the tape of SeriesAbreast with vectors of some width. All of it is inlined where that is chosen, for it is
// compiled for several processors.
#pragma once

#include "rbdyn/series/abreast.hpp"

#ifdef RBDYN_HAS_LANES
#include <cmath>
#include <cstddef>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/abreast_code.hpp"
#include "rbdyn/expression/abreast_tape.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/series/step_length_abreast.hpp"

namespace rbdyn::inline RBDYN_FORM::abreast {

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

template <class Lanes>
RBDYN_ABREAST void norm(const Tape::Other& s, Tape& tape, Lanes* cells, const Lanes* weights, int k) {
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
template <class Lanes>
RBDYN_ABREAST void instruct(const Tape::Other& s, Tape& tape, Lanes* cells, const Lanes* weights, int k) {
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
            if (k == 0 && s.is_raised)
                for (int l = 0; l < static_cast<int>(sizeof(Lanes) / sizeof(double)); ++l)
                    out[0][l] = std::pow(b[0][l], c[0][l]);
            else if (k == 0)
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
        case Code::expm1: {
            slope[k] = order * a[k];
            if (k == 0) {
                each(a[0], out[0], [](double x) { return std::expm1(x); });
                each(a[0], out2[0], [](double x) { return std::exp(x); });
                break;
            }
            kernels::integral_of_slope(slope, out2, k, out[k]);
            out2[k] = out[k];
            break;
        }
        case Code::log1p:
        case Code::arsinh:
        case Code::artanh: {
            if (k == 0) {
                each(a[0], out[0], [code = s.code](double x) { return inverse(code, x); });
                each(a[0], out2[0], [code = s.code](double x) { return inverse_divisor(code, x); });
                break;
            }
            Lanes sum;
            kernels::dot(slope + 1, out2 + k - 1, k - 1, sum);
            out[k] = (a[k] - sum / order) / out2[0];
            slope[k] = order * out[k];
            if (s.code == Code::log1p) {
                out2[k] = a[k];
            } else if (s.code == Code::arsinh) {
                kernels::integral_of_slope(slope, a, k, out2[k]);
            } else {
                kernels::square(a, k, sum);
                out2[k] = -sum;
            }
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
template <class Lanes>
RBDYN_ABREAST void advance(Tape& tape, Lanes* cells, const Lanes* weights, int k) {
    Lanes* now = cells + k;
    Lanes *sums = Tape::in<Lanes>(tape.sum), *nexts = Tape::in<Lanes>(tape.next), *parts = Tape::in<Lanes>(tape.part),
          *next_parts = Tape::in<Lanes>(tape.next_part);
    const bool is_even = k % 2 == 0;
    const auto* scale = tape.scales.data();
    const auto *single = tape.singles.data(), *products = tape.products.data();
    const auto* pair = tape.pairs.data();
    const auto* sum = tape.sums.data();
    const auto* combination = tape.combinations.data();
    const auto* other = tape.others.data();
    Lanes* next = nexts;
    for (const Tape::Ends& stage : tape.stages) {
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

/// `code`: of all orders but the first ones, where there is any.
template <class Lanes>
RBDYN_ABREAST void expand(Tape& tape, int order, bool whole, const AbreastCode* code) {
    Lanes* cells = Tape::in<Lanes>(tape.cells);
    const Lanes* weights = Tape::in<Lanes>(tape.weights);
    const Lanes unit = Tape::in<Lanes>(tape.unit);
    if (tape.time >= 0) {
        Lanes* time = at(cells, tape.time);
        time[0] = Tape::in<Lanes>(tape.t);
        time[1] = unit;
        for (int k = 2; k <= order; ++k) time[k] = Lanes{};
    }
    const int by_list = code == nullptr ? (whole ? order : order - 1) : AbreastCode::first_order - 1;
    for (int k = 0; k <= by_list; ++k) {
        advance(tape, cells, weights, k);
        if (k == order) break;
        const Lanes factor = unit / static_cast<double>(k + 1);
        for (const auto& [input, rate] : tape.motion) at(cells, input)[k + 1] = at(cells, rate)[k] * factor;
    }
    if (code != nullptr) code->run(tape, order, whole);
    Lanes check{};
    for (const auto& [input, rate] : tape.motion) check += 0.0 * at(cells, rate)[order - 1];
    if (whole)
        for (const auto output : tape.outputs) check += 0.0 * at(cells, output)[order];
    Tape::in<Lanes>(tape.check) = check;
}

template <class Lanes>
RBDYN_ABREAST void sizes(Tape& tape, Tape::Place first, int count, int order, Tape::Block* out) {
    const auto stride = tape.stride / static_cast<Tape::Place>(sizeof(Lanes));
    kernels::sizes(at(Tape::in<Lanes>(tape.cells), first), stride, count, order, reinterpret_cast<Lanes*>(out));
}

template <class Lanes>
RBDYN_ABREAST void log_steps(Tape::Sizes& s, int order, const Tape::Block& scale, const Tape::Block& log_tolerance) {
    kernels::WholeOf<Lanes> is_known;
    kernels::log_step(Tape::in<Lanes>(s.values), order, reinterpret_cast<const Lanes&>(scale),
                      reinterpret_cast<const Lanes&>(log_tolerance), Tape::in<Lanes>(s.log_step), is_known);
    kernels::of_bits(is_known, Tape::in<Lanes>(s.is_known));
}

template <class Lanes>
RBDYN_ABREAST void increments(Tape& tape, int count, int order, const Tape::Block& place, Tape::Block* out) {
    Lanes* const powers = Tape::in<Lanes>(tape.powers);
    kernels::powers(reinterpret_cast<const Lanes&>(place), order, powers);
    for (int i = 0; i < count; ++i)
        kernels::forward_dot(at(Tape::in<Lanes>(tape.cells), i * tape.stride) + 1, powers, order,
                             reinterpret_cast<Lanes*>(out)[i]);
}

template <class Lanes>
RBDYN_ABREAST void rows(Tape& tape, Tape::Place series, int count, double* const* to) {
    kernels::rows(at(Tape::in<Lanes>(tape.cells), series), count, to);
}

}  // namespace rbdyn::inline RBDYN_FORM::abreast

#endif
