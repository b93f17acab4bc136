// What acts on the bodies of a scene at rest, as functions of where they are: all that statics reads of a scene.
//
// Notation: Q of a velocity of a joint is the power of all that acts with a unit of it (mechanics/tree.hpp); of a bead
// Q = F.r', F the active force, r' = dr/du                                      (eq. 7.15, in the curve's own
// parameter) Beads stay on their rails here, also on those that they may leave.
#pragma once

#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/mechanics/exert.hpp"
#include "rbdyn/mechanics/loose_rail.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/mechanics/tree.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

class RestForces {
public:
    using S = Expression;

    [[gnu::cold]] explicit RestForces(const Scene& scene);

    const Scene& scene() const { return scene_; }
    const mechanics::Tree& tree() const { return tree_; }

    struct Recorded {
        std::vector<S> along;                   // Q of all velocities
        std::vector<mechanics::Moving<S>> all;  // the bodies
        std::vector<Wrench<S>> wrenches;        // on each body itself, about P, world axes
    };
    /// At positions that are recorded.
    Recorded recorded(const std::vector<S>& q) const;

    /// The sums of the sizes of all that acts: what is rounding beside them is none.
    struct Efforts {
        struct OnBody {
            Vector3 force = Vector3::Zero();  // the resultant, world
            double size = 0.0, moment = 0.0;  // of the forces [N], and of their moments about P [N m]
        };
        std::vector<OnBody> bodies;
        std::vector<double> joints;                  // of what acts along the velocities of joints
        std::vector<mechanics::Moving<double>> all;  // where the bodies are

        /// Of the power of all that acts on a body that moves so, whatever is at right angles: forces times ways.
        double of(int body, const mechanics::Twist<double>& way) const {
            const OnBody& b = bodies[at(body)];
            return b.size * way.move.norm() + b.moment * way.turn.norm();
        }
    };
    Efforts efforts(const std::vector<double>& q) const;

    /// The rails that push their beads on one side only.
    const std::vector<mechanics::LooseRail>& one_sided() const { return one_sided_; }
    /// What a rail pushes a bead with along its normal, times |r'|.
    template <class N>
    N push(const mechanics::LooseRail& rail, const std::vector<mechanics::Moving<N>>& all,
           const Vector3Of<N>& force) const {
        static const mechanics::Moving<N> ground;
        const mechanics::Moving<N>& on = rail.parent < 0 ? ground : all[at(rail.parent)];
        return -dot<N>(rail.pushing<N>(all[at(rail.body)].joint.front().move, on), force);
    }

    /// What acts on the bodies and is not finite at positions, in words.
    std::string not_finite(const std::vector<double>& q) const;

    /// The extent of the scene [m]; 0 where all of it is in one point.
    double size() const { return size_; }

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    Scene scene_;
    mechanics::Tree tree_;
    mechanics::Exerted exerted_;
    std::vector<mechanics::LooseRail> one_sided_;
    double size_ = 0.0;
};

}  // namespace rbdyn::inline RBDYN_FORM::statics
