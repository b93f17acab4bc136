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

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/curve/stretch.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/functor.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/rounded.hpp"

namespace rbdyn::inline RBDYN_FORM {

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
            const Vector3Of<Expression> r = recording::vector(f, u[0]);
            return std::vector<Expression>{r[0], r[1], r[2]};
        });
    }

    std::string name() const { return label.empty() ? "curve of a function" : "curve of " + label; }

    /// Throws InvalidInput unless the function is one of a parameter with three components, the domain's begin is
    /// before its end, and both are finite if the curve is closed. What the function does is checked by form().
    void validate() const;

    /// Checked, and turned into its own axes; a Curve does this once. Throws InvalidInput if the function is not finite
    /// in its domain, stays at one point, or is said to be closed and is not.
    FunctionForm form() const;

    bool operator==(const FunctionCurve&) const = default;
};

/// A curve of a function in its own axes, ready to be evaluated.
class FunctionForm {
public:
    explicit FunctionForm(const FunctionCurve& curve);

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
    Vector3 third(double u) const;

    /// Signed arc length from u0 to u1, [m].
    double length(double u0, double u1) const;
    bool regular_at(double u) const { return !may_vanish(rounded(point_, 3, local(u))); }
    /// Whether r or r' jumps, within rounding of u.
    bool jumps_at(double u) const;
    bool straight() const { return straight_; }
    /// The binormal where the curvature is zero within rounding, in own axes; nothing where the curve bends.
    ///
    /// For h -> 0 the cross product at u + h is r' times the first derivative r^(j) not along it, times
    /// h^(j - 2)/(j - 2)!; h < 0 gives the limit from the side of smaller u.
    std::optional<Vector3> straight_binormal(double u) const;

    bool operator==(const FunctionForm&) const = default;

private:
    using Components = Vector3Of<Rounded>;
    static constexpr double agreed = 1e-9;  // relative, of the ends of a closed curve

    /// Records r, r', r'' and r''' in the axes given, of which the first few are kept.
    void record(const Function& function, const curves::WideMatrix& axes, const Vector3& origin, int dimension);

    /// What the samples of the domain show.
    struct Looked {
        double fastest;        // sample where |r'| is largest
        double extent, speed;  // of positions; largest |r'|
    };

    /// Parameters all over the domain: equally spaced, and at distances that fit no period.
    std::vector<double> samples() const;

    /// Throws InvalidInput unless the function is finite, with its derivatives, and moves. Of a domain without end only
    /// the first sample must be so.
    Looked look() const;

    void require_finite(const CurvePoint<double>& p, double u) const;

    /// Throws InvalidInput unless the ends meet; finds whether the function goes on with the same period.
    void close(const Looked& looked);

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

    double plain_length(double u0, double u1) const;
    /// Where one formula ends between two parameters and another begins, as far as samples show it, and the last one.
    std::vector<double> formula_ends(double u0, double u1) const;

    /// Three results of a recorded function, with bounds on their rounding, u being known to a unit in its last place.
    static Components rounded(const Function& function, std::size_t result, double u);
    static double error_of(const Components& v) { return v[0].error + v[1].error + v[2].error; }
    /// What rounding may make of the difference of three results at two parameters.
    double rounding(std::size_t result, double a, double b) const;
    static bool may_vanish(const Components& v) { return v[0].may_vanish() && v[1].may_vanish() && v[2].may_vanish(); }
    /// a x b, unless it may vanish.
    static std::optional<Vector3> turning(const Components& a, const Components& b);

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

}  // namespace rbdyn::inline RBDYN_FORM
