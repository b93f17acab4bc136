// Definitions of rbdyn/curve/function_curve.hpp.
#pragma once

#include "rbdyn/curve/function_curve.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/arc_length.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/checks.hpp"
#include "rbdyn/curve/formula.hpp"
#include "rbdyn/curve/own_axes.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/parameter.hpp"
#include "rbdyn/expression/rounded.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void FunctionCurve::validate() const {
    require(static_cast<bool>(function) && function.inputs() == 1, name(), "number of arguments",
            function ? function.inputs() : 0, "the function takes the parameter alone");
    require(function.outputs() == 3, name(), "number of components", function.outputs(),
            "the function gives the three components of a position, in m");
    if (!function.parameters().empty())
        throw InvalidInput(name() + ": its function uses " + function.parameters().front().description() +
                           ", and a curve is measured once, when it is made; use a plain number in it, and make a "
                           "curve for each value");
    curves::require_domain(name(), domain);
    if (closed)
        for (const double end : {domain.begin, domain.end})
            require(std::isfinite(end), name(), "an end of the domain", end,
                    "a closed curve has a finite domain, which is one round");
}

RBDYN_INLINE FunctionForm::FunctionForm(const FunctionCurve& curve)
    : domain_(curve.domain), closed_(curve.closed), name_(curve.name()) {
    const Function function = curve.function.frozen();
    bool constant[3];
    Function::record(1, [&](const std::vector<Expression>& u) {
        const std::vector<Expression> r = function(std::span<const Expression>(u));
        for (std::size_t i = 0; i < 3; ++i) {
            constant[i] = r[i].is_constant();
            if (constant[i]) placement_.origin[static_cast<Eigen::Index>(i)] = r[i].value();
        }
        return r;
    });
    const int moving = !constant[0] + !constant[1] + !constant[2];
    require(moving > 0, name_, "number of components that depend on the parameter", moving,
            "one must: a curve is not a single point");
    record(function, widened(Matrix3(Matrix3::Identity())), Vector3::Zero(), 3);
    const Looked looked = look();
    straight_ = curves::is_on_line(function);
    may_have_corners_ = curves::may_have_corners(function);
    distinctions_ = function.distinctions();
    if (straight_) {
        placement_ = placed(at(samples().front()).position, curves::axes_of_line(at(looked.fastest).first));
    } else if (moving == 2) {
        placement_ = placed(placement_.origin, curves::axes_without(constant[2] ? 2 : constant[1] ? 1 : 0));
    } else {
        placement_ = {};
    }
    record(function, placement_.exact_axes(), placement_.origin, straight_ ? 1 : moving);
    repeats_ = closed_ && !curves::is_of_angles(function);
    if (closed_) close(looked);
}

RBDYN_INLINE Vector3 FunctionForm::third(double u) const {
    const double x = local(u);
    const std::vector<double> r = third_(std::span<const double>(&x, 1));
    return {r[0], r[1], r[2]};
}

RBDYN_INLINE double FunctionForm::length(double u0, double u1) const {
    if (u1 < u0) return -length(u1, u0);
    const long first = round(u0), last = round(u1);
    if (!closed_ || (first == last && !repeats_)) return plain_length(u0, u1);
    const double begin = u0 - shift(first), end = u1 - shift(last);
    if (first == last) return plain_length(begin, end);
    return plain_length(begin, domain_.end) + static_cast<double>(last - first - 1) * once_ +
           plain_length(domain_.begin, end);
}

RBDYN_INLINE bool FunctionForm::jumps_at(double u) const {
    if (!may_have_corners_ && !repeats_) return false;
    const Domain all = domain();
    const bool is_finite = std::isfinite(domain_.begin) && std::isfinite(domain_.end);
    const double scale = std::max(std::abs(u), is_finite ? domain_.end - domain_.begin : 1.0);
    // from a few roundings of u to what a root of a motion may be wrong by
    for (const double near : {0x1p-46, 0x1p-40, 0x1p-34}) {
        const double a = std::max(u - near * scale, all.begin), b = std::min(u + near * scale, all.end);
        const CurvePoint<double> p = own(a), q = own(b);
        const double speed = std::max(curves::norm(p.first), curves::norm(q.first)),
                     bend = std::max(curves::norm(p.second), curves::norm(q.second));
        const double size = std::max(curves::norm(p.position), curves::norm(q.position));
        const double way = 2.0 * speed * (b - a) + rounding(0, a, b) + agreed * size + gap_,
                     turn = 2.0 * bend * (b - a) + rounding(3, a, b) + agreed * speed + turn_;
        if (curves::norm(q.position - p.position) > way || curves::norm(q.first - p.first) > turn) return true;
    }
    return false;
}

RBDYN_INLINE std::optional<Vector3> FunctionForm::straight_binormal(double u) const {
    const double x = local(u);
    // one normal all along, also where the curve goes back on itself
    if (straight_) return Vector3(0.0, 0.0, at(x).first.x() < 0.0 ? -1.0 : 1.0);
    const Components first = rounded(point_, 3, x);
    if (turning(first, rounded(point_, 6, x))) return std::nullopt;
    // derivatives of a function are few digits long before long: what eight of them do not show is taken as
    // rounding
    constexpr int most = 8;
    Function derivative = third_;
    for (int j = 3; j <= most; ++j) {
        if (const auto product = turning(first, rounded(derivative, 0, x)))
            return (j % 2 == 0 ? 1.0 : -1.0) * curves::unit(*product);
        derivative = derivative.derivative(0);
    }
    return curves::binormal_of_line(placement_.axes, at(x).first);
}

RBDYN_INLINE void FunctionForm::record(const Function& function, const curves::WideMatrix& axes, const Vector3& origin,
                                       int dimension) {
    const recording::WideFolding all_digits;
    const curves::WideMatrix back = axes.transpose();
    const Function r = Function::record(1, [&](const std::vector<Expression>& u) {
        const std::vector<Expression> world = function(std::span<const Expression>(u));
        Vector3Of<Expression> offset;
        for (int i = 0; i < 3; ++i) offset[i] = world[static_cast<std::size_t>(i)] - Expression(origin[i]);
        const Vector3Of<Expression> own = curves::turned<Expression>(back, offset);
        std::vector<Expression> kept(3, Expression(0.0));
        for (int i = 0; i < dimension; ++i) kept[static_cast<std::size_t>(i)] = own[i];
        return kept;
    });
    const Function first = r.derivative(0), second = first.derivative(0);
    third_ = second.derivative(0);
    point_ = Function::record(1, [&](const std::vector<Expression>& u) {
        std::vector<Expression> all;
        for (const Function* f : {&r, &first, &second})
            for (const Expression& component : (*f)(std::span<const Expression>(u))) all.push_back(component);
        return all;
    });
}

RBDYN_INLINE std::vector<double> FunctionForm::samples() const {
    constexpr double golden = 0.6180339887498949;
    constexpr int count = 32;
    const bool has_begin = std::isfinite(domain_.begin), has_end = std::isfinite(domain_.end);
    std::vector<double> u;
    if (has_begin && has_end) {
        const double size = domain_.end - domain_.begin;
        for (int i = 0; i <= count; ++i) u.push_back(i == count ? domain_.end : domain_.begin + size * i / count);
        for (int i = 1; i <= count; ++i) u.push_back(domain_.begin + size * (i * golden - std::floor(i * golden)));
        return u;
    }
    const double from = has_begin ? domain_.begin : has_end ? domain_.end : 0.0;
    u.push_back(from);
    for (int k = -8; k <= 8; k += 2) {
        if (!has_end) u.push_back(from + std::ldexp(golden, k));
        if (!has_begin) u.push_back(from - std::ldexp(golden, k));
    }
    return u;
}

RBDYN_INLINE FunctionForm::Looked FunctionForm::look() const {
    const bool all = std::isfinite(domain_.begin) && std::isfinite(domain_.end);
    Looked looked{0.0, 0.0, 0.0};
    std::optional<Vector3> low, high;
    bool is_first = true;
    for (const double u : samples()) {
        const CurvePoint<double> p = at(u);
        const bool finite = is_finite(p.position) && is_finite(p.first) && is_finite(p.second);
        if (all || is_first) require_finite(p, u);
        is_first = false;
        if (!finite) continue;
        low = low ? lesser(*low, p.position) : p.position;
        high = high ? greater(*high, p.position) : p.position;
        const Components first = rounded(point_, 3, u);
        const double speed = may_vanish(first) ? 0.0 : curves::norm(p.first);
        if (speed > looked.speed) {
            looked.speed = speed;
            looked.fastest = u;
        }
    }
    looked.extent = curves::norm(*high - *low);
    require(looked.speed > 0.0, name_, "the largest |r'|", looked.speed,
            "beyond rounding it must not be zero: a curve is not a single point");
    return looked;
}

RBDYN_INLINE void FunctionForm::require_finite(const CurvePoint<double>& p, double u) const {
    for (int i = 0; i < 3; ++i)
        for (const auto& [what, value] :
             {std::pair{"", p.position[i]}, std::pair{"r' of ", p.first[i]}, std::pair{"r'' of ", p.second[i]}})
            require(std::isfinite(value), name_, what + ("component " + std::to_string(i)) + " at parameter " + text(u),
                    value, "a curve is finite and smooth in its domain, ends included: choose the domain accordingly");
}

RBDYN_INLINE void FunctionForm::close(const Looked& looked) {
    const CurvePoint<double> begin = at(domain_.begin), end = at(domain_.end);
    const double gap = curves::norm(end.position - begin.position), turn = curves::norm(end.first - begin.first);
    require(
        gap <= agreed * looked.extent, name_, "distance between the ends", gap,
        "a closed curve ends where it began, within " + text(agreed) + " of its extent, " + text(looked.extent) + " m");
    require(turn <= agreed * looked.speed, name_, "difference of r' at the ends", turn,
            "a closed curve ends as it began, within " + text(agreed) + " of the largest |r'|, " + text(looked.speed));
    for (const double u : samples())
        for (const double other : {u + period(), u - period()}) {
            const CurvePoint<double> p = at(u), q = at(other);
            repeats_ = repeats_ || !(curves::norm(q.position - p.position) <= agreed * looked.extent) ||
                       !(curves::norm(q.first - p.first) <= agreed * looked.speed);
        }
    if (repeats_) {
        gap_ = 2.0 * agreed * looked.extent;
        turn_ = 2.0 * agreed * looked.speed;
    }
    once_ = plain_length(domain_.begin, domain_.end);
}

RBDYN_INLINE double FunctionForm::plain_length(double u0, double u1) const {
    // points and parameters are themselves rounded: no length is known better than that
    double size = 0.0;
    for (const double u : {u0, u1}) {
        const CurvePoint<double> p = at(u);
        size = std::max(size, curves::norm(p.position) + std::abs(u) * curves::norm(p.first));
    }
    const double floor = 8.0 * std::numeric_limits<double>::epsilon() * size;
    double length = 0.0, from = u0;
    for (const double to : formula_ends(u0, u1)) {
        length += curves::arc_length([&](double u) { return curves::norm(at(u).first); }, from, to, floor, name_);
        from = to;
    }
    return length;
}

RBDYN_INLINE std::vector<double> FunctionForm::formula_ends(double u0, double u1) const {
    std::vector<double> ends;
    constexpr int parts = 64;
    const auto value = [&](double u, int k) {
        return distinctions_(std::span<const double>(&u, 1))[static_cast<std::size_t>(k)];
    };
    for (int k = 0; k < distinctions_.outputs(); ++k)
        for (int i = 0; i < parts; ++i) {
            double a = u0 + (u1 - u0) * i / parts, b = i + 1 == parts ? u1 : u0 + (u1 - u0) * (i + 1) / parts;
            const bool is_above = value(a, k) > 0.0;
            if ((value(b, k) > 0.0) == is_above) continue;
            for (double m = a + 0.5 * (b - a); m > a && m < b; m = a + 0.5 * (b - a))
                ((value(m, k) > 0.0) == is_above ? a : b) = m;
            if (b > u0 && b < u1) ends.push_back(b);
        }
    std::sort(ends.begin(), ends.end());
    ends.push_back(u1);
    return ends;
}

RBDYN_INLINE FunctionForm::Components FunctionForm::rounded(const Function& function, std::size_t result, double u) {
    Rounded x(u);
    x.error = std::numeric_limits<double>::epsilon() * std::abs(u);
    const std::vector<Rounded> y = function(std::span<const Rounded>(&x, 1));
    return {y[result], y[result + 1], y[result + 2]};
}

RBDYN_INLINE double FunctionForm::rounding(std::size_t result, double a, double b) const {
    double sum = 0.0;
    for (const double u : {a, b}) sum += error_of(rounded(point_, result, local(u)));
    return 2.0 * sum;
}

RBDYN_INLINE std::optional<Vector3> FunctionForm::turning(const Components& a, const Components& b) {
    const Components product = cross<Rounded>(a, b);
    if (may_vanish(product)) return std::nullopt;
    return Vector3(product[0].value, product[1].value, product[2].value);
}

RBDYN_INLINE FunctionForm FunctionCurve::form() const {
    validate();
    return FunctionForm(*this);
}

}  // namespace rbdyn::inline RBDYN_FORM
