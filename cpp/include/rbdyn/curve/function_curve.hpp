// A curve given by any function of its parameter: r(u), recorded, with the derivatives that follow from it.
//
// A component that is a constant in the recorded function vanishes in own axes: a plane curve parallel to two axes of
// the world has those axes, its own origin lies in its plane. A curve that its formula shows to be straight
// (formula.hpp) has the axes of Line, about a point of its own. Else own axes are the world's. Numbers of the
// user's (`Parameter`) are taken as they are when the curve is made.
//
// A function may distinguish cases, and so have places where r'' jumps, and others where r' or r does: there it has no
// tangent, and is not regular. A jump is one by more than 1e-9 of |r'|, to which the ends of a closed curve have to
// agree too.
//
// A closed curve meets itself in position and r' at the ends of the domain, and its parameter counts on. Where the
// function is one of sines and cosines and goes on with the same period it is used as it is; else the curve is
// repeated, with a jump of r'' at the seam if the function has it so. What rounding makes of r' and of r' x r'' is
// bounded by running error analysis (expression/rounded.hpp), the parameter itself being rounded: below that bound the
// curve has a cusp, or is straight. Invariant: finite, with r' and r'', at all samples of the domain.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/curve/arc_length.hpp"
#include "rbdyn/curve/checks.hpp"
#include "rbdyn/curve/formula.hpp"
#include "rbdyn/curve/own_axes.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/curve/stretch.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/rounded.hpp"

namespace rbdyn {

class FunctionForm;

struct FunctionCurve {
    Function function;       // of u; three results: r in the world, [m]
    Domain domain = {};      // finite, if closed
    bool closed = false;     // comes back to where it started
    std::string label = {};  // what messages call it

    /// Records f(u) -> three components: [](const auto& u) { return Vector3Of<...>{u, sin(u), 0.2 * u * u}; }
    template <class F>
    static Function recorded(F&& f) {
        return Function::record(1, [&](const std::vector<Expression>& u) {
            const Vector3Of<Expression> r = f(u[0]);
            return std::vector<Expression>{r[0], r[1], r[2]};
        });
    }

    std::string name() const { return label.empty() ? "curve of a function" : "curve of " + label; }

    /// Throws InvalidInput unless the function is one of a parameter with three components, the domain's begin is
    /// before its end, and both are finite if the curve is closed. What the function does is checked by form().
    void validate() const {
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

    /// Checked, and turned into its own axes; a Curve does this once. Throws InvalidInput if the function is not finite
    /// in its domain, stays at one point, or is said to be closed and is not.
    FunctionForm form() const;

    bool operator==(const FunctionCurve&) const = default;
};

/// A curve of a function in its own axes, ready to be evaluated.
class FunctionForm {
public:
    explicit FunctionForm(const FunctionCurve& curve)
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

    Placement placement() const { return placement_; }
    Domain domain() const { return closed_ ? Domain{} : domain_; }
    bool closed() const { return closed_; }
    double period() const { return closed_ ? domain_.end - domain_.begin : 0.0; }
    std::string name() const { return name_; }

    /// The curve in its own axes.
    template <class S>
    CurvePoint<S> own(const S& u) const {
        return at(local(u));
    }
    /// r''' in own axes.
    Vector3 third(double u) const {
        const double x = local(u);
        const std::vector<double> r = third_(std::span<const double>(&x, 1));
        return {r[0], r[1], r[2]};
    }

    /// Signed arc length from u0 to u1, [m].
    double length(double u0, double u1) const {
        if (u1 < u0) return -length(u1, u0);
        const long first = round(u0), last = round(u1);
        if (!closed_ || (first == last && !repeats_)) return plain_length(u0, u1);
        const double begin = u0 - shift(first), end = u1 - shift(last);
        if (first == last) return plain_length(begin, end);
        return plain_length(begin, domain_.end) + static_cast<double>(last - first - 1) * once_ +
               plain_length(domain_.begin, end);
    }
    bool regular_at(double u) const { return !may_vanish(rounded(point_, 3, local(u))); }
    /// Whether r or r' jumps, within rounding of u.
    bool jumps_at(double u) const {
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
    bool straight() const { return straight_; }
    /// The binormal where the curvature is zero within rounding, in own axes; nothing where the curve bends.
    ///
    /// For h -> 0 the cross product at u + h is r' times the first derivative r^(j) not along it, times
    /// h^(j - 2)/(j - 2)!; h < 0 gives the limit from the side of smaller u.
    std::optional<Vector3> straight_binormal(double u) const {
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

    bool operator==(const FunctionForm&) const = default;

private:
    using Components = Vector3Of<Rounded>;
    static constexpr double agreed = 1e-9;  // relative, of the ends of a closed curve

    /// Records r, r', r'' and r''' in the axes given, of which the first few are kept.
    void record(const Function& function, const curves::WideMatrix& axes, const Vector3& origin, int dimension) {
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

    /// What the samples of the domain show.
    struct Looked {
        double fastest;        // sample where |r'| is largest
        double extent, speed;  // of positions; largest |r'|
    };

    /// Parameters all over the domain: equally spaced, and at distances that fit no period.
    std::vector<double> samples() const {
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

    /// Throws InvalidInput unless the function is finite, with its derivatives, and moves. Of a domain without end only
    /// the first sample must be so.
    Looked look() const {
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

    void require_finite(const CurvePoint<double>& p, double u) const {
        for (int i = 0; i < 3; ++i)
            for (const auto& [what, value] :
                 {std::pair{"", p.position[i]}, std::pair{"r' of ", p.first[i]}, std::pair{"r'' of ", p.second[i]}})
                require(std::isfinite(value), name_,
                        what + ("component " + std::to_string(i)) + " at parameter " + text(u), value,
                        "a curve is finite and smooth in its domain, ends included: choose the domain accordingly");
    }

    /// Throws InvalidInput unless the ends meet; finds whether the function goes on with the same period.
    void close(const Looked& looked) {
        const CurvePoint<double> begin = at(domain_.begin), end = at(domain_.end);
        const double gap = curves::norm(end.position - begin.position), turn = curves::norm(end.first - begin.first);
        require(gap <= agreed * looked.extent, name_, "distance between the ends", gap,
                "a closed curve ends where it began, within " + text(agreed) + " of its extent, " +
                    text(looked.extent) + " m");
        require(
            turn <= agreed * looked.speed, name_, "difference of r' at the ends", turn,
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

    /// By the recorded function, without counting rounds.
    template <class S>
    CurvePoint<S> at(const S& u) const {
        const std::vector<S> y = point_(std::span<const S>(&u, 1));
        return curve_point<S>({y[0], y[1], y[2]}, {y[3], y[4], y[5]}, {y[6], y[7], y[8]});
    }
    template <class S>
    long round(const S& u) const {
        if (!closed_) return 0;
        return curves::stretch((u - S(domain_.begin)) * S(1.0 / period()), -curves::most_stretches,
                               curves::most_stretches);
    }
    double shift(long rounds) const { return static_cast<double>(rounds) * period(); }
    /// The parameter in the domain, if the function does not go on by itself.
    template <class S>
    S local(const S& u) const {
        if (!repeats_) return u;
        return u - S(shift(round(u)));
    }

    double plain_length(double u0, double u1) const {
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
    /// Where one formula ends between two parameters and another begins, as far as samples show it, and the last one.
    std::vector<double> formula_ends(double u0, double u1) const {
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

    /// Three results of a recorded function, with bounds on their rounding, u being known to a unit in its last place.
    static Components rounded(const Function& function, std::size_t result, double u) {
        Rounded x(u);
        x.error = std::numeric_limits<double>::epsilon() * std::abs(u);
        const std::vector<Rounded> y = function(std::span<const Rounded>(&x, 1));
        return {y[result], y[result + 1], y[result + 2]};
    }
    static double error_of(const Components& v) { return v[0].error + v[1].error + v[2].error; }
    /// What rounding may make of the difference of three results at two parameters.
    double rounding(std::size_t result, double a, double b) const {
        double sum = 0.0;
        for (const double u : {a, b}) sum += error_of(rounded(point_, result, local(u)));
        return 2.0 * sum;
    }
    static bool may_vanish(const Components& v) { return v[0].may_vanish() && v[1].may_vanish() && v[2].may_vanish(); }
    /// a x b, unless it may vanish.
    static std::optional<Vector3> turning(const Components& a, const Components& b) {
        const Components product = cross<Rounded>(a, b);
        if (may_vanish(product)) return std::nullopt;
        return Vector3(product[0].value, product[1].value, product[2].value);
    }

    Domain domain_;  // of one round, if closed
    bool closed_;
    std::string name_;
    Function point_;  // r, r', r'' in own axes
    Function third_;
    Function distinctions_;  // what cases are distinguished by
    Placement placement_;
    bool straight_ = false;
    bool may_have_corners_ = false;
    bool repeats_ = false;           // rounds are counted: the function does not go on by itself
    double once_ = 0.0;              // length of a round
    double gap_ = 0.0, turn_ = 0.0;  // by which r and r' may differ at the ends of one
};

inline FunctionForm FunctionCurve::form() const {
    validate();
    return FunctionForm(*this);
}

}  // namespace rbdyn
