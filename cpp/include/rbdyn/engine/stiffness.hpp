// Whether steps of a Taylor series are kept short by stability and not by the motion.
//
// On a stiff motion the fast part has died away, and what is left of it, an error below the tolerance, rules the last
// coefficients of the series: they are those of a linear motion with the exact Jacobian J of the equations,
//     (k+1) x_{k+1} = J x_k,
// whose largest eigenvalue is damped, and steps are as long as the series of that order is stable, h |lambda| some 0.37
// p
// + 1.3 (Hairer and Wanner, Solving Ordinary Differential Equations II, IV.2; measured for p = 12 to 24). Where steps
// follow the motion one of the three is not so: coefficients come from a singularity, which no linear motion has, or
// from an oscillation, or steps are shorter.
#pragma once

#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/engine/motion_scales.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/state_jacobian.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The fast part of a motion, by the exact Jacobian. Of one set of equations.
class Stiffness {
public:
    explicit Stiffness(const Equations& equations);

    /// Whether a step of a series may be at the limit of its stability: by the size of its last coefficients alone.
    static bool may_rule(const Piece& step, const Equations& equations, const MotionScales& scales);
    /// How long a step is, in 1 / |lambda|, from where on it is taken for one at the limit of stability: a third less
    /// than that is. Steps that follow a motion which dies away are as short.
    static double least_reach(int order) { return 0.25 * order + 0.9; }

    /// Whether a step of a series was kept short by stability. Variables are measured by the scales of their groups.
    bool rules(const Piece& step, std::span<const double> parameters, Program::Rounding rounding,
               const MotionScales& scales);

    /// h |lambda| of the step that was looked at last.
    double reach() const { return reach_; }
    /// |lambda| at a state [1/s]: by some iterations of the Jacobian there on the fast part known so far.
    double rate(double t, std::span<const double> x);
    /// Entries that a step of BDF goes through to solve its equations.
    double solving() const;

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    void differentiate(double t, std::span<const double> x);
    /// D^-1 J D v, with the scales D of the variables.
    void apply(std::span<const double> v, std::span<double> out) const;

    const Equations& equations_;
    StateJacobian jacobian_;
    double reach_ = 0.0;
    mutable double solving_ = 0.0;  // once it is asked for
    std::vector<double> entries_, scale_, fast_;
};

}  // namespace rbdyn::inline RBDYN_FORM
