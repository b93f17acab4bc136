// A cubic spline through points: r(k) = points[k], on each stretch between points a cubic of its own, C2.
//
// The slopes m_k = r'(k) follow from r'' being continuous at the points (de Boor, A Practical Guide to Splines, ch.
// IV):
//   m_(k-1) + 4 m_k + m_(k+1) = 3 (d_(k-1) + d_k),  d_k = points[k+1] - points[k]
// Ends are not-a-knot, as is usual: at the first and the last inner point r''' is continuous too, so that the two
// stretches about it are one cubic and four points on a cubic give that cubic. Three points give a parabola, two a
// line. A closed spline has no ends; its points are not repeated, its parameter counts on, n a round.
//
// Where `slopes` has r' at a point, that is what it is there, and r'' may jump: at an end (a clamped spline), or where
// the curvature of a rail changes at once, as from a straight to an arc. No other points than those between two such
// places, or a place and an end, then count for what lies between.
// Own axes: those of the line or plane that the points lie in (own_axes.hpp), about the first point.
// Invariant: r is C2 but where slopes are given, C1 everywhere, within rounding; r''' is constant on each stretch.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/axes.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/curve/polynomial_piece.hpp"
#include "rbdyn/curve/stretch.hpp"

namespace rbdyn::inline RBDYN_FORM {

class SplineForm;

struct Spline {
    std::vector<Vector3> points;         // world, [m]; at u = 0, 1, ...
    bool closed = false;                 // from the last point on to the first
    std::map<int, Vector3> slopes = {};  // r' at points, by index, world, [m]

    /// Throws InvalidInput unless there are two points, three if closed, all finite and none where its neighbour is,
    /// and slopes, if any, are at points, finite and not zero.
    void validate() const;

    /// Checked, and turned into its own axes; a Curve does this once.
    SplineForm form() const;

    bool operator==(const Spline&) const = default;
};

namespace curves {

/// Slopes at the points of a spline with these chords, one more than there are chords. Without a slope at an end:
/// not-a-knot, or what two or three points have.
std::vector<WideVector> spline_slopes(const std::vector<WideVector>& chord, const std::optional<WideVector>& begin,
                                      const std::optional<WideVector>& end);

/// Slopes of a closed spline: linear in the first of them, which follows from its own row.
std::vector<WideVector> closed_spline_slopes(const std::vector<WideVector>& chord);

}  // namespace curves

/// A spline in its own axes, ready to be evaluated.
class SplineForm {
public:
    explicit SplineForm(const Spline& spline);

    Placement placement() const { return placement_; }
    Domain domain() const { return closed_ ? Domain{} : Domain{0.0, static_cast<double>(last_)}; }
    bool closed() const { return closed_; }
    double period() const { return closed_ ? static_cast<double>(last_ + 1) : 0.0; }
    std::string name() const;

    /// The curve in its own axes.
    template <class S>
    CurvePoint<S> own(const S& u) const {
        const long k = stretch(u);
        return piece(k).template own<S>(u - S(static_cast<double>(k)));
    }
    /// r''' in own axes; at a point, that of the stretch after it.
    Vector3 third(double u) const;

    /// Signed arc length from u0 to u1, [m].
    double length(double u0, double u1) const;
    bool regular_at(double u) const;
    bool straight() const { return straight_; }
    /// The binormal where the curvature is zero within rounding, in own axes; nothing where the curve bends. On a
    /// straight stretch it is that of the last bend before.
    std::optional<Vector3> straight_binormal(double u) const;

    bool operator==(const SplineForm&) const = default;

private:
    /// Slopes at the beginnings of all stretches and at the end of the last.
    std::vector<curves::WideVector> slopes(const std::vector<curves::WideVector>& chord,
                                           const std::map<std::size_t, curves::WideVector>& given) const;

    template <class S>
    long stretch(const S& u) const {
        return curves::stretch(u, lowest_, highest_);
    }
    std::size_t index(long k) const;
    const curves::PolynomialPiece& piece(long k) const { return pieces_[index(k)]; }

    bool closed_, straight_ = false;
    std::size_t last_;               // index of the last point
    long lowest_ = 0, highest_ = 0;  // stretches by the whole number they begin at
    Placement placement_;
    std::vector<curves::PolynomialPiece> pieces_;
    std::vector<double> lengths_;  // of the stretches
    double round_ = 0.0;           // of all of them
};

}  // namespace rbdyn::inline RBDYN_FORM
