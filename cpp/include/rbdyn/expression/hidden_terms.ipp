// Definitions of rbdyn/expression/hidden_terms.hpp.
#pragma once

#include "rbdyn/expression/hidden_terms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <numeric>
#include <span>
#include <vector>

#include "rbdyn/basics/instant.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/term_sizes.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE HiddenTerms::HiddenTerms(const Program& program, int order)
    : HiddenTerms(program, order, all_outputs(program)) {}

RBDYN_INLINE HiddenTerms::HiddenTerms(const Program& program, int order, std::span<const int> outputs)
    : order_(order), visible_(order - integrations), most_(0.5 * order) {
    const std::vector<bool> is_needed = needed(program, outputs);
    const auto known = powers(program);
    const std::vector<double>& degree = known.degree;
    const std::vector<int>& base = known.base;
    const std::vector<std::vector<int>> constant = constants(program);
    const auto of = [&](int slot) { return degree[at(slot)]; };
    const auto add_inverse = [&](int slot, double rate) {
        // a power that is written as products may be too large for a double; what it is one of is not
        const std::vector<int>&all = constant[at(slot)], &one = constant[at(base[at(slot)])];
        if (!one.empty() && all.size() % one.size() == 0) {
            bool is_power = true;
            for (std::size_t k = 0; k < all.size(); ++k) is_power = is_power && all[k] == one[k % one.size()];
            if (is_power) {
                rate *= static_cast<double>(all.size() / one.size());
                slot = base[at(slot)];
            }
        }
        if (constant[at(slot)].empty() || !(of(slot) > 1.0)) return;
        // of high powers: values may miss it
        constexpr double high = 8.0;
        (of(slot) * rate >= high ? steep_ : inverses_).push_back({slot, rate, constant[at(slot)]});
    };
    std::vector<int> places(at(program.slots()), -1);
    int factors = 0;
    const auto place = [&](int slot) {
        int& found = places[at(slot)];
        if (found < 0) found = factors++;
        return found;
    };
    for (const Instruction& i : program.instructions()) {
        if (!is_needed[at(i.out)] && (i.out2 < 0 || !is_needed[at(i.out2)])) continue;
        switch (i.code) {
            case Code::exponential:
            case Code::expm1:
            case Code::hyperbolic: arguments_.push_back({i.code, i.a, 1.0}); break;
            case Code::tangent: arguments_.push_back({i.code, i.a, 2.0}); break;
            case Code::power:
                if (i.value < 0.0) add_inverse(i.a, -i.value);
                if (i.value * of(i.a) > visible_) arguments_.push_back({i.code, i.a, i.value});
                break;
            case Code::divide: add_inverse(i.b, 1.0); break;
            case Code::combine:
                for (int k = 0; k < i.products; ++k) {
                    const ProductTerm& t = program.products(i)[k];
                    if (of(t.a) + of(t.b) > visible_) products_.push_back({t.a, t.b, place(t.a), place(t.b)});
                }
                break;
            default: break;
        }
    }
}

RBDYN_INLINE std::vector<int> HiddenTerms::all_outputs(const Program& program) {
    std::vector<int> all;
    for (int i = 0; i < program.outputs() + static_cast<int>(program.switches().size()); ++i) all.push_back(i);
    return all;
}

RBDYN_INLINE std::vector<bool> HiddenTerms::needed(const Program& program, std::span<const int> outputs) {
    std::vector<bool> is_needed(at(program.slots()), false);
    for (const int i : outputs) is_needed[at(program.output(i))] = true;
    const auto need = [&](int slot) {
        if (slot >= 0) is_needed[at(slot)] = true;
    };
    const std::vector<Instruction>& all = program.instructions();
    for (auto i = all.rbegin(); i != all.rend(); ++i) {
        // calls have no series; what they give is needed as far as it goes
        if (i->code == Code::call || !(is_needed[at(i->out)] || (i->out2 >= 0 && is_needed[at(i->out2)]))) continue;
        for (const int slot : {i->a, i->b, i->c}) need(slot);
        for (int k = 0; k < i->terms; ++k) need(program.terms(*i)[k].slot);
        for (int k = 0; k < i->products; ++k) {
            need(program.products(*i)[k].a);
            need(program.products(*i)[k].b);
        }
    }
    return is_needed;
}

RBDYN_INLINE HiddenTerms::Powers HiddenTerms::powers(const Program& program) {
    // a product of many different functions is no power; one of a power is
    constexpr double power = 4.0;
    std::vector<double> degree(at(program.slots()), 1.0);
    std::vector<int> base(at(program.slots()));
    std::iota(base.begin(), base.end(), 0);
    const auto of = [&](int slot) -> double& { return degree[at(slot)]; };
    const auto of_product = [&](const ProductTerm& t) {
        const bool is_power = base[at(t.a)] == base[at(t.b)] || of(t.a) >= power || of(t.b) >= power;
        return is_power ? of(t.a) + of(t.b) : 1.0;
    };
    const auto pass = [&] {
        for (const Instruction& i : program.instructions()) {
            double d = 1.0;
            if (i.code == Code::combine) {
                for (int k = 0; k < i.terms; ++k) d = std::max(d, of(program.terms(i)[k].slot));
                for (int k = 0; k < i.products; ++k) d = std::max(d, of_product(program.products(i)[k]));
                if (i.products == 1 && i.terms == 0 && i.weight < 0 && d > 1.0)
                    base[at(i.out)] = base[at(program.products(i)->a)];
            } else if (i.code == Code::divide) {
                d = std::max(of(i.a), of(i.b));
            } else if (i.code == Code::power) {
                d = std::max(1.0, std::abs(i.value) * of(i.a));
            } else if (i.code == Code::call) {
                continue;
            }
            of(i.out) = d;
            if (i.out2 >= 0) of(i.out2) = d;
        }
    };
    // a motion under a power of time is one itself, and so is what that moves
    for (int k = 0; k < integrations; ++k) {
        pass();
        for (int i = 0; i < std::min(program.inputs(), program.outputs()); ++i)
            if (of(program.output(i)) >= power) of(i) = of(program.output(i)) + 1.0;
    }
    pass();
    return {degree, base};
}

RBDYN_INLINE std::vector<std::vector<int>> HiddenTerms::constants(const Program& program) {
    std::vector<std::vector<int>> all(at(program.slots()));
    for (const Instruction& i : program.instructions()) {
        if (i.code == Code::square_root || i.code == Code::power) all[at(i.out)] = all[at(i.a)];
        if (i.code != Code::combine) continue;
        if (i.weight >= 0) {
            all[at(i.out)] = {i.weight};
        } else if (i.terms == 0 && i.products == 1) {
            const std::vector<int>&a = all[at(program.products(i)->a)], &b = all[at(program.products(i)->b)];
            if (a.empty() || b.empty()) continue;
            std::vector<int> both = a;
            both.insert(both.end(), b.begin(), b.end());
            all[at(i.out)] = both;
        }
    }
    return all;
}

RBDYN_INLINE std::vector<int> HiddenTerms::slots() const {
    std::vector<int> all;
    for (const Argument& argument : arguments_) all.push_back(argument.slot);
    for (const Factors& factors : products_) all.insert(all.end(), {factors.a, factors.b});
    for (const auto* inverses : {&inverses_, &steep_})
        for (const Inverse& inverse : *inverses) all.push_back(inverse.slot);
    return all;
}

RBDYN_INLINE double HiddenTerms::held(const SeriesEvaluator& series, double length) const {
    return held_products(series, shortened<Inverse>(series, inverses_, held_pulses(series, length)));
}

RBDYN_INLINE double HiddenTerms::held_products(const SeriesEvaluator& series, double length) const {
    // Terms of a product beyond those that are seen are at most w^-(visible + 1) A(w) B(w), A(w) the sum of the sizes
    // of terms k of one factor times w^k, w > 1 (Chernoff's bound): each factor is looked at once, and most products,
    // of which there are many more, only where that does not tell. It grows with the length, so that it holds for
    // shorter ones.
    constexpr double w = 2.0, rounding = 0.5;
    const double most = rounding * std::exp2(visible_ + 1 - most_);
    std::vector<double> bounds;  // of A(w) / A(0)
    const auto bound = [&](int slot, int place) {
        if (at(place) < bounds.size()) return bounds[at(place)];
        const double* a = series.coefficients(slot);
        double sum = 0.0;
        for (int k = order_; k >= 0; --k) sum = sum * (w * length) + std::abs(a[k]);
        return bounds.emplace_back(sum == 0.0 ? 0.0 : sum / std::abs(a[0]));
    };
    for (const Factors& factors : products_) {
        const double a = bound(factors.a, factors.place_a), b = bound(factors.b, factors.place_b);
        if (!(a * b < most)) length = shortened<Factors>(series, {&factors, 1}, length);
    }
    return length;
}

RBDYN_INLINE double HiddenTerms::held_pulses(const SeriesEvaluator& series, double length) const {
    return shortened<Inverse>(series, steep_, shortened<Argument>(series, arguments_, length));
}

template <class Item>
RBDYN_INLINE double HiddenTerms::shortened(const SeriesEvaluator& series, std::span<const Item> items,
                                           double length) const {
    constexpr double shorter = 0.75;
    constexpr int most_times = 320;
    for (const Item& item : items) {
        double held = length;
        bool is_held = holds(series, item, held);
        for (int k = 0; k < most_times && !is_held; ++k) is_held = holds(series, item, held *= shorter);
        if (is_held) length = held;
    }
    return length;
}

RBDYN_INLINE bool HiddenTerms::holds(const SeriesEvaluator& series, const Argument& argument, double length) const {
    const double* u = series.coefficients(argument.slot);
    double change = 0.0, power = 1.0;
    for (int k = 1; k <= order_; ++k) {
        power *= length;
        const double term = std::abs(u[k]) * power;
        // beyond what is known of a function that is called back
        if (std::isnan(term)) break;
        change += term;
    }
    const double begin = argument.rate * std::abs(u[0]);
    switch (argument.code) {
        case Code::power: return !(argument.rate * std::log1p(change / std::abs(u[0])) > most_);
        case Code::exponential:
        case Code::expm1:
        case Code::hyperbolic:
        case Code::tangent:
            if (begin - argument.rate * change >= negligible) return true;
            [[fallthrough]];
        default: return !(argument.rate * change > most_);
    }
}

RBDYN_INLINE bool HiddenTerms::holds(const SeriesEvaluator& series, const Factors& factors, double length) const {
    const double *a = series.coefficients(factors.a), *b = series.coefficients(factors.b);
    // where doubles end it is no series any more
    constexpr double largest = 0x1p960;
    if (std::abs(a[0] * b[0]) > largest) return true;
    // terms of b, sums of them up to one, and from one on
    TermSizes::Sizes term, first, last;
    double power = 1.0, sum = 0.0;
    for (int k = 0; k <= order_; ++k, power *= length) {
        last[at(k)] = term[at(k)] = std::abs(b[k]) * power;
        first[at(k)] = sum += term[at(k)];
    }
    for (int k = order_; k > 0; --k) last[at(k - 1)] += last[at(k)];
    // terms of the product up to the last one that is seen, and those beyond; and the last ones that are computed, of
    // which a step length counts with two, or, once a motion has integrated them twice, with the two before
    double seen = 0.0, beyond = 0.0;
    std::array<double, 2> told{};
    power = 1.0;
    for (int k = 0; k <= order_; ++k, power *= length) {
        const double size = std::abs(a[k]) * power;
        const int rest = visible_ - k;
        if (rest >= 0) seen += size * first[at(rest)];
        beyond += size * last[at(std::max(rest + 1, 0))];
        for (int before = 0; before < integrations; ++before)
            if (const int j = order_ - before - k; j >= 0) told[at(before / 2)] += size * term[at(j)];
    }
    // so much more than these they may be
    constexpr double more = 64.0;
    const double allowed =
        std::max({std::exp2(-most_) * seen, more * std::min(told[0], told[1]), std::exp(-negligible)});
    return !(beyond > allowed || std::isinf(beyond));
}

RBDYN_INLINE bool HiddenTerms::holds(const SeriesEvaluator& series, const Inverse& inverse, double length) const {
    const double* b = series.coefficients(inverse.slot);
    double rest = 0.0, last = 0.0;
    for (int k = order_; k > 0; --k) {
        rest = (rest + std::abs(b[k])) * length;
        if (k == order_ - 1) last = rest;
    }
    const double begin = std::abs(b[0]);
    if (rest < begin || !std::isfinite(rest)) return true;
    double constant = 1.0;
    for (const int weight : inverse.constants) constant *= std::abs(series.weight(weight));
    // as far as series and rounding tell
    const double noise = 64.0 * std::numeric_limits<double>::epsilon() * (begin + rest) +
                         2.0 * last * std::pow(length, order_ - 2),
                 value = least(b, length);
    // it is zero there, and none of these
    if (value < 0.25 * constant && noise < 0.25 * constant) return true;
    return value > noise && inverse.rate * std::log(begin / value) <= most_;
}

RBDYN_INLINE double HiddenTerms::least(const double* c, double length) const {
    constexpr int places = 16;
    const double side = c[0] < 0.0 ? -1.0 : 1.0, step = length / places;
    struct Point {
        double value, slope;
    };
    const auto at_place = [&](double tau) {
        Point p{0.0, 0.0};
        for (int k = order_; k >= 0; --k) {
            p.slope = p.slope * tau + p.value;
            p.value = p.value * tau + side * c[k];
        }
        return p;
    };
    Point last = at_place(0.0);
    double least = last.value;
    for (int k = 1; k <= places; ++k) {
        const Point now = at_place(k * step);
        least = std::min(least, now.value);
        if (last.slope < 0.0 && now.slope > 0.0) {
            double lo = (k - 1) * step, hi = k * step;
            for (int halving = 0; halving < 52; ++halving) {
                const double middle = 0.5 * (lo + hi);
                const Point between = at_place(middle);
                least = std::min(least, between.value);
                (between.slope < 0.0 ? lo : hi) = middle;
            }
        }
        last = now;
    }
    return least;
}

RBDYN_INLINE HiddenAhead::HiddenAhead(const Program& program) : hidden_(program, order) {
    if (!hidden_.no_pulses()) series_ = std::make_unique<SeriesEvaluator>(program, order);
}

RBDYN_INLINE void HiddenAhead::set_parameters(std::span<const double> parameters, Program::Rounding rounding) {
    if (series_) series_->set_parameters(parameters, rounding);
}

RBDYN_INLINE double HiddenAhead::held(Instant t, std::span<const double> x, double length) {
    if (none() || !(length > 0.0)) return length;
    // the length may be far more than the motion's own time: shorter units until the coefficients are in range
    constexpr int most_attempts = 16;
    double unit = length;
    for (int attempt = 0; attempt < most_attempts; ++attempt, unit *= 0x1p-16) {
        series_->begin(t.hi, unit);
        for (std::size_t i = 0; i < x.size(); ++i) series_->set_input(static_cast<int>(i), 0, x[i]);
        for (int k = 0; k < order; ++k) {
            series_->advance(k);
            series_->integrate(k);
        }
        if (series_->is_finite(order - 1)) break;
    }
    return unit * hidden_.held_pulses(*series_, length / unit);
}

}  // namespace rbdyn::inline RBDYN_FORM
