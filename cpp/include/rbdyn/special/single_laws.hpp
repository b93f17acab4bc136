// The laws of all bodies of a scene that hang on the world, and of what joins them: springs and other couplings.
//
// Invariant: variables are the positions of all bodies, each as its law has them (single_law.hpp), then their
// velocities. The state holds those that are simulated (state_map.hpp). Vectors are seen from one placement (view.hpp).
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/single_law.hpp"
#include "rbdyn/special/single_state.hpp"
#include "rbdyn/special/view.hpp"

namespace rbdyn::inline RBDYN_FORM {

class BeadLaw;   // bead_law.hpp
class RigidLaw;  // rigid_law.hpp

/// Each law written once over the number type. Immutable, but for the steps in which it is made.
class SingleLaws {
public:
    struct CouplingEnd {
        int body = -1;                       // -1: a point of the world
        Vector3Of<DoubleDouble> point = {};  // of the body as its law has points (SingleLaw::point); else in the view
    };
    struct Connected {
        Coupling coupling;
        CouplingEnd a, b;
        DoubleDouble masses = 0.0;  // of the bodies at both ends, multiplied

        bool present() const { return is_present(coupling); }
    };

    [[gnu::cold]] SingleLaws(const Scene& scene, const Placement& view);
    SingleLaws(const SingleLaws& other);
    SingleLaws& operator=(const SingleLaws&) = delete;
    ~SingleLaws() = default;

    /// What may depend on numbers of the user's: all that acts on bodies, and how their rails move.
    [[gnu::cold]] void take_functions(const Scene& scene);

    /// Where the bodies of the scene start; leave_out() is due then.
    [[gnu::cold]] void take_starts(const Scene& scene);

    /// Takes what stays as it starts out of the state.
    [[gnu::cold]] void leave_out(const std::vector<bool>& stays);

    const std::vector<std::unique_ptr<SingleLaw>>& bodies() const { return bodies_; }
    const SingleLaw& body(int i) const { return *bodies_[at(i)]; }
    int size() const { return static_cast<int>(bodies_.size()); }
    /// The beads among them, and the law of one; that of a rigid body.
    const std::vector<int>& beads() const { return beads_; }
    const BeadLaw& bead(int i) const;
    const RigidLaw& rigid(int i) const;
    const SceneView& view() const { return view_; }
    /// Position variables of all bodies together, and all variables.
    int positions() const { return positions_; }
    int variables() const { return variables_; }
    /// Which of them are simulated.
    const StateMap& map() const { return map_; }

    /// All variables of a body, from a state.
    struct Variables {
        double q[8], v[6];
    };
    Variables variables_of(const SingleLaw& b, std::span<const double> x) const;

    /// All variables as the scene starts at time t, in 32 digits.
    std::vector<DoubleDouble> exact_start(double t = 0.0) const;
    /// The doubles of that, and what they are short of it; empty if nothing.
    std::vector<double> start(double t = 0.0) const;
    std::vector<double> start_rest(double t = 0.0) const;

    /// All bodies at a time; `slip`: what each does in the mode.
    SingleStates<double> states(double t, std::span<const double> x, std::span<const signed char> slip) const;

    /// Whether equations take numbers of their mode, two a body: the sign of its slip, and what is fixed in the mode.
    bool takes_numbers() const;
    /// How many loads the scene has.
    int loads() const { return loads_; }

    // --- couplings ---

    const std::vector<Connected>& couplings() const { return couplings_; }
    const Connected& coupling(int k) const { return couplings_[at(k)]; }
    /// As a subject of a sentence.
    std::string title(int coupling) const;

    /// Place and velocity of an end in the view.
    template <class S>
    static std::pair<Vector3Of<S>, Vector3Of<S>> motion_of(const CouplingEnd& e, const SingleStates<S>& states) {
        if (e.body >= 0) return states[at(e.body)].motion_of(e.point);
        return {exactly<S>(e.point), Vector3Of<S>(S(0.0), S(0.0), S(0.0))};
    }
    /// The places of the ends of a coupling in the view, those of a PairForce in the world.
    template <class S>
    PairState<S> ends(const Connected& c, const S& t, const SingleStates<S>& states) const {
        const auto [ra, va] = motion_of<S>(c.a, states);
        const auto [rb, vb] = motion_of<S>(c.b, states);
        const S masses = exactly<S>(c.masses);
        if (!std::holds_alternative<PairForce>(c.coupling)) return {t, ra, rb, va, vb, masses};
        return {t, view_.in_world<S>(ra), view_.in_world<S>(rb), view_.to_world<S>(va), view_.to_world<S>(vb), masses};
    }
    /// The force of a coupling on its first end.
    template <class S>
    Vector3Of<S> coupling_force(const Connected& c, const S& t, const SingleStates<S>& states) const {
        const Vector3Of<S> force = force_of<S>(c.coupling, ends<S>(c, t, states));
        return std::holds_alternative<PairForce>(c.coupling) ? view_.to_view<S>(force) : force;
    }

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    /// The law of a body: the one place where it is told which there is.
    std::unique_ptr<SingleLaw> law_of(const Scene& scene, int i);
    /// Lays the couplings down: which bodies each acts on.
    void take_couplings(const Scene& scene);
    CouplingEnd end(const End& e) const;

    SceneView view_;
    std::vector<std::unique_ptr<SingleLaw>> bodies_;
    std::vector<int> beads_;
    std::vector<Connected> couplings_;
    StateMap map_;
    int positions_ = 0, variables_ = 0, loads_ = 0;
};

}  // namespace rbdyn::inline RBDYN_FORM
