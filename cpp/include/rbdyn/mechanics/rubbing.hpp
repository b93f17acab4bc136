// Friction in all rough joints of a tree at an instant, from what they do: T = k |R| of each that moves, and of each
// that is held what keeps its acceleration zero. R is linear in the friction of all of them, so that with the
// directions of all R given the problem is linear; taking these anew from its solution is Newton's method for |R|.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"
#include "rbdyn/mechanics/joint_friction.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace tree_joints {

struct Rubbing {
    std::vector<double> acceleration;         // of each joint without friction
    std::vector<std::array<double, 2>> load;  // what presses it then
    std::vector<double> noise, load_size;     // sizes of rounding of friction, sizes of what loads are made of
    mechanics::Square matrix;                 // accelerations by units of friction
    std::vector<double> alone;                // of each by its own, if nothing closed the tree
    std::vector<std::vector<std::array<double, 2>>> by;

    // in place of a sign: its bead flies; it is at rest beside others that hold, without friction or, +-, at its limit
    static constexpr int gone = 2, idle = 4, stays = 8;

    struct Answer {
        std::vector<double> friction, acceleration;
        std::vector<std::array<double, 2>> load;
        bool is_solved = false;
        double pressing(std::size_t i) const { return std::hypot(load[i][0], load[i][1]); }
    };
    /// `sign`: of the rate of each, zero where it is held.
    Answer solve(const std::vector<mechanics::RoughJoint>& joints, const std::vector<int>& sign) const;
    /// Of some joints those, from the first on, whose accelerations do not depend on each other's: these can hold.
    std::vector<std::size_t> independent(const std::vector<std::size_t>& of) const;
    /// Ways for joints that do depend on each other to be at rest together: as many hold as that takes, and the others
    /// do nothing or stay at their limits. These are the corners of all there are, so that one of them is within all
    /// limits if any is. Puts the first for which `holds` into `sign`; false: there is none.
    bool share(const std::vector<std::size_t>& resting, std::vector<int>& sign,
               const std::function<bool(const std::vector<int>&)>& holds) const;
};

}  // namespace tree_joints

}  // namespace rbdyn::inline RBDYN_FORM
