// Particles, free or on rails, smooth or rough: equations of motion, modes of friction, reactions.
//
// Notation: r(u) the rail's curve, u its parameter, w = du/dt, r' = dr/du; F the active force, Phi the rail's
// reaction; m a = F + Phi (eq. 7.7). Along r' and across it, in the curve's own parameter:
//     m (|r'|^2 w' + r'.r'' w^2) = r'.F + |r'| Phi_t                        (eq. 7.12)
//     |r'| |Phi_perp| = |c|,   c = m w^2 r' x r'' - r' x F                  (eqs. 7.13, 7.14, 7.24)
// slipping: Phi_t = -mu_d sign(slip) |Phi_perp| (eq. 7.23, 7.25);  sticking: |Phi_t| <= mu_s |Phi_perp|.
// slip = |r'| w - V, V(t) the speed of the rail's surface along itself. Since |c| needs no normal vector, straight
// stretches and points of inflection are nothing special.
//
// Vectors are seen from one placement (`view`), chosen so that what vanishes vanishes exactly: a bead on a plane
// curve under forces in its plane then has c = (0, 0, c_z), and |c| is c_z with its sign locked.
// Invariant: state variables are the positions of all bodies (u, or x y z), then their velocities (w, or vx vy vz).
#pragma once

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn {

/// Position, velocity and place on its rail of one particle, in numbers of type S.
template <class S>
struct PointState {
    Vector3Of<S> r, v;
    CurvePoint<S> curve;
    S w;
};

/// Resultant of the active forces on one particle; what is exactly along a rail is kept apart.
template <class S>
struct Resultant {
    Vector3Of<S> force;
    S along;  // r' . (forces along the rail)
};

/// Motion and reaction of one particle at a time, world axes.
struct PointReport {
    Vector3 position, velocity, acceleration, force, reaction;
    double u = 0.0, w = 0.0, speed = 0.0;
    double tangential_force = 0.0;  // Q_s = F.t (eq. 7.15)
};

class PointsModel : public HybridModel {
public:
    PointsModel(const Scene& scene, const Placement& view) : view_(view) {
        const auto& bodies = scene.bodies();
        int position = 0;
        for (const Scene::Body& b : bodies) {
            Body body;
            body.mass = b.particle.mass;
            body.name = b.name;
            if (const Rail* rail = b.rail()) {
                body.curve = rail->curve();
                body.drive = rail->drive();
                if (const auto friction = rail->friction()) {
                    body.rough = true;
                    body.mu_static = friction->mu_static;
                    body.mu_dynamic = friction->dynamic();
                }
            }
            body.first = position;
            position += body.freedoms();
            body.force = seen(scene.gravity()) * body.mass;
            body.start_u = b.parameter;
            body.start_speed = b.speed;
            body.start_position = b.position;
            body.start_velocity = b.velocity;
            bodies_.push_back(std::move(body));
        }
        freedoms_ = position;
        for (const Scene::AppliedLoad& load : scene.loads()) {
            Body& body = bodies_[at(load.body)];
            if (const Force* force = std::get_if<Force>(&load.load)) {
                if (force->is_constant())
                    body.force += seen(force->constant());
                else
                    body.functions.push_back(*force);
            } else if (const Drag* drag = std::get_if<Drag>(&load.load)) {
                body.linear_drag += drag->linear;
                body.quadratic_drag += drag->quadratic;
            }
        }
        for (Body& body : bodies_) body.force = snapped(body.force, body.force.norm());
        for (const Scene::Connection& c : scene.connections()) {
            const Spring& spring = std::get<Spring>(c.coupling);
            if (spring.stiffness == 0.0 && spring.damping == 0.0) continue;
            springs_.push_back({spring, end(c.a), end(c.b)});
        }
    }

    int variables() const override { return 2 * freedoms_; }
    const Placement& view() const { return view_; }
    int bodies() const { return static_cast<int>(bodies_.size()); }
    bool on_rail(int body) const { return bodies_[at(body)].curve.has_value(); }

    /// The state the scene starts in.
    std::vector<double> start(double t) const {
        std::vector<double> x(at(variables()), 0.0);
        for (const Body& b : bodies_) {
            double* q = x.data() + b.first;
            double* v = q + freedoms_;
            if (b.curve) {
                *q = b.start_u;
                *v = b.start_speed / std::sqrt(curve_point(b, b.start_u).speed_squared);
                continue;
            }
            const Vector3 r = seen_point(b.start_position), vel = seen(b.start_velocity);
            for (int i = 0; i < 3; ++i) {
                q[i] = r[i];
                v[i] = vel[i];
            }
        }
        (void)t;
        return x;
    }

    Mode begin(double t, std::span<double> x) const override {
        Mode mode;
        mode.slip.assign(bodies_.size(), 1);
        for (int i = 0; i < bodies(); ++i) {
            const Body& b = bodies_[at(i)];
            if (!b.rough) continue;
            // the slip as the user gave it, so that a bead carried by its rail starts stuck
            const double slip = b.start_speed - b.drive(t);
            const double size = std::max(std::abs(b.start_speed), std::abs(b.drive(t)));
            if (std::abs(slip) > 4.0 * epsilon * size)
                mode.slip[at(i)] = slip > 0.0 ? 1 : -1;
            else
                mode.slip[at(i)] = settle(mode, i, t, x);
        }
        choose(mode, t, x, {});
        return mode;
    }

    Mode next(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
              std::vector<Happening>& happenings) const override {
        Mode after = mode;
        std::vector<int> flipped;
        for (int index : fired) {
            const Guard& guard = mode.equations->guards[at(index)];
            const int i = guard.subject;
            const double sign = guard.sign_parameter >= 0 ? mode.parameters[at(guard.sign_parameter)] : 1.0;
            const Direction direction = sign > 0.0 ? Direction::falling : Direction::rising;
            switch (guard.kind) {
                case EventKind::reverse: {
                    const signed char before = mode.slip[at(i)];
                    after.slip[at(i)] = settle(after, i, t, x);
                    if (after.slip[at(i)] == 0)
                        happenings.push_back({EventKind::stick, i, direction, {}});
                    else if (after.slip[at(i)] != before)
                        happenings.push_back({EventKind::reverse, i, direction, {}});
                    break;
                }
                case EventKind::slip: {
                    const signed char s = static_cast<signed char>(holding(i, t, x).tangential < 0.0 ? 1 : -1);
                    after.slip[at(i)] = s;
                    happenings.push_back({EventKind::slip, i, s > 0 ? Direction::rising : Direction::falling, {}});
                    break;
                }
                default:
                    flipped.push_back(index);
                    happenings.push_back({guard.kind, i, direction, i < 0 ? guard.name : std::string()});
                    break;
            }
        }
        choose(after, t, x, flipped);
        return after;
    }

    /// Motion and reaction of a body in a mode.
    PointReport report(const Mode& mode, int index, double t, std::span<const double> x) const {
        const Body& b = bodies_[at(index)];
        std::vector<PointState<double>> states;
        for (int i = 0; i < bodies(); ++i) states.push_back(state<double>(i, x));
        PointState<double>& p = states[at(index)];
        PointReport result;
        const bool stuck = b.rough && mode.slip[at(index)] == 0;
        if (b.curve && stuck) {
            // held by its rail: the rail's own speed, exactly
            p.w = b.drive(t) / std::sqrt(p.curve.speed_squared);
            p.v = p.curve.first * p.w;
        }
        const auto length_of_w = [](double w) { return std::abs(w); };
        const Resultant<double> f = resultant<double>(index, t, states, length_of_w);
        Vector3 force = f.force, acceleration, reaction = Vector3::Zero();
        if (!b.curve) {
            acceleration = force / b.mass;
        } else {
            const CurvePoint<double>& c = p.curve;
            if (f.along != 0.0) force += c.first * (f.along / c.speed_squared);
            const double w_rate = stuck ? carried_rate<double>(b, t, c, p.w)
                                        : sliding_rate<double>(b, c, p.w, f, static_cast<double>(mode.slip[at(index)]),
                                                               length(friction_vector<double>(b, c, p.w, f)));
            acceleration = c.first * w_rate + c.second * (p.w * p.w);
            reaction = acceleration * b.mass - force;
            const double norm = std::sqrt(c.speed_squared);
            result.u = x[at(b.first)];
            result.w = p.w;
            result.speed = stuck ? b.drive(t) : p.w * norm;
            result.tangential_force = (dot<double>(c.first, f.force) + f.along) / norm;
        }
        result.position = view_.origin + view_.axes * p.r;
        result.velocity = view_.axes * p.v;
        result.acceleration = view_.axes * acceleration;
        result.force = view_.axes * force;
        result.reaction = view_.axes * reaction;
        return result;
    }

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    struct Body {
        std::string name;
        double mass = 0.0;
        std::optional<Curve> curve;
        bool rough = false;
        double mu_static = 0.0, mu_dynamic = 0.0;
        TimeFunction drive;
        int first = 0;                    // its first position variable
        Vector3 force = Vector3::Zero();  // constant forces together
        double linear_drag = 0.0, quadratic_drag = 0.0;
        std::vector<Force> functions;
        double start_u = 0.0, start_speed = 0.0;
        Vector3 start_position = Vector3::Zero(), start_velocity = Vector3::Zero();

        int freedoms() const { return curve ? 1 : 3; }
    };
    struct SpringEnd {
        int body = -1;
        Vector3 point = Vector3::Zero();
    };
    struct ConnectedSpring {
        Spring spring;
        SpringEnd a, b;
    };

    /// What sticking asks of the rail.
    struct Holding {
        double tangential;  // |r'| Phi_t
        double across;      // |r'| |Phi_perp|
    };

    // --- seen from the view ---

    static Vector3 snapped(Vector3 v, double size) {
        for (int i = 0; i < 3; ++i)
            if (std::abs(v[i]) <= 4.0 * epsilon * size) v[i] = 0.0;
        return v;
    }
    Vector3 seen(const Vector3& v) const { return snapped(view_.axes.transpose() * v, v.norm()); }
    Vector3 seen_point(const Vector3& p) const {
        return snapped(view_.axes.transpose() * (p - view_.origin), p.norm() + view_.origin.norm());
    }
    SpringEnd end(const End& e) const {
        if (const BodyHandle* body = std::get_if<BodyHandle>(&e)) return {body->index, Vector3::Zero()};
        return {-1, seen_point(std::get<Vector3>(e))};
    }
    CurvePoint<double> curve_point(const Body& b, double u) const { return b.curve->at<double>(u, view_); }

    // --- the laws, in any number type ---

    template <class S>
    PointState<S> moving(const Body& b, const S* q, const S* v) const {
        PointState<S> p;
        if (b.curve) {
            p.curve = b.curve->at<S>(*q, view_);
            p.w = *v;
            p.r = p.curve.position;
            p.v = p.curve.first * p.w;
        } else {
            p.r = {q[0], q[1], q[2]};
            p.v = {v[0], v[1], v[2]};
        }
        return p;
    }

    template <class S>
    PointState<S> state(int i, std::span<const S> x) const {
        const Body& b = bodies_[at(i)];
        return moving<S>(b, x.data() + b.first, x.data() + b.first + freedoms_);
    }

    /// Active forces on body i. `length_of_w` gives |w| of a bead with the sign of its mode.
    template <class S, class Length>
    Resultant<S> resultant(int i, const S& t, const std::vector<PointState<S>>& states, Length&& length_of_w) const {
        const Body& b = bodies_[at(i)];
        const PointState<S>& p = states[at(i)];
        Resultant<S> f{b.force.template cast<S>(), S(0.0)};
        for (const Force& function : b.functions) {
            const Matrix3& axes = view_.axes;
            const Vector3Of<S> r = turned<S>(axes, p.r), v = turned<S>(axes, p.v);
            f.force += turned<S>(axes.transpose(), function(t, Vector3Of<S>(r + view_.origin.template cast<S>()), v));
        }
        if (b.linear_drag != 0.0 || b.quadratic_drag != 0.0) {
            S factor = S(b.linear_drag);
            if (b.curve) {
                if (b.quadratic_drag != 0.0)
                    factor += S(b.quadratic_drag) * sqrt_of(p.curve.speed_squared) * length_of_w(p.w);
                f.along -= factor * p.w * p.curve.speed_squared;
            } else {
                if (b.quadratic_drag != 0.0) factor += S(b.quadratic_drag) * length(p.v, "speed of " + b.name);
                f.force -= p.v * factor;
            }
        }
        for (const ConnectedSpring& c : springs_) {
            if (c.a.body != i && c.b.body != i) continue;
            const auto [ra, va] = motion_of<S>(c.a, states);
            const auto [rb, vb] = motion_of<S>(c.b, states);
            const Vector3Of<S> d = ra - rb, v = va - vb;
            const Vector3Of<S> force = c.spring(d, v);
            if (c.a.body == i)
                f.force += force;
            else
                f.force -= force;
        }
        return f;
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
    std::pair<Vector3Of<S>, Vector3Of<S>> motion_of(const SpringEnd& e,
                                                    const std::vector<PointState<S>>& states) const {
        if (e.body >= 0) return {states[at(e.body)].r, states[at(e.body)].v};
        return {e.point.cast<S>(), Vector3::Zero().cast<S>()};
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

    Holding holding(int i, double t, std::span<const double> x) const {
        const Body& b = bodies_[at(i)];
        std::vector<PointState<double>> states;
        for (int j = 0; j < bodies(); ++j) states.push_back(state<double>(j, x));
        const CurvePoint<double>& c = states[at(i)].curve;
        double& w = states[at(i)].w;
        w = b.drive(t) / std::sqrt(c.speed_squared);
        states[at(i)].v = c.first * w;
        const auto f = resultant<double>(i, t, states, [](double v) { return std::abs(v); });
        const double rate = carried_rate<double>(b, t, c, w);
        const double needed =
            b.mass * (c.speed_squared * rate + c.first_dot_second * (w * w)) - dot<double>(c.first, f.force) - f.along;
        return {needed, friction_vector<double>(b, c, w, f).norm()};
    }

    /// What a bead without slip does: sticks (0), or starts to slip with the sign returned. Sets w exactly.
    signed char settle(const Mode& mode, int i, double t, std::span<double> x) const {
        const Body& b = bodies_[at(i)];
        const CurvePoint<double> c = curve_point(b, x[at(b.first)]);
        x[at(b.first + freedoms_)] = b.drive(t) / std::sqrt(c.speed_squared);
        const Holding h = holding(i, t, x);
        const double limit = b.mu_static * h.across, needed = std::abs(h.tangential);
        const signed char escape = static_cast<signed char>(h.tangential < 0.0 ? 1 : -1);
        if (needed > limit * (1.0 + 8.0 * epsilon)) return escape;
        if (needed < limit * (1.0 - 8.0 * epsilon) || needed == 0.0) return 0;
        // on the edge of the cone: it holds unless the next moment asks for more
        Mode stuck = mode;
        stuck.slip[at(i)] = 0;
        choose(stuck, t, x, {});
        for (const Guard& guard : stuck.equations->guards)
            if (guard.kind == EventKind::slip && guard.subject == i)
                return leading_sign(stuck, t, x, guard.output) < 0 ? escape : static_cast<signed char>(0);
        return 0;
    }

    // --- recorded equations, one program a structure (who sticks) ---

    struct Structure {
        Equations equations;
        bool still = false;
    };

    static std::string subject_of_normal(const Body& b) { return "normal reaction on " + b.name; }

    /// Equations for the bodies that stick (`held`) and those that do not.
    std::unique_ptr<Structure> record(const std::vector<bool>& held) const {
        using S = Expression;
        Recorder r;
        const int n = freedoms_, count = bodies();
        if (count > 0) r.parameter(2 * count - 1);
        const S t = r.time();
        // a bead that sticks to a rail at rest does not move: its coordinate is a parameter
        std::vector<S> q(at(n)), v(at(n));
        std::vector<bool> fixed(at(count), false);
        for (int i = 0; i < count; ++i) {
            const Body& b = bodies_[at(i)];
            fixed[at(i)] = held[at(i)] && b.drive.is_zero();
            for (int k = b.first; k < b.first + b.freedoms(); ++k) {
                q[at(k)] = fixed[at(i)] ? r.parameter(count + i) : r.input(k);
                v[at(k)] = fixed[at(i)] ? S(0.0) : r.input(n + k);
            }
        }
        std::vector<PointState<S>> states;
        for (const Body& b : bodies_) states.push_back(moving<S>(b, &q[at(b.first)], &v[at(b.first)]));
        std::vector<S> outputs(at(2 * n), S(0.0)), watched;
        std::vector<Guard> guards;
        const auto guard = [&](EventKind kind, GuardRole role, int i, const S& value, int sign,
                               const std::string& name) {
            if (constant(r, value)) return;
            guards.push_back({kind, role, i, 2 * n + static_cast<int>(watched.size()), sign, Direction::falling, name});
            watched.push_back(value);
        };
        for (int i = 0; i < count; ++i) {
            const Body& b = bodies_[at(i)];
            const PointState<S>& p = states[at(i)];
            const bool slips = b.rough && !held[at(i)];
            const S sign = slips ? r.parameter(i) : S(1.0);
            // with a rail at rest, the sign of the slip is the sign of w
            const auto length_of_w = [&](const S& w) -> S {
                if (w.is_zero()) return 0.0;
                return (slips && b.drive.is_zero() ? sign : locked_sign(w, "speed of " + b.name)) * w;
            };
            const Resultant<S> f = resultant<S>(i, t, states, length_of_w);
            if (!b.curve) {
                for (int k = 0; k < 3; ++k) {
                    outputs[at(b.first + k)] = p.v[k];
                    outputs[at(n + b.first + k)] = f.force[k] / S(b.mass);
                }
                continue;
            }
            const CurvePoint<S>& c = p.curve;
            S rate = 0.0;
            if (!b.rough) {
                rate = sliding_rate<S>(b, c, p.w, f, S(0.0), S(0.0));
            } else if (slips) {
                S across = 0.0;
                if (b.mu_dynamic > 0.0) across = length(friction_vector<S>(b, c, p.w, f), subject_of_normal(b), i);
                rate = sliding_rate<S>(b, c, p.w, f, sign, across);
                S slip = p.w;
                if (!b.drive.is_zero()) slip = sqrt_of(c.speed_squared) * p.w - b.drive(t);
                guard(EventKind::reverse, GuardRole::mode, i, slip, i, "slip of " + b.name);
            } else {
                if (!fixed[at(i)]) rate = carried_rate<S>(b, t, c, p.w);
                const S needed = S(b.mass) * (c.speed_squared * rate + c.first_dot_second * (p.w * p.w)) -
                                 dot<S>(c.first, f.force) - f.along;
                const Vector3Of<S> across = friction_vector<S>(b, c, p.w, f);
                guard(EventKind::slip, GuardRole::mode, i,
                      S(b.mu_static * b.mu_static) * dot<S>(across, across) - needed * needed, -1, "hold of " + b.name);
            }
            outputs[at(b.first)] = p.w;
            outputs[at(n + b.first)] = rate;
            const Domain domain = b.curve->domain();
            if (!b.curve->closed() && !fixed[at(i)]) {
                if (std::isfinite(domain.begin))
                    guard(EventKind::rail_end, GuardRole::stop, i, q[at(b.first)] - S(domain.begin), -1, {});
                if (std::isfinite(domain.end))
                    guard(EventKind::rail_end, GuardRole::stop, i, S(domain.end) - q[at(b.first)], -1, {});
            }
        }
        auto result = std::make_unique<Structure>();
        result->still = guards.empty();
        for (const S& out : outputs) result->still = result->still && out.is_zero();
        outputs.insert(outputs.end(), watched.begin(), watched.end());
        Equations& e = result->equations;
        e.program = Program(r, outputs, 2 * n);
        e.guards = std::move(guards);
        for (std::size_t k = 0; k < e.program.switches().size(); ++k) {
            const Switch& s = e.program.switches()[k];
            e.guards.push_back({s.tag >= 0 ? EventKind::normal_zero : EventKind::switching, GuardRole::mode, s.tag,
                                e.program.outputs() + static_cast<int>(k), s.is_norm ? -1 : s.parameter,
                                Direction::falling, s.name});
            if (s.is_norm) e.start_flags.push_back(s.parameter);
        }
        for (const Body& b : bodies_) e.groups.push_back({b.first, b.freedoms(), true});
        for (const Body& b : bodies_) e.groups.push_back({n + b.first, b.freedoms(), false});
        return result;
    }

    /// Whether an expression stays what it is during smooth motion.
    static bool constant(const Recorder& r, const Expression& x) {
        if (x.is_constant()) return true;
        std::vector<std::int32_t> todo{x.node()};
        std::vector<bool> seen(at(r.size()), false);
        while (!todo.empty()) {
            const std::int32_t n = todo.back();
            todo.pop_back();
            if (seen[at(n)]) continue;
            seen[at(n)] = true;
            const Node& node = r.node(n);
            if (node.operation == Operation::input || node.operation == Operation::time) return false;
            if (node.operation == Operation::parameter) continue;
            for (std::int32_t operand : {node.a, node.b, node.c})
                if (operand >= 0) todo.push_back(operand);
        }
        return true;
    }

    const Structure& structure(const std::vector<signed char>& slip) const {
        std::vector<bool> held;
        for (int i = 0; i < bodies(); ++i) held.push_back(bodies_[at(i)].rough && slip[at(i)] == 0);
        const std::lock_guard lock(mutex_);
        auto& found = structures_[held];
        if (!found) found = record(held);
        return *found;
    }

    /// Completes a mode: its equations and their parameters. `flipped`: guards of switches that changed sign.
    void choose(Mode& mode, double t, std::span<const double> x, std::span<const int> flipped) const {
        const Structure& s = structure(mode.slip);
        const Equations* before = mode.equations;
        const std::vector<double> old = mode.parameters;
        mode.equations = &s.equations;
        mode.still = s.still;
        const Program& program = s.equations.program;
        mode.parameters.assign(at(program.parameters()), 0.0);
        for (int i = 0; i < bodies(); ++i) {
            mode.parameters[at(i)] = mode.slip[at(i)];
            if (bodies_[at(i)].curve) mode.parameters[at(bodies() + i)] = x[at(bodies_[at(i)].first)];
        }
        if (program.switches().empty()) return;
        const int first = static_cast<int>(s.equations.guards.size() - program.switches().size());
        if (before == mode.equations) {
            // what did not switch goes on as it was
            for (const Switch& w : program.switches())
                mode.parameters[at(w.parameter)] = w.is_norm ? 0.0 : old[at(w.parameter)];
            for (int index : flipped) {
                const Switch& w = program.switches()[at(index - first)];
                mode.parameters[at(w.parameter)] = w.is_norm ? 1.0 : -old[at(w.parameter)];
            }
            return;
        }
        for (const Switch& w : program.switches()) mode.parameters[at(w.parameter)] = w.is_norm ? 0.0 : 1.0;
        Evaluator<double> values(program);
        values.set_parameters(mode.parameters);
        values(t, x);
        for (std::size_t k = 0; k < program.switches().size(); ++k) {
            const Switch& w = program.switches()[k];
            if (w.is_norm) continue;
            const double value = values.switch_value(static_cast<int>(k));
            const bool is_negative =
                value < 0.0 || (value == 0.0 && leading_sign(mode, t, x, program.outputs() + static_cast<int>(k)) < 0);
            mode.parameters[at(w.parameter)] = is_negative ? -1.0 : 1.0;
        }
    }

    /// The sign an output takes just after t: that of its first coefficient that is not zero. 0: it stays zero.
    static int leading_sign(const Mode& mode, double t, std::span<const double> x, int output) {
        constexpr int order = 8;
        const Program& program = mode.equations->program;
        SeriesEvaluator series(program, order);
        series.set_parameters(mode.parameters);
        series.begin(t, 1.0);
        for (std::size_t i = 0; i < x.size(); ++i) series.set_input(static_cast<int>(i), 0, x[i]);
        for (int k = 0; k <= order; ++k) {
            series.advance(k);
            if (k < order)
                for (int i = 0; i < program.inputs(); ++i) series.set_input(i, k + 1, series.output(i)[k] / (k + 1));
        }
        const double* g = series.output(output);
        double size = 0.0;
        for (int k = 0; k <= order; ++k) size = std::max(size, std::abs(g[k]));
        for (int k = 0; k <= order; ++k)
            if (std::abs(g[k]) > 1e-13 * size) return g[k] > 0.0 ? 1 : -1;
        return 0;
    }

    Placement view_;
    std::vector<Body> bodies_;
    std::vector<ConnectedSpring> springs_;
    int freedoms_ = 0;
    mutable std::mutex mutex_;
    mutable std::map<std::vector<bool>, std::unique_ptr<Structure>> structures_;
};

}  // namespace rbdyn
