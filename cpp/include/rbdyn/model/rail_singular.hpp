// Where a bead comes to a singular point of its rail (curve/regular_stretch.hpp), on the pieces of an engine.
//
// Ways of going wrong, all smooth in time:
//   through r' = 0     u(t) passes a cusp that the bead comes to slowly
//   across a corner    u(t) goes on with the formula of one side
//   back from |r'| = infinity   u(t) turns at the last parameter of a slope that becomes vertical, with a speed |r'|
//   |w|
//                               that is not zero: on both sides of a turn a bead is as fast as it is long from it, and
//                               there it is as fast everywhere
// And one for a bead that flies: into the tip of a cusp, closer than a landing on either branch is looked for.
#pragma once

#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/curve/regular_stretch.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/series/roots.hpp"

namespace rbdyn::inline RBDYN_FORM {

class RailSingularity : public Locator {
public:
    /// A bead that starts at u. `parameter`, `rate`: the state variables u and w.
    RailSingularity(const Curve& curve, double u, int parameter, int rate);

    std::optional<double> first(const Piece& piece, bool /*fresh*/) const override;

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();

    static constexpr double most_even = 16.0;  // |r''| times a way along u, in parts of |r'|

    /// A polynomial on the unit interval.
    void take(const double* c, int order, double length) const;

    /// Where the parameter goes past an end of the stretch, outward.
    std::optional<double> passed(int order, double end, double sign) const;

    /// Where the parameter turns though the bead does not: at twice the distance in time from a turn the speed is twice
    /// as large, not the same.
    std::optional<double> turned(const double* u, const double* w, const Piece& piece, double width) const;

    /// |r'| and |r''|.
    std::pair<double, double> norm(double u) const;

    mutable curves::RegularStretch stretch_;
    int parameter_, rate_;
    mutable std::mutex mutex_;
    mutable std::vector<double> scaled_, roots_;
    mutable series::RootFinder finder_;
};

/// Where a flying bead comes to a singular point of the rail it has left.
class SingularLanding : public Locator {
public:
    /// `u`: where it starts. `position`: the first of the state variables that hold its place in the view.
    SingularLanding(Curve curve, double u, const Placement& view, int position);

    std::optional<double> first(const Piece& piece, bool /*fresh*/) const override;

private:
    double away(const Piece& piece, const Vector3& place, double tau) const;
    /// The time of least distance, from samples and by thirds between their neighbours.
    double closest(const Piece& piece, const Vector3& place) const;

    /// Looked for when it is first asked for: most beads never fly.
    const std::vector<Vector3>& places() const;

    Curve curve_;
    Placement view_;
    double start_;
    int position_;
    mutable std::mutex mutex_;
    mutable std::optional<std::vector<Vector3>> places_;
};

/// What is singular in a curve near a parameter, in words; empty if nothing is.
std::string singular_at(const Curve& curve, double u);

}  // namespace rbdyn::inline RBDYN_FORM
