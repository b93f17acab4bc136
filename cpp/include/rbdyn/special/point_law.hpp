// What acts on a particle, free or on a rail, and what is asked of its motion either way.
//
// Vectors are seen from one placement (view.hpp). Constant forces are one sum; resistance too, with one length of the
// velocity.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/laws_now.hpp"
#include "rbdyn/special/single_law.hpp"
#include "rbdyn/special/single_state.hpp"
#include "rbdyn/special/view.hpp"

namespace rbdyn::inline RBDYN_FORM {

class PointLaw : public SingleLaw {
public:
    void take_loads(const Scene& scene, const std::vector<int>& own) override;
    void powers(const RecordedBody& present, const S& t, std::span<S> power) const override;
    bool is_function(const Scene::AppliedLoad& load, int of_scene) const override;
    double observed(const LawsNow& now, const Observable& o) const override;
    void report(const LawsNow& now, Asked asked, BodyReport& r) const override;
    void observe(const LawsNow& now, std::vector<Observed>& out) const override;
    double power(const Scene::AppliedLoad& load, double t, const SingleState<double>& state) const override;
    Vector3 origin(const SingleState<double>& state) const override { return view_.origin + view_.axes * state.r; }
    std::string grown(const LawsNow& was, const LawsNow& is, double beyond) const override;
    using SingleLaw::observed, SingleLaw::report;

protected:
    PointLaw(const Scene::Body& b, int place, const SceneView& view) : SingleLaw(b, place), view_(view) {}

    /// Whether the view follows constant forces, so that those made of numbers of the user's are settled for it, too.
    virtual bool sets_view(const Scene& /*scene*/) const { return false; }
    /// What of loads is not finite at a state, or of all that acts.
    std::string load_not_finite(const LawsNow& now) const;
    std::string acceleration_not_finite(const LawsNow& now) const;

    /// Forces but resistance and couplings, at a state.
    template <class T>
    Vector3Of<T> forces(const T& t, const SingleState<T>& p) const {
        Vector3Of<T> f = exactly<T>(force_);
        for (const Load& function : functions_) {
            const Vector3Of<T> r = view_.in_world<T>(p.r), v = view_.to_world<T>(p.v);
            f += view_.to_view<T>(force_of<T>(function, t, r, v));
        }
        return f;
    }
    /// All that acts but couplings, where it is on no rail.
    template <class T>
    Vector3Of<T> forces_in_space(const T& t, const SingleState<T>& p) const {
        Vector3Of<T> f = forces<T>(t, p);
        if (!drags_.empty())
            f -= p.v *
                 resistance<T>(drags_, [&](const T& factor) { return T(factor * length(p.v, "speed of " + name)); });
        return f;
    }
    /// Adds what couplings exert.
    template <class T>
    void add_couplings(Vector3Of<T>& f, const CouplingForces<T>& forces) const {
        for (const int k : couplings) {
            if (forces.coupling(k).a.body == index)
                f += forces[k];
            else
                f -= forces[k];
        }
    }
    /// What acts, without couplings and with them: by the equations of the mode where the state does not say it.
    struct Applied {
        Vector3 own, all;
        double along = 0.0;
    };
    Applied applied_in_mode(const LawsNow& now) const;

    /// The report of a particle on no rail.
    PointReport report_in_space(const Applied& f, const SingleState<double>& p) const;
    /// That of vectors seen from the view, world axes.
    void turn_to_world(PointReport& r, const SingleState<double>& p) const;
    /// Place and velocity, for observe(); returns the report.
    PointReport observe_motion(const LawsNow& now, std::vector<Observed>& out) const;

    /// A component in the world of a vector in the view.
    S component(const Vector3Of<S>& v, const Observable& o) const { return view_.to_world<S>(v)[o.component]; }
    /// What is asked of a particle on no rail, as expressions.
    S observed_in_space(const RecordedBody& present, const Observable& o) const;

    /// The rates of a particle on no rail.
    void lay_down_in_space(const RecordedBody& present, S* q_rate, S* v_rate) const;
    void slope_in_space(const LawsNow& now, double* dq, double* dv) const;

    /// Changes by an action of the user's. Throws InvalidInput for words that no particle has.
    static void require_words(const StateChange& c, const std::string& user, const std::string& name);
    static void put(double value, const std::string& user, double& x);
    /// A place and a velocity in space, where its first variables of them are.
    void put_in_space(const StateChange& c, const std::string& user, double* q, double* v) const;

    SceneView view_;
    Vector3Of<DoubleDouble> force_ = {};  // constant forces together
    std::vector<Drag> drags_;
    std::vector<Load> functions_;
    std::vector<int> function_loads_;  // which loads of the scene they are
};

}  // namespace rbdyn::inline RBDYN_FORM
