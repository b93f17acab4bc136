// What acts on the bodies of a tree: weight, loads, couplings, and what is exerted along its joints.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/mechanics/tree.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

/// Everything that acts, at a state.
struct Acts {
    using S = Expression;

    std::vector<Wrench<S>> wrenches;      // on each body, about P, world axes; of joints nothing
    std::vector<S> joints;                // along the velocities of joints
    std::vector<Vector3Of<S>> couplings;  // on the first end of each
    std::vector<S> powers;                // of each load
};

class Exerted {
public:
    using S = Expression;

    [[gnu::cold]] Exerted(const Scene& scene, const Tree& tree);

    Acts all(const Tree& tree, const S& t, const std::vector<Moving<S>>& all, const S* q, const S* v) const;

    struct Coupled {
        Coupling coupling;
        Anchor a, b;
    };
    const std::vector<Coupled>& couplings() const { return couplings_; }
    /// Whether anything but its weight acts on a body.
    bool acts_on(int body) const;
    int loads() const { return static_cast<int>(loads_.size()); }
    /// A body that constraints leave no motion is not dragged: its speed is rounding, and has no direction.
    void keep_still(int body);

private:
    struct Applied {
        Load load;
        Anchor at;
        bool is_idle = false;
    };

    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    /// What a load exerts on its body, about P.
    static Wrench<S> wrench(const Applied& load, const Tree& tree, const S& t, const std::vector<Moving<S>>& all);

    Vector3Of<DoubleDouble> gravity_;
    std::vector<Applied> loads_;
    std::vector<Coupled> couplings_;
};

/// The velocity of a joint that turns its body about an axis, and the one that moves it along one; -1: it has none.
int turning_velocity(const JointLaw& joint);
int sliding_velocity(const JointLaw& joint);

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
