// Particles, free or on rails, smooth or rough, and rigid bodies: the laws of their motion, and their reactions.
//
// Notation: r(u) the rail's curve, u its parameter, w = du/dt, r' = dr/du; F the active force, Phi the rail's
// reaction; m a = F + Phi (eq. 7.7). Along r' and across it, in the curve's own parameter:
//     m (|r'|^2 w' + r'.r'' w^2) = r'.F + |r'| Phi_t                        (eq. 7.12)
//     |r'| |Phi_perp| = |c|,   c = m w^2 r' x r'' - r' x F                  (eqs. 7.13, 7.14, 7.24)
// slipping: Phi_t = -mu_d sign(slip) |Phi_perp| (eq. 7.23, 7.25);  sticking: |Phi_t| <= mu_s |Phi_perp|.
// slip = |r'| w - V, V(t) the speed of the rail's surface along itself. Since |c| needs no normal vector, straight
// stretches and points of inflection are nothing special.
//
// On a rail that moves F stands for F - m A in the rail's axes, A the acceleration its motion gives (point_state.hpp).
// One that only pushes, along n = b x t, holds as long as Phi.n = b.c / |r'| has its sign.
//
// Vectors are seen from one placement (`view`), chosen so that what vanishes vanishes exactly: a bead on a plane
// curve under forces in its plane then has c = (0, 0, c_z), and |c| is c_z with its sign locked.
// Rigid bodies, on joints to the ground, obey rigid_law.hpp; scenes with any are seen from the world.
// Invariant: variables are the positions of all bodies (u; x y z; u x y z for one that may leave its rail, those not in
// use at rest; what rigid_law.hpp says), then their velocities. The state holds those that are simulated
// (state_map.hpp).
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/one_side.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/time_function.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/body_report.hpp"
#include "rbdyn/model/rail_landing.hpp"
#include "rbdyn/model/rail_singular.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/rigid_motion.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/point_state.hpp"
#include "rbdyn/special/rigid_law.hpp"
#include "rbdyn/special/rigid_loads.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Resultant of the active forces on one particle; what is exactly along a rail is kept apart.
template <class S>
struct Resultant {
    Vector3Of<S> force;
    S along;  // r' . (forces along the rail)
};

/// What sticking asks of a rail.
struct Holding {
    double tangential;  // |r'| Phi_t
    double across;      // |r'| |Phi_perp|
    double rounding;    // |r'| times what rounding may make of either: of the forces one by one, and of the motion
};

template <class S>
class CouplingForces;  // model/points_now.hpp
struct PointsNow;

/// The laws of a scene of particles, each written once over the number type. Immutable.
class PointLaws {
public:
    /// One particle or rigid body.
    struct Body {
        std::string name;
        double mass = 0.0;
        std::optional<Curve> curve;
        bool rough = false;
        double mu_static = 0.0, mu_dynamic = 0.0;
        TimeFunction drive;
        int first = 0, first_rate = 0;       // its first position variable, its first velocity variable
        Vector3Of<DoubleDouble> force = {};  // constant forces together
        std::vector<Drag> drags;
        std::vector<Load> functions;
        std::vector<int> function_loads;  // which loads of the scene they are
        RigidMotion motion;
        RailSide side = RailSide::both;
        RailEnds ends = RailEnds::stop;
        std::optional<curves::OneSide> one_side = std::nullopt;  // of a rail that only pushes, along its normal
        Vector3 binormal = Vector3::Zero();                      // its binormal in the view
        bool may_fly = false;
        DoubleDouble start_u = 0.0;
        double start_speed = 0.0;
        DoubleDouble start_positions[8] = {}, start_velocities[6] = {};  // of a rigid body
        std::optional<EulerAngles> start_angles;                         // that its attitude was given by
        Vector3 start_position = Vector3::Zero(), start_velocity = Vector3::Zero();

        std::optional<RigidLaw> rigid;
        std::vector<RigidLoad> loads;  // of a rigid body
        std::vector<int> couplings;    // with an end on it, in their order

        /// The variable that is a parameter of the equations where it cannot change.
        int fixed_variable() const { return rigid && rigid->follows_axis ? first_rate + velocities() - 1 : first; }
        int positions() const { return rigid ? rigid->positions() : !curve ? 3 : may_fly ? 4 : 1; }
        int velocities() const { return rigid ? rigid->velocities() : positions(); }
        /// The first of the variables of a place in space, and of a velocity in it.
        int first_of_space() const { return curve ? first + 1 : first; }
        int first_of_velocity() const { return curve ? first_rate + 1 : first_rate; }
    };
    struct CouplingEnd {
        int body = -1;
        Vector3Of<DoubleDouble> point = {};  // in the view
        bool is_on_rigid = false;
        Vector3Of<DoubleDouble> point_on_rigid = {};  // from o, in its frame
    };
    struct Connected {
        Coupling coupling;
        CouplingEnd a, b;
        DoubleDouble masses = 0.0;  // of the bodies at both ends, multiplied

        bool present() const { return is_present(coupling); }
        bool touches(int body) const { return a.body == body || b.body == body; }
    };

    [[gnu::cold]] PointLaws(const Scene& scene, const Placement& view);

    /// What may depend on numbers of the user's: all that acts on bodies, and how their rails move.
    [[gnu::cold]] void take_functions(const Scene& scene);

    /// Where the bodies of the scene start; leave_out() is due then.
    [[gnu::cold]] void take_starts(const Scene& scene);

    /// Takes what stays as it starts out of the state.
    [[gnu::cold]] void leave_out(const std::vector<bool>& stays);

    const std::vector<Body>& bodies() const { return bodies_; }
    const Body& body(int i) const { return bodies_[at(i)]; }
    const Placement& view() const { return view_; }
    /// Position variables of all bodies together, and all variables.
    int positions() const { return positions_; }
    int variables() const { return variables_; }
    /// Which of them are simulated.
    const StateMap& map() const { return map_; }

    /// All variables of a body, from a state.
    struct Variables {
        double q[8], v[6];
    };
    Variables variables_of(const Body& b, std::span<const double> x) const;

    /// All variables as the scene starts at time t, in 32 digits.
    std::vector<DoubleDouble> exact_start(double t = 0.0) const;
    /// The doubles of that, and what they are short of it; empty if nothing.
    std::vector<double> start(double t = 0.0) const;
    std::vector<double> start_rest(double t = 0.0) const;

    /// All bodies at a time; `slip`: what each does in the mode.
    std::vector<PointState<double>> states(double t, std::span<const double> x,
                                           std::span<const signed char> slip) const;

    /// Motion and reaction of a body in a mode.
    PointReport report(int index, const PointsNow& now) const;
    PointReport report(int index, std::span<const signed char> slip, double t, std::span<const double> x) const;
    /// Motion and reactions of a rigid body.
    RigidReport rigid_report(int index, const PointsNow& now) const;
    RigidReport rigid_report(int index, std::span<const signed char> slip, double t, std::span<const double> x) const;
    /// The rates of a body's velocities.
    void rates_of(const Body& b, const Acting& acting, double* v_rate) const;
    /// How the rail of a body has turned from where its curve is placed, world axes.
    Matrix3 rail_turn(int index, double t) const;
    /// Whether nothing acts on a rigid body that turns but its weight.
    bool is_conservative(int index) const;
    /// Whether equations take numbers of their mode, two a body: the sign of its slip, and what is fixed in the mode.
    bool takes_numbers() const;
    /// Whether any variable of a body's rotation is simulated.
    bool turns(int index) const;
    /// Whether any variable of a body is simulated.
    bool moves(int index) const;
    /// Whether a load of the scene is one that case distinctions can be in.
    bool is_function(const Scene::AppliedLoad& load, int index) const;
    /// Power of a load of the scene.
    double power(const Scene::AppliedLoad& load, std::span<const signed char> slip, double t,
                 std::span<const double> x) const;
    /// Derivatives of a body's position and velocity variables.
    void slope(int index, const PointsNow& now, std::span<double> dq, std::span<double> dv) const;

    // --- the laws, in any number type ---

    /// One body, from its own variables.
    template <class S>
    PointState<S> moving(const Body& b, const S& t, const S* q, const S* v, bool is_flying) const {
        if (b.rigid) {
            PointState<S> p;
            p.rigid = std::make_shared<const RigidState<S>>(b.rigid->state(q, v));
            const Vector3Of<S> g = RigidLaw::constant<S>(b.rigid->exact.center);
            p.r = p.rigid->position(g);
            p.v = p.rigid->velocity(g);
            return p;
        }
        if (!b.curve) return PointState<S>::free(q, v);
        if (is_flying) return PointState<S>::free(q + 1, v + 1);
        std::shared_ptr<const RailFrame<S>> frame;
        if (b.motion.present()) frame = std::make_shared<const RailFrame<S>>(b.motion, t, view_);
        return PointState<S>::on_rail(b.curve->at<S>(*q, view_), *v, std::move(frame));
    }

    /// What acts on body i besides couplings. `length_of_w` gives |w| of a bead with the sign of its mode.
    template <class S, class Length>
    Resultant<S> applied(int i, const S& t, const PointState<S>& p, bool is_flying, Length&& length_of_w) const {
        const Body& b = bodies_[at(i)];
        Resultant<S> f{exactly<S>(b.force), S(0.0)};
        for (const auto& function : b.functions) {
            const Vector3Of<S> r = in_world<S>(p.r), v = to_world<S>(p.v);
            f.force += to_view<S>(force_of<S>(function, t, r, v));
        }
        if (!b.drags.empty()) {
            S factor(0.0), quadratic(0.0);
            bool is_quadratic = false;
            for (const Drag& drag : b.drags) {
                factor += drag.linear.in<S>();
                quadratic += drag.quadratic.in<S>();
                is_quadratic = is_quadratic || !drag.quadratic.is_zero();
            }
            if (b.curve && !is_flying && !p.frame) {
                if (is_quadratic) factor += quadratic * sqrt_of(p.curve.speed_squared) * length_of_w(p.w);
                f.along -= factor * p.w * p.curve.speed_squared;
            } else {
                if (is_quadratic) factor += quadratic * length(p.v, "speed of " + b.name);
                f.force -= p.v * factor;
            }
        }
        return f;
    }

    /// Active forces on body i.
    template <class S, class Length>
    Resultant<S> resultant(int i, const CouplingForces<S>& couplings, bool is_flying, Length&& length_of_w) const {
        return with_couplings<S>(i, applied<S>(i, couplings.time(), couplings.states()[at(i)], is_flying, length_of_w),
                                 couplings);
    }
    template <class S>
    Resultant<S> with_couplings(int i, Resultant<S> f, const CouplingForces<S>& couplings) const {
        for (const int k : bodies_[at(i)].couplings) {
            if (couplings_[at(k)].a.body == i)
                f.force += couplings[k];
            else
                f.force -= couplings[k];
        }
        return f;
    }

    /// The places of the ends of a coupling in the view, those of a PairForce in the world.
    template <class S>
    PairState<S> ends(const Connected& c, const S& t, const std::vector<PointState<S>>& states) const {
        const auto [ra, va] = motion_of<S>(c.a, states);
        const auto [rb, vb] = motion_of<S>(c.b, states);
        const S masses = exactly<S>(c.masses);
        if (!std::holds_alternative<PairForce>(c.coupling)) return {t, ra, rb, va, vb, masses};
        return {t, in_world<S>(ra), in_world<S>(rb), to_world<S>(va), to_world<S>(vb), masses};
    }

    /// The force of a coupling on its first end.
    template <class S>
    Vector3Of<S> coupling_force(const Connected& c, const S& t, const std::vector<PointState<S>>& states) const {
        const Vector3Of<S> force = force_of<S>(c.coupling, ends<S>(c, t, states));
        return std::holds_alternative<PairForce>(c.coupling) ? to_view<S>(force) : force;
    }

    /// What acts on rigid body i besides couplings, and its moment.
    template <class S>
    Wrench<S> applied_wrench(int i, const S& t, const RigidState<S>& s) const {
        const Body& b = bodies_[at(i)];
        Wrench<S> w;
        w.add(s, RigidLaw::constant<S>(b.rigid->exact.weight), RigidLaw::constant<S>(b.rigid->exact.center));
        for (const RigidLoad& load : b.loads) add_load(w, *b.rigid, s, load, t, b.name);
        return w;
    }

    /// Active forces on rigid body i, and their moment.
    template <class S>
    Wrench<S> wrench(int i, const CouplingForces<S>& couplings) const {
        const RigidState<S>& s = *couplings.states()[at(i)].rigid;
        return with_couplings<S>(i, applied_wrench<S>(i, couplings.time(), s), couplings);
    }
    template <class S>
    Wrench<S> with_couplings(int i, Wrench<S> w, const CouplingForces<S>& couplings) const {
        const RigidState<S>& s = *couplings.states()[at(i)].rigid;
        for (const int k : bodies_[at(i)].couplings) {
            const Connected& c = couplings_[at(k)];
            if (c.a.body == i) w.add(s, couplings[k], RigidLaw::constant<S>(c.a.point_on_rigid));
            if (c.b.body == i) w.add(s, Vector3Of<S>(-couplings[k]), RigidLaw::constant<S>(c.b.point_on_rigid));
        }
        return w;
    }

    /// A place of the view in the world.
    template <class S>
    Vector3Of<S> in_world(const Vector3Of<S>& r) const {
        return to_world<S>(r) + Vector3Of<S>(view_.origin);
    }
    /// A vector of the view in the world, and back.
    template <class S>
    Vector3Of<S> to_world(const Vector3Of<S>& v) const {
        if constexpr (std::is_same_v<S, double>)
            return turned<S>(view_.axes, v);
        else
            return RigidLaw::turned<S>(view_.exact_axes(), v);
    }
    template <class S>
    Vector3Of<S> to_view(const Vector3Of<S>& v) const {
        if constexpr (std::is_same_v<S, double>)
            return {dot(column(view_.axes, 0), v), dot(column(view_.axes, 1), v), dot(column(view_.axes, 2), v)};
        else
            return RigidLaw::turned<S>(view_.exact_axes().transpose(), v);
    }
    /// What drives and presses a bead on its rail, in the rail's axes: F - m A.
    template <class S>
    static Resultant<S> guided(const Body& b, const PointState<S>& p, const Resultant<S>& f) {
        if (!p.frame) return f;
        return {p.in_rail(f.force - p.transport() * S(b.mass)), f.along};
    }

    template <class S>
    static Vector3Of<S> turned(const Matrix3& m, const Vector3Of<S>& v) {
        Vector3Of<S> out;
        for (int i = 0; i < 3; ++i) out[i] = S(m(i, 0)) * v[0] + S(m(i, 1)) * v[1] + S(m(i, 2)) * v[2];
        return out;
    }
    template <class S>
    static S sqrt_of(const S& x) {
        using std::sqrt;
        return sqrt(x);
    }

    template <class S>
    static std::pair<Vector3Of<S>, Vector3Of<S>> motion_of(const CouplingEnd& e,
                                                           const std::vector<PointState<S>>& states) {
        if (e.is_on_rigid) {
            const RigidState<S>& s = *states[at(e.body)].rigid;
            const Vector3Of<S> c = RigidLaw::constant<S>(e.point_on_rigid);
            return {s.position(c), s.velocity(c)};
        }
        if (e.body >= 0) return {states[at(e.body)].r, states[at(e.body)].v};
        return {exactly<S>(e.point), Vector3Of<S>(S(0.0), S(0.0), S(0.0))};
    }

    /// c = m w^2 r' x r'' - r' x F, |r'| times what the rail must exert across itself.
    template <class S>
    static Vector3Of<S> friction_vector(const Body& b, const CurvePoint<S>& c, const S& w, const Resultant<S>& f) {
        return c.first_cross_second * (S(b.mass) * (w * w)) - cross<S>(c.first, f.force);
    }

    /// w' of a bead that slides (sign: of its slip), or of one on a smooth rail.
    template <class S>
    static S sliding_rate(const Body& b, const CurvePoint<S>& c, const S& w, const Resultant<S>& f, const S& sign,
                          const S& across) {
        S along = dot<S>(c.first, f.force) + f.along;
        if (b.rough && b.mu_dynamic > 0.0) along -= S(b.mu_dynamic) * sign * across;
        return (along / S(b.mass) - c.first_dot_second * (w * w)) / c.speed_squared;
    }

    /// w' of a bead that sticks: |r'| w = V(t).
    template <class S>
    static S carried_rate(const Body& b, const S& t, const CurvePoint<S>& c, const S& w) {
        const S norm = sqrt_of(c.speed_squared);
        return (b.drive.template rate<S>(t) - c.first_dot_second * (w * w) / norm) / norm;
    }

    /// The reaction that a bead without slip needs to stay so.
    Holding holding(int i, double t, std::span<const double> x, std::span<const signed char> slip) const;

    /// Whether what presses a bead on its rail is a constant that rounding of its terms alone has made.
    static bool is_rounding(const Expression& pressing, const CurvePoint<Expression>& c,
                            const Resultant<Expression>& f);

    CurvePoint<double> curve_point(const Body& b, double u) const { return b.curve->at<double>(u, view_); }

    /// Finds where a flying bead comes back to its rail; none if the rail holds on both sides.
    std::shared_ptr<const RailLanding> landing(int i) const { return landings_[at(i)]; }

    /// Finds where a bead comes to a place where its curve is singular; none if it has none, or the bead stays.
    std::shared_ptr<const RailSingularity> singularity(int i) const { return singularities_[at(i)]; }

    /// Finds where a bead that flies comes to such a place of a rail that only pushes.
    std::shared_ptr<const SingularLanding> singular_landing(int i) const { return singular_landings_[at(i)]; }

    /// A vector of the world in the view.
    Vector3 seen(const Vector3& v) const { return snapped(view_.axes.transpose() * v, v.norm()); }
    Vector3Of<DoubleDouble> seen_exactly(const Vector3& v) const;
    const std::vector<Connected>& couplings() const { return couplings_; }
    /// How many loads the scene has.
    int loads() const { return loads_; }

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    /// Lays the couplings down: which bodies each acts on.
    void take_couplings(const Scene& scene);

    /// The rate of a variable; zero of what stays as it starts.
    double rate_of(int variable, const Acting& acting) const;

    // --- seen from the view ---

    static Vector3 snapped(Vector3 v, double size);
    static Vector3Of<DoubleDouble> snapped(Vector3Of<DoubleDouble> v, double size);
    Vector3Of<DoubleDouble> seen_point(const Vector3& p) const;
    CouplingEnd end(const End& e) const;

    Placement view_;
    std::vector<std::shared_ptr<const RailLanding>> landings_;
    std::vector<std::shared_ptr<const RailSingularity>> singularities_;
    std::vector<std::shared_ptr<const SingularLanding>> singular_landings_;
    std::vector<Body> bodies_;
    std::vector<Connected> couplings_;
    StateMap map_;
    int positions_ = 0, variables_ = 0, loads_ = 0;
};

}  // namespace rbdyn::inline RBDYN_FORM
