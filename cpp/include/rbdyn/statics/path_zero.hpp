// A zero of the force along a path (path_forces.hpp): where, of which order, and what the force does about it.
//
// Order m: the first coefficient of Q in powers of the way from there that is not the rounding of its own terms
// (series_sizes.hpp), those before it being nothing else; the place is the zero of the derivative of order m - 1.
// Orders up to that of the series are tried, from the highest: zeros that rounding does not let be told apart are one.
// U has a strict maximum there, eq. 7.16, if m is odd and the coefficient negative. Nothing here has a scale: terms are
// compared with terms of the same order.
#pragma once

#include <array>
#include <limits>
#include <optional>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/statics/path_pieces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

struct PathZero {
    double place = 0.0;
    int order = 0;        // 0: rounding hides it
    double lead = 0.0;    // the coefficient of that order, in units of the length it was looked at with
    double radius = 0.0;  // within which rounding leaves it
    bool is_stable() const { return order % 2 == 1 && lead < 0.0; }
};

class PathZeros {
public:
    explicit PathZeros(PathPieces& pieces) : pieces_(pieces) {}

    /// The zero near u, looked at in units of `half`; none if there is none within rounding.
    std::optional<PathZero> near(double u, double half);

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();

    /// Coefficients about u, and their rounding with that of u itself.
    void look(double u, double half);

    std::optional<PathZero> of_order(int m, double u, double half);

    PathPieces& pieces_;
    std::array<double, order + 1> c_{}, rounding_{};
};

}  // namespace rbdyn::inline RBDYN_FORM::statics
