// The force that is left along one freedom as it is moved, all others relaxed, to 32 digits.
//
// The reduction of Lyapunov and Schmidt (Golubitsky and Schaeffer, "Singularities and Groups in Bifurcation Theory I",
// Springer 1985, ch. VII) with a freedom s as the coordinate of the way: f_i = 0 of all others leaves g(s) = f_s, the
// slope of U on the way. It is told as a polynomial through its values at Chebyshev's places; what the highest powers
// leave is the noise of all of it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

/// Powers of x = s/half, |x| <= 1.
struct ReducedPowers {
    static constexpr int degree = 18;
    std::array<DoubleDouble, degree + 1> c{};
    double noise = 0.0;  // of the values
    double size = 0.0;   // the largest of what the values are sums of

    /// What noise makes of a power.
    double noise_of(int k) const;
    double largest() const;
    /// In powers of x - `to`.
    ReducedPowers shifted(const DoubleDouble& to) const;
};

class ReducedForce {
public:
    /// `held`: the freedom that is moved. The place becomes the one that `forces` looks at.
    ReducedForce(TreeForces& forces, TreeForces::Wide place, int held);

    struct Sample {
        double force = 0.0, size = 0.0;  // and what it is a sum of
        DoubleDouble exact;
        TreeForces::Wide place;
    };
    /// None where the others are not relaxed to 32 digits.
    std::optional<Sample> at(const DoubleDouble& way) const;
    std::optional<ReducedPowers> powers(double half) const;

private:
    TreeForces& forces_;
    TreeForces::Wide place_;
    int held_;
    SquareMatrix inverse_;  // of the slopes of the others
    bool is_regular_ = true;
};

}  // namespace rbdyn::inline RBDYN_FORM::statics
