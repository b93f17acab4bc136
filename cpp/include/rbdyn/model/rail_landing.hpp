// Where a flying bead comes back to the rail it left (curve/crossing.hpp), on the pieces of an engine.
//
// Conventions: a piece holds the bead's position in the axes of the view; the curve is looked at in its own axes, whose
// third is the normal of its plane; those of a straight one are turned about it, towards where the rail pushes.
// What a piece's place and the integral of its velocity differ by is what the place is known to: a method whose
// polynomial is no series does not know the first powers of time to rounding, and where the bead has just left its rail
// these tell on which side it is.
// A bead beside the plane flies past the curve: it may come back only while all of its path lies in the plane within
// rounding.
#pragma once

#include <array>
#include <limits>
#include <mutex>
#include <optional>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/crossing.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/gap.hpp"
#include "rbdyn/curve/one_side.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

class RailLanding : public Locator {
public:
    /// `side`: where the bead may be. `parameter`, `position`: the first of the state variables that hold where the
    /// bead left its rail, its place in the view and its velocity.
    RailLanding(const Curve& curve, const curves::OneSide& side, const Placement& view, int parameter, int position,
                int velocity);

    std::optional<double> first(const Piece& piece, bool fresh) const override;

    /// The parameter of the curve at a place on it, in the view, of a bead that left it at `last`. Runs in several
    /// threads have one landing between them: nothing is kept from one call for the next.
    double place(const Vector3& r, double last) const;

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    using Path = std::array<double, curves::max_path_degree + 1>;

    /// Whether a path in the plane but for rounding, that of axes and of a long flight, is there at a time.
    static bool meets(const Path& x, const Path& y, const Path& z, int order, double tau);

    Curve curve_;
    mutable curves::LandingFinder finder_;
    int side_;
    Matrix3 turn_;
    Vector3 shift_;
    int parameter_, position_, velocity_;
    mutable std::mutex mutex_;
};

}  // namespace rbdyn::inline RBDYN_FORM
