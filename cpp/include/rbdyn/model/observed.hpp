// What the accuracy of a motion is judged by: what models show of it, each with the sizes it is measured against.
#pragma once

#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A vector or number of a motion whose error is judged by a scale of its own.
struct Observed {
    Vector3 value = Vector3::Zero();
    bool is_position = false;  // scale: the extent of the motion; else the largest size
    double size = 0.0;         // its own size, if that is more than its length
    double whole = 0.0;        // what it is a difference of: far below this it is rounding
    Alike alike = Alike::nothing;
    float held = 0.0F;   // of what constraints hold at zero: what it would be, did it move like all else
    double drive = 0.0;  // m/s^2: of a velocity that follows its position, the sizes of accelerations that make it up
    double part = 1.0;   // of its error, what counts
    double none = 0.0;   // of its error, what is rounding that is not told
    double from = 0.0;   // of a place, from how far it is held: as `whole`, but its rounding is not told
    double gyration = 0.0;  // m, of an axis: by what is seen after it and before, it is measured (error_scales.hpp)
    const std::string* of = nullptr;  // the name of what it is seen of, which the model owns
    bool is_of_joint = true;          // a force or torque: of the joint of a body; else of a constraint or contact

    /// What it is, in words; empty of what has no name.
    std::string words() const {
        if (of == nullptr) return {};
        const auto quantity = [&] {
            switch (alike) {
                case Alike::place: return "position";
                case Alike::velocity: return "velocity";
                case Alike::turning: return "angular velocity";
                case Alike::force: return is_of_joint ? "reaction" : "force";
                case Alike::torque: return is_of_joint ? "reaction torque" : "torque";
                default: return is_position ? "angle" : "attitude";
            }
        };
        return std::string("the ") + quantity() + " of " + *of;
    }
};

}  // namespace rbdyn::inline RBDYN_FORM
