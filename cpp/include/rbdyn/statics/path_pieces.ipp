// Definitions of rbdyn/statics/path_pieces.hpp.
#pragma once

#include "rbdyn/statics/path_pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/series_sizes.hpp"
#include "rbdyn/series/roots.hpp"
#include "rbdyn/series/step_length.hpp"
#include "rbdyn/statics/path_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

RBDYN_INLINE std::vector<double> roots_about_middle(const double* c, int degree) {
    series::RootFinder finder;
    std::vector<double> right, left, all;
    std::array<double, order + 2> mirrored{};
    for (int k = 0; k <= degree; ++k) mirrored[static_cast<std::size_t>(k)] = k % 2 == 0 ? c[k] : -c[k];
    finder.find(mirrored.data(), degree, left);
    finder.find(c, degree, right);
    for (std::size_t k = left.size(); k-- > 0;) all.push_back(-left[k]);
    if (c[0] == 0.0) all.push_back(0.0);
    all.insert(all.end(), right.begin(), right.end());
    return all;
}

RBDYN_INLINE double PathPiece::bound() const {
    double sum = 0.0;
    for (const double c : output[PathForces::along]) sum += std::abs(c);
    return sum;
}

RBDYN_INLINE bool PathPiece::may_vanish(double x) const {
    return std::abs(value(PathForces::along, x)) <=
           std::max({noise(), rounding, 64.0 * std::numeric_limits<double>::epsilon() * bound()});
}

}  // namespace rbdyn::inline RBDYN_FORM::statics

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE const statics::PathPiece& PathPieces::about(double u, double half) {
    expand(u, half);
    return piece_;
}

RBDYN_INLINE std::array<double, statics::order + 1> PathPieces::sizes() {
    (*sizes_)(*series_);
    std::array<double, statics::order + 1> result;
    std::copy_n(sizes_->output(PathForces::along), statics::order + 1, result.begin());
    return result;
}

RBDYN_INLINE double PathPieces::rounding() {
    double sum = 0.0;
    for (const double size : sizes()) sum += size;
    return 64.0 * std::numeric_limits<double>::epsilon() * sum;
}

RBDYN_INLINE double PathPieces::rounding_of_place() const {
    double steepest = 0.0;
    for (int k = 1; k <= statics::order; ++k)
        steepest += k * std::abs(piece_.output[PathForces::along][static_cast<std::size_t>(k)]);
    const double far = std::abs(piece_.middle) / piece_.half;
    return 4.0 * std::numeric_limits<double>::epsilon() * far * steepest;
}

RBDYN_INLINE double PathPieces::natural(double u) {
    double unit = 1.0;
    if (u != 0.0) unit = power_of_two(std::abs(u));
    // measured in units near it
    for (int attempt = 0; attempt < 40; ++attempt) {
        expand(u, unit);
        // too far for doubles, unless there is none at any distance
        if (!is_finite_ && attempt == 4) return scale_of_values(u);
        if (!is_finite_) {
            unit *= 0x1p-24;
            continue;
        }
        double scale = std::isfinite(stretch_) ? stretch_ : ratio_;
        if (scale > 0.0 && !std::isfinite(scale)) scale = hidden();
        if (!(scale > 0.0) || !std::isfinite(scale)) return unit;
        if (scale > 1.0 / 64.0 && scale < 64.0) return unit * power_of_two(scale);
        unit *= power_of_two(std::clamp(scale, 0x1p-24, 0x1p24));
    }
    return unit;
}

RBDYN_INLINE double PathPieces::scale_of_values(double u) {
    PathForces::Values q(forces_);
    const double here = q(u), noise = 16.0 * std::numeric_limits<double>::epsilon() * forces_.effort(u);
    // beside that, and beside where in a gap the place is
    const double nearest = u == 0.0 ? 0x1p-1000 : 0x1p-36 * power_of_two(std::abs(u));
    const auto changes_within = [&](double h, double part) {
        return std::abs(q(u + h) - here) > part * std::abs(here) || std::abs(q(u - h) - here) > part * std::abs(here);
    };
    const bool is_zero = !std::isfinite(here) || std::abs(here) <= noise || changes_within(nearest, 0.5);
    double scale = std::numeric_limits<double>::infinity();
    for (const double way : {-1.0, 1.0}) {
        std::optional<double> power;
        double last = 0.0;
        // as far as it differs from what it is here by less than half of that, or goes as one power of the way
        for (double h = nearest; h < 0x1p1000 && h < scale; h *= 4.0) {
            const double there = q(u + way * h);
            if (!std::isfinite(there)) break;
            if (!is_zero) {
                if (std::abs(there - here) > 0.5 * std::abs(here)) scale = h;
                continue;
            }
            if (std::abs(there) > statics::least_force && std::abs(last) > statics::least_force) {
                const double now = 0.5 * std::log2(there / last);
                if (!power) power = now;
                if (!(std::abs(now - *power) <= 0.1 * std::max(1.0, std::abs(*power)))) scale = h;
            }
            last = there;
        }
    }
    if (std::isfinite(scale)) return scale;
    return u == 0.0 ? 1.0 : power_of_two(std::abs(u));
}

RBDYN_INLINE double PathPieces::noise_at(double u, double width) {
    const double noise = 16.0 * std::numeric_limits<double>::epsilon() * forces_.effort(u);
    expand(u, width);
    const double own = 8.0 * std::numeric_limits<double>::epsilon() * sizes()[0];
    return std::isfinite(own) ? std::max(noise, own) : noise;
}

RBDYN_INLINE bool PathPieces::has_values(double u) {
    choose(u);
    (*values_)(0.0, std::span<const double>(&u, 1));
    bool is_finite = std::isfinite(forces_.effort(u));
    for (int k = 0; k < formula_.outputs; ++k) is_finite = is_finite && std::isfinite(values_->output(k));
    return is_finite;
}

RBDYN_INLINE std::optional<double> PathPieces::leapt(double from, double way, double to, double least, double longest) {
    // a series that ends at a branch point reaches a seventh of the way there
    constexpr double part = 1.0 / 16.0;
    for (double width = 4.0 * least;; width *= 2.0) {
        if (!(width < std::abs(to - from))) return to;
        const double beyond = from + way * width;
        // at the very place they may not be, as x log |x|
        if (!has_values(beyond) && !has_values(beyond + way * part * width)) return std::nullopt;
        if (expand(beyond + way * part * width, part * width) || width > longest) return beyond;
    }
}

RBDYN_INLINE void PathPieces::refuse(double from, double way, double reach) {
    const double place = has_values(from) ? from + way * reach : from;
    throw InvalidInput(forces_.name() + ": at " + forces_.coordinate() + " " + text(place) + " " +
                       forces_.not_finite(place) + " is not finite; it must be wherever the body can come");
}

RBDYN_INLINE int PathPieces::doublings(double u) {
    const double unit = natural(u);
    expand(u, unit);
    if (!piece_.polynomial) return 0;
    (*sizes_)(*series_);
    double widest = std::abs(u) / unit;
    for (int j = 0; j < formula_.outputs + guards(); ++j) {
        const double *c = series_->output(j), *size = sizes_->output(j);
        int last = -1;
        for (int k = 0; k <= statics::order; ++k) {
            if (!(std::abs(c[k]) > 64.0 * std::numeric_limits<double>::epsilon() * size[k])) continue;
            if (last >= 0) widest = std::max(widest, std::pow(std::abs(c[last] / c[k]), 1.0 / (k - last)));
            last = k;
        }
    }
    return widest > 1.0 && std::isfinite(widest) ? static_cast<int>(std::ceil(std::log2(widest))) : 0;
}

RBDYN_INLINE double PathPieces::hidden() {
    (*sizes_)(*series_);
    double other = 0.0;
    for (int j = 0; j < formula_.outputs + guards(); ++j) {
        const double *c = series_->output(j), *size = sizes_->output(j);
        int most = 0;
        for (int k = 1; k <= statics::order; ++k)
            if (std::abs(c[k]) > std::abs(c[most])) most = k;
        for (int k = 0; k <= statics::order; ++k) {
            if (k == most || !(std::abs(c[k]) > 64.0 * std::numeric_limits<double>::epsilon() * size[k])) continue;
            const double scale = std::pow(std::abs(c[k] / c[most]), 1.0 / (most - k));
            if (other == 0.0 || scale < other) other = scale;
        }
    }
    return other;
}

RBDYN_INLINE std::vector<double> PathPieces::sides(double u) {
    (*values_)(0.0, std::span<const double>(&u, 1));
    std::vector<double> all;
    for (int k = 0; k < formula_.guards; ++k) all.push_back(values_->output(formula_.outputs + k));
    const int switches = static_cast<int>(formula_.program.switches().size());
    for (int k = 0; k < switches; ++k) all.push_back(values_->switch_value(k));
    return all;
}

RBDYN_INLINE bool PathPieces::changes_at(double u, double half) {
    if (formula_.is_smooth) return false;
    choose(u);
    const double aside = half * resolved(u, half);
    return !std::ranges::equal(sides(u - aside), sides(u + aside),
                               [](double a, double b) { return (a > 0.0) == (b > 0.0); });
}

RBDYN_INLINE std::optional<double> PathPieces::change_between(double low, double high) {
    if (formula_.is_smooth) return std::nullopt;
    choose(low);
    const std::vector<double> before = sides(low), after = sides(high);
    for (std::size_t k = 0; k < before.size(); ++k) {
        if (!(before[k] > 0.0 && after[k] < 0.0) && !(before[k] < 0.0 && after[k] > 0.0)) continue;
        for (int halvings = 0; halvings < 1200; ++halvings) {
            const double middle = low + 0.5 * (high - low);
            if (!(middle > low && middle < high)) break;
            const double there = sides(middle)[k];
            if (there == 0.0) return middle;
            ((there > 0.0) == (before[k] > 0.0) ? low : high) = middle;
        }
        return sides(low)[k] == 0.0 ? low : high;
    }
    return std::nullopt;
}

RBDYN_INLINE double PathPieces::power_of_two(double x) {
    int exponent = 0;
    std::frexp(x, &exponent);
    return std::ldexp(1.0, exponent - 1);
}

RBDYN_INLINE void PathPieces::resolve() {
    series_ = std::make_unique<SeriesEvaluator>(formula_.program, statics::order);
    series_->set_parameters(formula_.parameters);
    values_ = std::make_unique<Evaluator<double>>(formula_.program);
    values_->set_parameters(formula_.parameters);
    sizes_ = std::make_unique<SeriesSizes>(formula_.program, statics::order, true);
    sizes_->set_parameters(formula_.parameters);
}

RBDYN_INLINE void PathPieces::choose(double u) {
    if (formula_.is_smooth) return;
    const std::span<const double> place(&u, 1);
    // guards say what they do with the signs of the same place
    statics::set_signs(formula_.program, formula_.parameters, place);
    values_->set_parameters(formula_.parameters);
    bool is_right = true;
    if (formula_.guards > 0) (*values_)(0.0, place);
    for (int k = 0; k < formula_.guards; ++k) is_right = is_right && values_->output(formula_.outputs + k) > 0.0;
    if (!is_right) {
        formula_ = forces_.formula(u);
        resolve();
    }
    series_->set_parameters(formula_.parameters);
    sizes_->set_parameters(formula_.parameters);
}

RBDYN_INLINE bool PathPieces::ends(int output) {
    const double* c = series_->output(output);
    int last = statics::order;
    while (last > 0 && c[last] == 0.0) --last;
    if (last > statics::order - 4) return false;
    (*sizes_)(*series_);
    return std::abs(c[last]) > 64.0 * last * std::numeric_limits<double>::epsilon() * sizes_->output(output)[last];
}

RBDYN_INLINE bool PathPieces::expand(double middle, double half) {
    Interruption::point();
    choose(middle);
    series_->begin(0.0, 1.0);
    series_->set_input(0, 0, middle);
    series_->set_input(0, 1, half);
    for (int k = 2; k <= statics::order; ++k) series_->set_input(0, k, 0.0);
    for (int k = 0; k <= statics::order; ++k) series_->advance(k);
    piece_ = {};
    piece_.middle = middle;
    piece_.half = half;
    is_finite_ = true;
    const int outputs = formula_.outputs, all = outputs + guards();
    for (int j = 0; j < all; ++j)
        for (int k = 0; k <= statics::order; ++k) is_finite_ = is_finite_ && std::isfinite(series_->output(j)[k]);
    for (int j = 0; j < outputs; ++j)
        std::copy_n(series_->output(j), statics::order + 1, piece_.output[static_cast<std::size_t>(j)].begin());
    if (piece_.bound() < statics::least_force) piece_.output[PathForces::along].fill(0.0);
    piece_.effort = forces_.effort(middle);
    is_finite_ = is_finite_ && std::isfinite(piece_.effort);
    stretch_ = std::numeric_limits<double>::infinity();
    ratio_ = std::numeric_limits<double>::infinity();
    holds_ = false;
    if (!is_finite_) return false;
    for (int j = 0; j < all; ++j) {
        const double* c = j < outputs ? piece_.output[static_cast<std::size_t>(j)].data() : series_->output(j);
        std::array<double, statics::order + 1> size;
        for (int k = 0; k <= statics::order; ++k) size[static_cast<std::size_t>(k)] = std::abs(c[k]);
        const double e = piece_.effort;
        const double scale = j >= outputs ? size[0] : j == PathForces::hold ? e * e : e;
        double length = std::exp2(series::log_step(size.data(), statics::order, std::max(scale, size[0]), -53.0));
        if (std::isfinite(length) && j < outputs && ends(j)) length = std::numeric_limits<double>::infinity();
        stretch_ = std::min(stretch_, length);
        // of a polynomial: where its first two terms are equal, those that are not rounding
        const double largest = *std::max_element(size.begin(), size.end());
        const double least = 64.0 * std::numeric_limits<double>::epsilon() * std::max(scale, largest);
        int first = -1;
        for (int k = 0; k <= statics::order; ++k) {
            const double c_k = size[static_cast<std::size_t>(k)];
            if (!(c_k > least)) continue;
            if (first >= 0)
                ratio_ = std::min(ratio_, std::pow(size[static_cast<std::size_t>(first)] / c_k, 1.0 / (k - first)));
            else
                first = k;
        }
    }
    piece_.polynomial = std::isinf(stretch_);
    piece_.endless = piece_.polynomial && guards() == 0;
    holds_ = stretch_ >= 1.0;
    // what the middle does not know of shows at the ends, of the formula that is right in it
    for (const double x : {-1.0, 1.0}) {
        if (!holds_) break;
        const double u = piece_.place(x);
        const double e = forces_.effort(u);
        piece_.effort = std::max(piece_.effort, e);
        (*values_)(0.0, std::span<const double>(&u, 1));
        if (!std::isfinite(e)) continue;  // a formula that ends here
        const double off = std::abs(values_->output(PathForces::along) - piece_.value(PathForces::along, x));
        // of a long piece on which the force grows that end counts, not the other one
        const double known = 1e-11 * e + 1e-13 * piece_.bound();
        holds_ = off <= known || off <= statics::least_force || off <= rounding() || off <= rounding_of_place();
    }
    return holds_;
}

RBDYN_INLINE double PathPieces::first_change(double way) const {
    double first = 1.0;
    const double resolved = PathPieces::resolved(piece_.middle, piece_.half);
    for (int j = formula_.outputs; j < formula_.outputs + guards(); ++j) {
        const double* c = series_->output(j);
        for (const double x : statics::roots_about_middle(c, statics::order))
            if (way * x > -1.0 + resolved && way * x < first - resolved) first = way * x;
        // the middle itself, within rounding
        double size = 0.0;
        for (int k = 1; k <= statics::order; ++k) size += std::abs(c[k]);
        if (std::abs(c[0]) <= resolved * size && resolved < first) first = 0.0;
    }
    return first;
}

}  // namespace rbdyn::inline RBDYN_FORM
