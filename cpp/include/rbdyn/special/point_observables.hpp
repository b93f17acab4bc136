// What a watched function may ask of particles, as expressions and in numbers.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/point_laws.hpp"
#include "rbdyn/special/point_state.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The present of a scene of particles while its equations are recorded.
class RecordedPoints {
public:
    using S = Expression;

    struct Body {
        PointState<S> state;
        Resultant<S> force;
        S rate = 0.0;  // of a bead: w'
        bool on_rail = false;
        Vector3Of<S> moment{S(0.0), S(0.0), S(0.0)};  // of a rigid body
        const S* rates = nullptr;                     // of its velocities
    };

    /// `states`: of all bodies, as in `bodies`; all kept by reference.
    RecordedPoints(const PointLaws& laws, const S& t, const std::vector<PointState<S>>& states,
                   const std::vector<Body>& bodies);

    S value(const Observable& o) const;

    /// The parameters of beads as the equations have them.
    std::vector<S> parameters;

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    S parameter(int body) const { return parameters[at(body)]; }

    /// A component in the world of a vector in the view.
    S component(const Vector3Of<S>& v, const Observable& o) const { return laws_.to_world<S>(v)[o.component]; }
    static Vector3Of<S> force(const Body& b);
    static Vector3Of<S> acceleration(const Body& b, const PointLaws::Body& law);
    const PointLaws& laws_;
    S t_;
    const std::vector<PointState<S>>& states_;
    const std::vector<Body>& bodies_;
};

/// The same in numbers, at a state.
double observed(const PointsNow& now, const Observable& o);

}  // namespace rbdyn::inline RBDYN_FORM
