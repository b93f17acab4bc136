// Two particles that attract or repel each other by the inverse square of their distance and nothing else, or one a
// fixed point: their centre of mass moves uniformly accelerated, what is between them as closed_form/kepler_motion.hpp
// says.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/closed_form/kepler_motion.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/door.hpp"
#include "rbdyn/special/single_laws.hpp"

namespace rbdyn::inline RBDYN_FORM {

class TwoBodyMotion : public ClosedForm {
public:
    /// A body and its share of what is between the two: r = centre + share d.
    struct Share {
        int first, first_rate;
        DoubleDouble share;
    };
    struct Center {
        Vector3Of<DoubleDouble> place, velocity, acceleration;
    };
    TwoBodyMotion(StateMap map, const Center& center, const KeplerMotion& between, std::vector<Share> bodies);

    void state(Instant since, std::span<double> x) const override;
    double error(double since, double wanted) const override;
    double pace() const override;
    std::string name() const override;

private:
    StateMap map_;
    Center center_;
    KeplerMotion between_;
    std::vector<Share> bodies_;
};

namespace planning {

/// c where a coupling pushes its ends apart with c / distance^2 [N m^2] at every distance; none where it does not, or
/// nobody knows. `masses`: the product of those of its ends.
[[gnu::cold]] std::optional<DoubleDouble> inverse_square(const Coupling& coupling, const DoubleDouble& masses);

/// The motion of a scene of two bodies, or why it has no closed form; neither where the scene is none of these.
[[gnu::cold]] FoundForm two_body_motion(const Scene& scene, const SingleLaws& laws);

}  // namespace planning

}  // namespace rbdyn::inline RBDYN_FORM
