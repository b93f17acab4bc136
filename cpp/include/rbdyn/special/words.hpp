// What of every body is simulated, what is left out and what is watched for, in words.
//
// Names: x y z, vx vy vz the place and velocity of a particle or a centre of mass; q0 q1 q2 q3 the quaternion (w, x, y,
// z) and w1 w2 w3 the angular velocity of the frame that a rigid body's equations are written in (rigid_law.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/model/omission.hpp"
#include "rbdyn/model/state_map.hpp"

namespace rbdyn::inline RBDYN_FORM {

class SingleLaw;     // single_law.hpp
class SpecialModel;  // special_model.hpp

namespace planning {

std::string listed(const std::vector<std::string>& words, const std::string& last = ", ");

/// Variables of a body, `first` on, by name: those that are simulated, or those that are left out.
struct Named {
    std::vector<std::string> in, out;
    std::vector<double> values;  // of those left out

    template <std::size_t n>
    Named(const StateMap& map, int first, const std::array<const char*, n>& names, int count = static_cast<int>(n)) {
        for (int k = 0; k < count; ++k) {
            const bool is_in = map.is_simulated(first + k);
            (is_in ? in : out).push_back(names[static_cast<std::size_t>(k)]);
            if (!is_in) values.push_back(map.start(first + k));
        }
    }
};

inline constexpr std::array places{"x", "y", "z"}, velocities{"vx", "vy", "vz"}, turns{"w1", "w2", "w3"};
inline constexpr std::array attitudes{"q0", "q1", "q2", "q3", "spin"};

/// What of the place and velocity of a particle or a centre of mass is left out.
[[gnu::cold]] void leave_out_places(const SingleLaw& law, const StateMap& map, std::vector<Omission>& omissions);

/// What the equations watch for, with nothing that sticks and with all that can.
[[gnu::cold]] std::vector<std::string> guards_of(const SpecialModel& model);

}  // namespace planning

}  // namespace rbdyn::inline RBDYN_FORM
