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

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/point_state.hpp"
#include "rbdyn/model/rail_landing.hpp"
#include "rbdyn/model/rail_singular.hpp"
#include "rbdyn/model/rigid_loads.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn {

/// Resultant of the active forces on one particle; what is exactly along a rail is kept apart.
template <class S>
struct Resultant {
    Vector3Of<S> force;
    S along;  // r' . (forces along the rail)
};

/// Motion and reaction of one particle at a time, world axes.
struct PointReport {
    Vector3 position, velocity, acceleration, force, reaction;
    double u = 0.0, w = 0.0, w_rate = 0.0,
           speed = 0.0;                          // in flight: where it left the rail, 0, 0, 0; without a rail |v|
    double tangential_force = 0.0;               // Q_s = F.t (eq. 7.15)
    double rail_speed = 0.0;                     // V, of the rail's surface along itself
    Vector3 spin_momentum = Vector3::Zero();     // K_G of a rigid body
    double spin_energy = 0.0, spin_power = 0.0;  // T^(G), and its rate
    double effort = 0.0;                         // |F| + m |a| + m V^2 / rho: a reaction of its rounding is none
};

/// What sticking asks of a rail.
struct Holding {
    double tangential;  // |r'| Phi_t
    double across;      // |r'| |Phi_perp|
    double rounding;    // |r'| times what rounding may make of either: of the forces one by one, and of the motion
};

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

        /// The variable that is a parameter of the equations where it cannot change.
        int fixed_variable() const { return rigid && rigid->follows_axis ? first_rate + velocities() - 1 : first; }
        int positions() const { return rigid ? rigid->positions() : !curve ? 3 : may_fly ? 4 : 1; }
        int velocities() const { return rigid ? rigid->velocities() : positions(); }
        /// The first of the variables of a place in space, and of a velocity in it.
        int first_of_space() const { return curve ? first + 1 : first; }
        int first_of_velocity() const { return curve ? first_rate + 1 : first_rate; }
    };
    struct SpringEnd {
        int body = -1;
        Vector3Of<DoubleDouble> point = {};  // in the view
        bool is_on_rigid = false;
        Vector3Of<DoubleDouble> point_on_rigid = {};  // from o, in its frame
    };
    struct ConnectedSpring {
        Spring spring;
        SpringEnd a, b;
    };

    [[gnu::cold]] PointLaws(const Scene& scene, const Placement& view) : view_(view) {
        const auto& bodies = scene.bodies();
        int position = 0;
        for (const Scene::Body& b : bodies) {
            Body body;
            body.mass = b.mass();
            body.name = b.name;
            if (b.rigid() != nullptr) {
                body.rigid.emplace(scene, static_cast<int>(bodies_.size()));
                body.rigid->start(b, body.start_positions, body.start_velocities);
                body.start_angles = b.attitude.given_angles();
            }
            if (const Rail* rail = b.rail()) {
                body.curve = rail->curve();
                body.side = rail->side();
                body.ends = rail->ends();
                body.may_fly = rail->may_release();
                if (body.side != RailSide::both) {
                    body.one_side = curves::one_side(*body.curve, b.parameter, rail->up(), b.name);
                    if (body.side == RailSide::minus) body.one_side->sign = -body.one_side->sign;
                    body.binormal = seen(body.one_side->binormal());
                }
                if (const auto friction = rail->friction()) {
                    body.rough = true;
                    body.mu_static = friction->mu_static;
                    body.mu_dynamic = friction->dynamic();
                }
            }
            body.first = position;
            position += body.positions();
            body.start_u = {b.parameter, b.parameter_rest};
            body.start_speed = b.speed;
            body.start_position = b.position;
            body.start_velocity = b.velocity;
            bodies_.push_back(std::move(body));
        }
        positions_ = variables_ = position;
        for (Body& b : bodies_) {
            b.first_rate = variables_;
            variables_ += b.velocities();
        }
        take_functions(scene);
        for (const Scene::Connection& c : scene.connections()) {
            const Spring& spring = std::get<Spring>(c.coupling);
            springs_.push_back({spring, end(c.a), end(c.b)});
        }
        leave_out(std::vector<bool>(at(variables_), false));
    }

    /// What may depend on numbers of the user's: all that acts on bodies, and how their rails move.
    [[gnu::cold]] void take_functions(const Scene& scene) {
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            Body& body = bodies_[i];
            body.force = seen_exactly(scene.gravity()) * DoubleDouble(body.mass);
            body.drags.clear();
            body.functions.clear();
            body.function_loads.clear();
            body.loads.clear();
            if (const Rail* rail = scene.bodies()[i].rail()) {
                body.drive = rail->drive();
                body.motion = rail->motion();
            }
        }
        loads_ = static_cast<int>(scene.loads().size());
        for (int index = 0; index < loads_; ++index) {
            const Scene::AppliedLoad& load = scene.loads()[at(index)];
            Body& body = bodies_[at(load.body)];
            const auto keep_as_function = [&] {
                body.functions.push_back(load.load);
                body.function_loads.push_back(index);
            };
            if (body.rigid) {
                const auto point = load.at ? body.rigid->point_in_frame(*load.at) : body.rigid->exact.center;
                if (is_present(load.load)) body.loads.push_back({load.load, point, index});
            } else if (const Force* force = std::get_if<Force>(&load.load)) {
                // along a line the view follows the forces
                const bool is_seen_along = scene.bodies().size() == 1 && body.curve && body.curve->straight();
                if (force->is_constant() && (is_seen_along || !force->is_of_numbers()))
                    body.force += seen_exactly(force->settled());
                else
                    keep_as_function();
            } else if (const Drag* drag = std::get_if<Drag>(&load.load)) {
                if (drag->present()) body.drags.push_back(*drag);
            } else if (const Lorentz* lorentz = std::get_if<Lorentz>(&load.load);
                       lorentz == nullptr || lorentz->present()) {
                keep_as_function();
            }
        }
        for (Body& body : bodies_) body.force = snapped(body.force, rounded(body.force).norm());
        for (std::size_t i = 0; i < springs_.size(); ++i)
            springs_[i].spring = std::get<Spring>(scene.connections()[i].coupling);
    }

    /// Takes what stays as it starts out of the state.
    [[gnu::cold]] void leave_out(const std::vector<bool>& stays) {
        const std::vector<double> rest = start_rest();
        map_ = StateMap(start(), stays, rest);
        landings_.assign(bodies_.size(), nullptr);
        singularities_.assign(bodies_.size(), nullptr);
        singular_landings_.assign(bodies_.size(), nullptr);
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            const Body& b = bodies_[i];
            if (b.one_side)
                landings_[i] = std::make_shared<const RailLanding>(*b.curve, *b.one_side, view_, map_.place(b.first),
                                                                   map_.place(b.first_of_space()));
            if (b.one_side && !b.curve->always_regular())
                singular_landings_[i] = std::make_shared<const SingularLanding>(*b.curve, b.start_u.hi, view_,
                                                                                map_.place(b.first_of_space()));
            if (b.curve && !b.curve->always_regular() && map_.is_simulated(b.first))
                singularities_[i] = std::make_shared<const RailSingularity>(*b.curve, b.start_u.hi, map_.place(b.first),
                                                                            map_.place(b.first_rate));
        }
    }

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
    Variables variables_of(const Body& b, std::span<const double> x) const {
        Variables own;
        for (int k = 0; k < b.positions(); ++k) own.q[k] = map_.value(b.first + k, x);
        for (int k = 0; k < b.velocities(); ++k) own.v[k] = map_.value(b.first_rate + k, x);
        return own;
    }

    /// All variables as the scene starts at time t, in 32 digits.
    std::vector<DoubleDouble> exact_start(double t = 0.0) const {
        std::vector<DoubleDouble> x(at(variables_), 0.0);
        for (const Body& b : bodies_) {
            DoubleDouble* q = x.data() + b.first;
            DoubleDouble* v = x.data() + b.first_rate;
            if (b.rigid) {
                std::copy(b.start_positions, b.start_positions + b.positions(), q);
                std::copy(b.start_velocities, b.start_velocities + b.velocities(), v);
                continue;
            }
            if (b.curve) {
                *q = b.start_u;
                *v = DoubleDouble(b.start_speed) / sqrt(b.curve->at<DoubleDouble>(b.start_u, view_).speed_squared);
                if (b.may_fly) {
                    const double u = q->hi, w = v->hi;
                    const PointState<double> p = moving<double>(b, t, &u, &w, false);
                    for (int i = 0; i < 3; ++i) q[1 + i] = p.r[i];
                }
                continue;
            }
            const Vector3Of<DoubleDouble> r = seen_point(b.start_position), vel = seen_exactly(b.start_velocity);
            for (int i = 0; i < 3; ++i) {
                q[i] = r[i];
                v[i] = vel[i];
            }
        }
        return x;
    }
    /// The doubles of that, and what they are short of it; empty if nothing.
    std::vector<double> start(double t = 0.0) const {
        std::vector<double> x;
        for (const DoubleDouble& d : exact_start(t)) x.push_back(d.hi);
        return x;
    }
    std::vector<double> start_rest(double t = 0.0) const {
        std::vector<double> rest;
        for (const DoubleDouble& d : exact_start(t)) rest.push_back(std::isfinite(d.lo) ? d.lo : 0.0);
        const bool is_exact = std::all_of(rest.begin(), rest.end(), [](double r) { return r == 0.0; });
        return is_exact ? std::vector<double>() : rest;
    }

    /// All bodies at a time; `slip`: what each does in the mode.
    std::vector<PointState<double>> states(double t, std::span<const double> x,
                                           std::span<const signed char> slip) const {
        std::vector<PointState<double>> result;
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            const Body& b = bodies_[i];
            const Variables own = variables_of(b, x);
            result.push_back(moving<double>(b, t, own.q, own.v, slip[i] == flies));
            // held by its rail: the rail's own speed, exactly
            if (b.rough && slip[i] == sticks)
                result.back().set_rate(b.drive(t) / std::sqrt(result.back().curve.speed_squared));
        }
        return result;
    }

    /// Motion and reaction of a body in a mode. `acting`: what acts in it, where the state alone does not say.
    PointReport report(int index, std::span<const signed char> slip, double t, std::span<const double> x,
                       const Acting* acting = nullptr) const {
        const Body& b = bodies_[at(index)];
        const signed char phase = slip[at(index)];
        const std::vector<PointState<double>> all = states(t, x, slip);
        const PointState<double>& p = all[at(index)];
        PointReport result;
        if (b.rigid) {
            const RigidReport r = rigid_report(index, t, x, all, acting);
            result.position = p.r;
            result.velocity = p.v;
            result.acceleration = r.center_acceleration;
            result.force = r.force;
            result.reaction = r.reaction;
            result.speed = p.v.norm();
            result.effort = r.force_effort;
            result.spin_momentum = r.spin_momentum;
            result.spin_energy = r.spin_energy;
            result.spin_power = r.spin_power;
            return result;
        }
        const Resultant<double> f =
            acting != nullptr ? Resultant<double>{acting->force(index), acting->along(index)}
                              : resultant<double>(index, t, all, phase == flies, [](double w) { return std::abs(w); });
        Vector3 force = f.force, acceleration, reaction = Vector3::Zero();
        if (!b.curve || phase == flies) {
            acceleration = force / b.mass;
            if (b.curve)
                result.u = map_.value(b.first, x);
            else
                result.speed = p.v.norm();
        } else {
            const CurvePoint<double>& c = p.curve;
            const bool stuck = b.rough && phase == sticks;
            if (f.along != 0.0) force += c.first * (f.along / c.speed_squared);
            const Resultant<double> g = guided(b, p, f);
            const double w_rate = acting != nullptr ? rate_of(b.first_rate, *acting)
                                  : stuck           ? carried_rate<double>(b, t, c, p.w)
                                                    : sliding_rate<double>(b, c, p.w, g, static_cast<double>(phase),
                                                                 friction_vector<double>(b, c, p.w, g).norm());
            acceleration = p.acceleration(w_rate);
            reaction = acceleration * b.mass - force;
            const double norm = std::sqrt(c.speed_squared);
            result.rail_speed = b.rough ? b.drive(t) : 0.0;
            const double turn = result.rail_speed / norm;
            result.effort =
                force.norm() + b.mass * (acceleration.norm() + turn * turn * c.first_cross_second.norm() / norm);
            result.u = map_.value(b.first, x);
            result.w = p.w;
            result.w_rate = w_rate;
            result.speed = stuck ? b.drive(t) : p.w * norm;
            result.tangential_force = (dot<double>(c.first, p.in_rail(f.force)) + f.along) / norm;
        }
        result.position = view_.origin + view_.axes * p.r;
        result.velocity = view_.axes * p.v;
        result.acceleration = view_.axes * acceleration;
        result.force = view_.axes * force;
        result.reaction = view_.axes * reaction;
        return result;
    }
    /// Motion and reactions of a rigid body; `all`: where everything is in the mode.
    RigidReport rigid_report(int index, double t, std::span<const double> x, const std::vector<PointState<double>>& all,
                             const Acting* acting = nullptr) const {
        const Body& b = bodies_[at(index)];
        if (acting == nullptr)
            return {*b.rigid, *all[at(index)].rigid, wrench<double>(index, t, all), variables_of(b, x).q};
        double v_rate[6];
        rates_of(b, *acting, v_rate);
        return {*b.rigid, *all[at(index)].rigid, Wrench<double>{acting->force(index), acting->moment(index)}, v_rate,
                RigidReport::known_rates};
    }
    RigidReport rigid_report(int index, std::span<const signed char> slip, double t, std::span<const double> x,
                             const Acting* acting = nullptr) const {
        return rigid_report(index, t, x, states(t, x, slip), acting);
    }
    /// The rates of a body's velocities.
    void rates_of(const Body& b, const Acting& acting, double* v_rate) const {
        for (int k = 0; k < b.velocities(); ++k) v_rate[k] = rate_of(b.first_rate + k, acting);
    }
    /// How the rail of a body has turned from where its curve is placed, world axes.
    Matrix3 rail_turn(int index, double t) const {
        const RigidMotion& motion = bodies_[at(index)].motion;
        if (!motion.present()) return Matrix3::Identity();
        const RigidPlacement<double> p = motion.at(t);
        Matrix3 r;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) r(i, j) = p.row[at(i)][j];
        return r;
    }
    /// Whether nothing acts on a rigid body that turns but its weight.
    bool is_conservative(int index) const {
        const Body& b = bodies_[at(index)];
        const auto touches = [&](const ConnectedSpring& c) {
            return c.spring.present() && (c.a.body == index || c.b.body == index);
        };
        return b.rigid && b.rigid->kind != RigidLaw::Kind::prismatic && b.loads.empty() &&
               std::none_of(springs_.begin(), springs_.end(), touches);
    }
    /// Whether equations take numbers of their mode, two a body: the sign of its slip, and what is fixed in the mode.
    bool takes_numbers() const {
        return std::any_of(bodies_.begin(), bodies_.end(), [&](const Body& b) {
            return b.rough || (b.rigid && b.rigid->follows_axis && map_.is_simulated(b.fixed_variable()));
        });
    }
    /// Whether any variable of a body's rotation is simulated.
    bool turns(int index) const {
        const Body& b = bodies_[at(index)];
        if (!b.rigid || b.rigid->kind == RigidLaw::Kind::prismatic) return false;
        for (int k = b.rigid->kind == RigidLaw::Kind::free ? 3 : 0; k < b.positions(); ++k)
            if (map_.is_simulated(b.first + k)) return true;
        return false;
    }
    /// Whether any variable of a body is simulated.
    bool moves(int index) const {
        const Body& b = bodies_[at(index)];
        for (int k = 0; k < b.positions(); ++k)
            if (map_.is_simulated(b.first + k)) return true;
        for (int k = 0; k < b.velocities(); ++k)
            if (map_.is_simulated(b.first_rate + k)) return true;
        return false;
    }
    /// Whether a load of the scene is one that case distinctions can be in.
    bool is_function(const Scene::AppliedLoad& load, int index) const {
        const Body& b = bodies_[at(load.body)];
        return b.rigid ? is_present(load.load)
                       : std::find(b.function_loads.begin(), b.function_loads.end(), index) != b.function_loads.end();
    }
    /// Power of a load of the scene.
    double power(const Scene::AppliedLoad& load, std::span<const signed char> slip, double t,
                 std::span<const double> x) const {
        const Body& b = bodies_[at(load.body)];
        const PointState<double> p = states(t, x, slip)[at(load.body)];
        if (!b.rigid) {
            const Vector3 v = view_.axes * p.v;
            if (const Drag* drag = std::get_if<Drag>(&load.load)) {
                const double speed = v.norm();
                return -(drag->linear + drag->quadratic * speed) * speed * speed;
            }
            return force_of<double>(load.load, t, in_world<double>(p.r), v).dot(v);
        }
        Wrench<double> w;
        add_load(w, *b.rigid, *p.rigid,
                 {load.load, load.at ? b.rigid->point_in_frame(*load.at) : b.rigid->exact.center}, t, b.name);
        return w.force.dot(p.rigid->v) + w.moment.dot(p.rigid->omega);
    }
    /// Derivatives of a body's position and velocity variables.
    void slope(int index, std::span<const signed char> slip, double t, std::span<const double> x, std::span<double> dq,
               std::span<double> dv) const {
        const Body& b = bodies_[at(index)];
        if (b.rigid) {
            const std::vector<PointState<double>> all = states(t, x, slip);
            b.rigid->rates<double>(*all[at(index)].rigid, variables_of(b, x).q, wrench<double>(index, t, all),
                                   dq.data(), dv.data());
            return;
        }
        const PointReport r = report(index, slip, t, x);
        for (int k = 0; k < b.positions(); ++k) dq[at(k)] = dv[at(k)] = 0.0;
        if (b.curve && slip[at(index)] != flies) {
            dq[0] = r.w;
            dv[0] = r.w_rate;
            return;
        }
        const int space = b.first_of_space() - b.first;
        const Vector3 velocity = view_.axes.transpose() * r.velocity,
                      acceleration = view_.axes.transpose() * r.acceleration;
        for (int k = 0; k < 3; ++k) {
            dq[at(space + k)] = velocity[k];
            dv[at(space + k)] = acceleration[k];
        }
    }

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

    /// Active forces on body i. `length_of_w` gives |w| of a bead with the sign of its mode.
    template <class S, class Length>
    Resultant<S> resultant(int i, const S& t, const std::vector<PointState<S>>& states, bool is_flying,
                           Length&& length_of_w) const {
        const Body& b = bodies_[at(i)];
        const PointState<S>& p = states[at(i)];
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
        for (const ConnectedSpring& c : springs_) {
            if ((c.a.body != i && c.b.body != i) || !c.spring.present()) continue;
            const Vector3Of<S> force = spring_force(c, states);
            if (c.a.body == i)
                f.force += force;
            else
                f.force -= force;
        }
        return f;
    }

    /// The force of a spring on its first end.
    template <class S>
    static Vector3Of<S> spring_force(const ConnectedSpring& c, const std::vector<PointState<S>>& states) {
        const auto [ra, va] = motion_of<S>(c.a, states);
        const auto [rb, vb] = motion_of<S>(c.b, states);
        const Vector3Of<S> d = ra - rb, v = va - vb;
        if constexpr (std::is_same_v<S, double>)
            return c.spring(d, v, ra.norm() + rb.norm());
        else
            return c.spring(d, v);
    }

    /// Active forces on rigid body i, and their moment.
    template <class S>
    Wrench<S> wrench(int i, const S& t, const std::vector<PointState<S>>& states) const {
        const Body& b = bodies_[at(i)];
        const RigidState<S>& s = *states[at(i)].rigid;
        Wrench<S> w;
        w.add(s, RigidLaw::constant<S>(b.rigid->exact.weight), RigidLaw::constant<S>(b.rigid->exact.center));
        for (const RigidLoad& load : b.loads) add_load(w, *b.rigid, s, load, t, b.name);
        for (const ConnectedSpring& c : springs_) {
            if ((c.a.body != i && c.b.body != i) || !c.spring.present()) continue;
            const Vector3Of<S> force = spring_force(c, states);
            if (c.a.body == i) w.add(s, force, RigidLaw::constant<S>(c.a.point_on_rigid));
            if (c.b.body == i) w.add(s, Vector3Of<S>(-force), RigidLaw::constant<S>(c.b.point_on_rigid));
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
    static std::pair<Vector3Of<S>, Vector3Of<S>> motion_of(const SpringEnd& e,
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
    Holding holding(int i, double t, std::span<const double> x, std::span<const signed char> slip) const {
        const Body& b = bodies_[at(i)];
        std::vector<PointState<double>> all = states(t, x, slip);
        PointState<double>& p = all[at(i)];
        p.set_rate(b.drive(t) / std::sqrt(p.curve.speed_squared));
        const CurvePoint<double>& c = p.curve;
        const auto f = guided(b, p, resultant<double>(i, t, all, false, [](double v) { return std::abs(v); }));
        const double rate = carried_rate<double>(b, t, c, p.w);
        const double needed = b.mass * (c.speed_squared * rate + c.first_dot_second * (p.w * p.w)) -
                              dot<double>(c.first, f.force) - f.along;
        double terms =
            rounded(b.force).norm() + b.mass * (p.acceleration(rate).norm() + c.first_cross_second.norm() * p.w * p.w);
        for (const auto& function : b.functions)
            terms += force_of<double>(function, t, in_world<double>(p.r), view_.axes * p.v).norm();
        for (const Drag& drag : b.drags) terms += (drag.linear.now() + drag.quadratic.now() * p.v.norm()) * p.v.norm();
        for (const ConnectedSpring& s : springs_)
            if ((s.a.body == i || s.b.body == i) && s.spring.present()) {
                const auto [ra, va] = motion_of<double>(s.a, all);
                const auto [rb, vb] = motion_of<double>(s.b, all);
                terms += spring_force(s, all).norm() + s.spring.stiffness.now() * (ra.norm() + rb.norm()) +
                         s.spring.damping.now() * (va.norm() + vb.norm());
            }
        return {needed, friction_vector<double>(b, c, p.w, f).norm(),
                64.0 * epsilon * std::sqrt(c.speed_squared) * terms};
    }

    /// Whether what presses a bead on its rail is a constant that rounding of its terms alone has made.
    static bool is_rounding(const Expression& pressing, const CurvePoint<Expression>& c,
                            const Resultant<Expression>& f) {
        if (!pressing.is_constant()) return false;
        double size = 0.0;
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 3; ++k)
                if (i != k && c.first[i].is_constant() && f.force[k].is_constant())
                    size += std::abs(c.first[i].value() * f.force[k].value());
        return std::abs(pressing.value()) <= 16.0 * epsilon * size;
    }

    CurvePoint<double> curve_point(const Body& b, double u) const { return b.curve->at<double>(u, view_); }

    /// Finds where a flying bead comes back to its rail; none if the rail holds on both sides.
    std::shared_ptr<const RailLanding> landing(int i) const { return landings_[at(i)]; }

    /// Finds where a bead comes to a place where its curve is singular; none if it has none, or the bead stays.
    std::shared_ptr<const RailSingularity> singularity(int i) const { return singularities_[at(i)]; }

    /// Finds where a bead that flies comes to such a place of a rail that only pushes.
    std::shared_ptr<const SingularLanding> singular_landing(int i) const { return singular_landings_[at(i)]; }

    /// A vector of the world in the view.
    Vector3 seen(const Vector3& v) const { return snapped(view_.axes.transpose() * v, v.norm()); }
    Vector3Of<DoubleDouble> seen_exactly(const Vector3& v) const {
        return snapped(curves::turned<DoubleDouble>(view_.exact_axes().transpose(), widened(v)), v.norm());
    }
    const std::vector<ConnectedSpring>& springs() const { return springs_; }
    /// How many loads the scene has.
    int loads() const { return loads_; }

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    /// The rate of a variable; zero of what stays as it starts.
    double rate_of(int variable, const Acting& acting) const {
        return map_.is_simulated(variable) ? acting.rate(map_.place(variable)) : 0.0;
    }

    // --- seen from the view ---

    static Vector3 snapped(Vector3 v, double size) {
        for (int i = 0; i < 3; ++i)
            if (std::abs(v[i]) <= 4.0 * epsilon * size) v[i] = 0.0;
        return v;
    }
    static Vector3Of<DoubleDouble> snapped(Vector3Of<DoubleDouble> v, double size) {
        for (int i = 0; i < 3; ++i)
            if (std::abs(v[i].hi) <= 4.0 * epsilon * size) v[i] = 0.0;
        return v;
    }
    Vector3Of<DoubleDouble> seen_point(const Vector3& p) const {
        const Vector3Of<DoubleDouble> offset = widened(p) - widened(view_.origin);
        return snapped(curves::turned<DoubleDouble>(view_.exact_axes().transpose(), offset),
                       p.norm() + view_.origin.norm());
    }
    SpringEnd end(const End& e) const {
        if (const Vector3* point = std::get_if<Vector3>(&e)) return {-1, seen_point(*point), false};
        const int body = body_of(e);
        const std::optional<RigidLaw>& rigid = bodies_[at(body)].rigid;
        if (!rigid) return {body, {}, false};
        const BodyPoint* point = std::get_if<BodyPoint>(&e);
        return {body, {}, true, point != nullptr ? rigid->point_in_frame(point->point) : rigid->exact.center};
    }

    Placement view_;
    std::vector<std::shared_ptr<const RailLanding>> landings_;
    std::vector<std::shared_ptr<const RailSingularity>> singularities_;
    std::vector<std::shared_ptr<const SingularLanding>> singular_landings_;
    std::vector<Body> bodies_;
    std::vector<ConnectedSpring> springs_;
    StateMap map_;
    int positions_ = 0, variables_ = 0, loads_ = 0;
};

}  // namespace rbdyn
