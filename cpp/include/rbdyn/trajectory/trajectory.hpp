// A run: pieces of motion with their modes, events, and everything that can be computed from them when asked for.
//
// Conventions: times in s, world axes. At a jump a value is the one after it, unless side = before is asked for.
// Accelerations and reactions come from the model at the state, never from differentiating a piece.
// A trajectory owns all it needs and outlives its scene.
#pragma once

#include <iomanip>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/event/record.hpp"
#include "rbdyn/model/points.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/statics/rail_potential.hpp"

namespace rbdyn {

/// The price of a run.
struct Statistics {
    double seconds = 0.0;              // the whole call, estimate of the error included
    double integration_seconds = 0.0;  // the returned motion alone
    std::int64_t steps = 0, rejected = 0, right_hand_sides = 0, jacobians = 0, guard_evaluations = 0, events = 0;
    std::int64_t python_calls = 0;
    int runs = 1;  // integrations, those for the estimate counted
};

inline std::ostream& operator<<(std::ostream& out, const Statistics& s) {
    return out << "seconds " << s.seconds << ", integration " << s.integration_seconds << ", steps " << s.steps
               << ", rejected " << s.rejected << ", right-hand sides " << s.right_hand_sides << ", Jacobians "
               << s.jacobians << ", guard evaluations " << s.guard_evaluations << ", events " << s.events
               << ", Python calls " << s.python_calls << ", runs " << s.runs;
}

/// The events of a run, in order of time.
class Events : public std::vector<Event> {
public:
    using std::vector<Event>::vector;
    explicit Events(std::vector<Event> events) : std::vector<Event>(std::move(events)) {}

    /// Times of the events of a kind or name, of one body if given.
    std::vector<double> times(const std::string& kind_or_name, std::optional<BodyHandle> subject = std::nullopt) const {
        std::vector<double> result;
        for (const Event& e : *this)
            if ((name_of(e.kind) == kind_or_name || e.name == kind_or_name) &&
                (!subject || e.subject == subject->index))
                result.push_back(e.time);
        return result;
    }
};

/// What a trajectory is made of.
struct RunData {
    Scene scene;
    Plan plan;
    std::shared_ptr<const PointsModel> model;
    Record record;
    Events events;
    std::string engine;
    std::optional<double> error;  // estimated global error, relative to the motion's scales
    double certain_until = 0.0;
    Statistics statistics;
};

/// The state of a run at a time. Throws InvalidInput for a time it does not hold.
struct Moment {
    const Mode& mode;
    std::vector<double> x;

    Moment(const RunData& data, double t, Side side)
        : mode(mode_at(data.record, t, side)), x(state_at(data.record, t, side)) {}

private:
    static const Mode& mode_at(const Record& record, double t, Side side) {
        const auto index = entry_at(record, t, side);
        return index ? record.mode(*index) : record.modes.front();
    }
};

class Trajectory;

/// Motion of one body of a run.
class BodyMotion {
public:
    BodyMotion(std::shared_ptr<const RunData> data, int body) : data_(std::move(data)), body_(body) {}

    /// Asks for no force [m].
    Vector3 position(double t, Side side = Side::after) const {
        const Moment m(*data_, t, side);
        return data_->model->position(m.mode, body_, t, m.x);
    }
    Vector3 velocity(double t, Side side = Side::after) const { return report(t, side).velocity; }          // m/s
    Vector3 acceleration(double t, Side side = Side::after) const { return report(t, side).acceleration; }  // m/s^2
    /// Resultant of the active forces [N].
    Vector3 force(double t, Side side = Side::after) const { return report(t, side).force; }

    /// The curve's parameter. On a rail.
    double parameter(double t, Side side = Side::after) const { return railed(t, side).u; }
    /// From the beginning of the curve, or from u = 0 where it has none [m]. On a rail.
    double arc_length(double t, Side side = Side::after) const {
        const double u = railed(t, side).u;
        return curve().length(arc_length_origin(curve()), u);
    }
    /// ds/dt along the curve as placed [m/s]. On a rail.
    double speed(double t, Side side = Side::after) const { return railed(t, side).speed; }
    /// Q_s = F.t, the active force along the curve (eq. 7.15) [N]. On a rail.
    double tangential_force(double t, Side side = Side::after) const { return railed(t, side).tangential_force; }
    /// Reaction of the rail on the body [N], world axes. On a rail.
    Vector3 reaction(double t, Side side = Side::after) const { return railed(t, side).reaction; }
    /// The same along tangent, normal, binormal (eqs. 7.12-7.14) [N]. On a rail.
    Vector3 reaction_frenet(double t, Side side = Side::after) const {
        const PointReport r = railed(t, side);
        const Frenet f = curve().frenet(r.u);
        return {r.reaction.dot(f.tangent), r.reaction.dot(f.normal), r.reaction.dot(f.binormal)};
    }

    PointReport report(double t, Side side = Side::after) const;

private:
    PointReport railed(double t, Side side) const {
        if (!data_->model->on_rail(body_))
            throw InvalidInput(
                data_->scene.bodies()[static_cast<std::size_t>(body_)].name +
                ": it is free, and only a body on a rail has a parameter, a speed along it and a reaction");
        return report(t, side);
    }
    const Curve& curve() const { return data_->scene.bodies()[static_cast<std::size_t>(body_)].rail()->curve(); }

    std::shared_ptr<const RunData> data_;
    int body_;
};

/// Length and force of a spring of a run.
class SpringMotion {
public:
    SpringMotion(std::shared_ptr<const RunData> data, int index) : data_(std::move(data)), index_(index) {}

    double length(double t, Side side = Side::after) const { return relative(t, side).first.norm(); }  // m
    /// Force on the first end [N], world axes.
    Vector3 force(double t, Side side = Side::after) const {
        const auto [d, v] = relative(t, side);
        return std::get<Spring>(connection().coupling)(d, v);
    }

private:
    const Scene::Connection& connection() const { return data_->scene.connections()[static_cast<std::size_t>(index_)]; }
    std::pair<Vector3, Vector3> relative(double t, Side side) const {
        const auto end = [&](const End& e) -> std::pair<Vector3, Vector3> {
            if (const BodyHandle* body = std::get_if<BodyHandle>(&e)) {
                const PointReport r = BodyMotion(data_, body->index).report(t, side);
                return {r.position, r.velocity};
            }
            return {std::get<Vector3>(e), Vector3::Zero()};
        };
        const auto a = end(connection().a), b = end(connection().b);
        return {a.first - b.first, a.second - b.second};
    }

    std::shared_ptr<const RunData> data_;
    int index_;
};

/// The result of simulate(): motion, events, error estimate, price.
class Trajectory {
public:
    explicit Trajectory(RunData data) : data_(std::make_shared<const RunData>(std::move(data))) {
        std::map<int, RailWork> works;
        for (const Scene::AppliedLoad& load : data_->scene.loads())
            if (planning::has_potential_along_rail(data_->scene, load) && !works.contains(load.body))
                works.emplace(load.body, RailWork(data_->scene, BodyHandle{load.body}));
        works_ = std::make_shared<const std::map<int, RailWork>>(std::move(works));
    }

    Status status() const { return data_->record.status; }
    double start() const { return data_->record.start; }
    double end() const { return data_->record.end.hi; }
    double certain_until() const { return data_->certain_until; }
    const std::string& engine() const { return data_->engine; }
    /// Estimated global error, each quantity relative to its own scale in this motion; none with rtol.
    std::optional<double> error() const { return data_->error; }
    const Statistics& statistics() const { return data_->statistics; }
    const Events& events() const { return data_->events; }
    const Plan& plan() const { return data_->plan; }
    const Scene& scene() const { return data_->scene; }
    std::shared_ptr<const RunData> data() const { return data_; }

    /// The ends of the integrator's pieces [s].
    std::vector<double> t() const {
        std::vector<double> times;
        for (const auto& e : data_->record.entries()) times.push_back(e.start.hi);
        times.push_back(end());
        return times;
    }

    BodyMotion operator[](BodyHandle body) const {
        require(body.index >= 0 && body.index < static_cast<int>(data_->scene.bodies().size()), "Trajectory", "body",
                body.index, "a handle comes from the scene of this run");
        return {data_, body.index};
    }
    SpringMotion operator[](CouplingHandle coupling) const {
        require(coupling.index >= 0 && coupling.index < static_cast<int>(data_->scene.connections().size()),
                "Trajectory", "coupling", coupling.index, "a handle comes from the scene of this run");
        return {data_, coupling.index};
    }

    // --- of the whole system, or of some bodies (`of`; empty: all) ---
    using Bodies = std::vector<BodyHandle>;

    double kinetic_energy(double t, const Bodies& of = {}, Side side = Side::after) const {
        double sum = 0.0;
        each(of, t, side, [&](const PointReport& r, double m) { sum += 0.5 * m * r.velocity.squaredNorm(); });
        return sum;
    }
    /// V = -U of gravity, constant forces, potentials and springs [J], zero at the origin and at rest length; and of
    /// forces that have a potential along a smooth rail at rest, zero where its arc length is.
    double potential_energy(double t, Side side = Side::after) const { return -potential(t, side); }
    /// U, with F = +grad U (the chapter's sign).
    double potential(double t, Side side = Side::after) const {
        double sum = 0.0;
        each({}, t, side, [&](const PointReport& r, double m) { sum += m * data_->scene.gravity().dot(r.position); });
        for (const auto& load : data_->scene.loads())
            if (const Force* f = std::get_if<Force>(&load.load); f != nullptr && f->is_constant())
                sum += f->constant().dot((*this)[BodyHandle{load.body}].position(t, side));
            else if (const Potential* u = std::get_if<Potential>(&load.load))
                sum += u->value<double>((*this)[BodyHandle{load.body}].position(t, side));
        for (const auto& [body, work] : *works_) sum += work((*this)[BodyHandle{body}].parameter(t, side));
        for (std::size_t i = 0; i < data_->scene.connections().size(); ++i) {
            const Spring& s = std::get<Spring>(data_->scene.connections()[i].coupling);
            const double stretch = SpringMotion(data_, static_cast<int>(i)).length(t, side) - s.rest_length;
            sum -= 0.5 * s.stiffness * stretch * stretch;
        }
        return sum;
    }
    /// T + V = T - U [J].
    double energy(double t, Side side = Side::after) const { return kinetic_energy(t, {}, side) - potential(t, side); }

    /// Power of all forces on the bodies, reactions included: dT/dt (Thm 7.6) [W].
    double power(double t, const Bodies& of = {}, Side side = Side::after) const {
        double sum = 0.0;
        each(of, t, side, [&](const PointReport& r, double) { sum += (r.force + r.reaction).dot(r.velocity); });
        return sum;
    }
    /// Power of one load, of one coupling on both its ends [W].
    double power(double t, LoadHandle load, Side side = Side::after) const;
    double power(double t, CouplingHandle coupling, Side side = Side::after) const;

    /// Work of the same forces from t0 to t1 (Thm 7.9) [J], by Gauss's quadrature on every piece.
    double work(double t0, double t1, const Bodies& of = {}) const {
        return integral_over_pieces(t0, t1, [&](double t) { return power(t, of); });
    }
    double work(double t0, double t1, LoadHandle load) const {
        return integral_over_pieces(t0, t1, [&](double t) { return power(t, load); });
    }
    double work(double t0, double t1, CouplingHandle coupling) const {
        return integral_over_pieces(t0, t1, [&](double t) { return power(t, coupling); });
    }

    Vector3 momentum(double t, const Bodies& of = {}, Side side = Side::after) const {
        Vector3 sum = Vector3::Zero();
        each(of, t, side, [&](const PointReport& r, double m) { sum += m * r.velocity; });
        return sum;
    }
    Vector3 angular_momentum(double t, const Vector3& pole = Vector3::Zero(), const Bodies& of = {},
                             Side side = Side::after) const {
        Vector3 sum = Vector3::Zero();
        each(of, t, side, [&](const PointReport& r, double m) { sum += (r.position - pole).cross(m * r.velocity); });
        return sum;
    }
    Vector3 center_of_mass(double t, const Bodies& of = {}, Side side = Side::after) const {
        return mean(of, t, side, [](const PointReport& r) { return r.position; });
    }
    Vector3 center_of_mass_velocity(double t, const Bodies& of = {}, Side side = Side::after) const {
        return mean(of, t, side, [](const PointReport& r) { return r.velocity; });
    }
    Vector3 center_of_mass_acceleration(double t, const Bodies& of = {}, Side side = Side::after) const {
        return mean(of, t, side, [](const PointReport& r) { return r.acceleration; });
    }

    /// The value of a watched function, by the handle of its watch, at a time.
    double watched(WatchHandle watch, double t, Side side = Side::after) const {
        const auto& watches = data_->scene.watches();
        require(watch.index >= 0 && watch.index < static_cast<int>(watches.size()), "Trajectory", "watch", watch.index,
                "a handle comes from the scene of this run");
        const WatchFunction& function = watches[static_cast<std::size_t>(watch.index)].function;
        return now(t, side, [&](const Observe& observe) { return function(observe); });
    }

    /// A first integral of the scene, by name, at a time.
    double integral(const std::string& name, double t, Side side = Side::after) const {
        if (name == "energy") return energy(t, side);
        if (name.starts_with("momentum ")) return momentum(t, {}, side)[name.back() - 'x'];
        if (name == "angular momentum") return angular_momentum(t, Vector3::Zero(), {}, side).norm();
        if (name == "angular momentum z") return angular_momentum(t, Vector3::Zero(), {}, side)[2];
        for (const auto& i : data_->scene.integrals())
            if (i.name == name) return now(t, side, [&](const Observe& observe) { return i.function(observe); });
        throw InvalidInput("Trajectory: no first integral is named \"" + name + "\" in this scene");
    }

    /// The largest departure of every first integral of the scene from its value at the start, relative to the
    /// largest size of its terms.
    std::map<std::string, double> drift() const;

private:
    /// f of what can be observed at a time.
    template <class F>
    double now(double t, Side side, F&& f) const {
        const Moment m(*data_, t, side);
        return f(data_->model->observing(m.mode, t, m.x));
    }
    template <class F>
    double integral_over_pieces(double t0, double t1, F&& f) const {
        if (t1 < t0) return -integral_over_pieces(t1, t0, f);
        // Gauss's rule of ten points: exact for polynomials of degree 19
        static constexpr double place[5] = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244,
                                            0.8650633666889845, 0.9739065285171717};
        static constexpr double weight[5] = {0.2955242247147529, 0.2692667193099963, 0.2190863625159820,
                                             0.1494513491505806, 0.0666713443086881};
        double sum = 0.0;
        for (const auto& e : data_->record.entries()) {
            const double lo = std::max(t0, e.start.hi), hi = std::min(t1, (e.start + e.length * e.unit).hi);
            if (!(hi > lo)) continue;
            const double centre = 0.5 * (lo + hi), half = 0.5 * (hi - lo);
            for (int i = 0; i < 5; ++i)
                sum += half * weight[i] * (f(centre - half * place[i]) + f(centre + half * place[i]));
        }
        return sum;
    }
    template <class F>
    void each(const Bodies& of, double t, Side side, F&& f) const {
        const auto& bodies = data_->scene.bodies();
        if (of.empty()) {
            for (int i = 0; i < static_cast<int>(bodies.size()); ++i)
                f((*this)[BodyHandle{i}].report(t, side), bodies[static_cast<std::size_t>(i)].particle.mass);
        } else {
            for (BodyHandle b : of)
                f((*this)[b].report(t, side), bodies[static_cast<std::size_t>(b.index)].particle.mass);
        }
    }
    template <class F>
    Vector3 mean(const Bodies& of, double t, Side side, F&& f) const {
        Vector3 sum = Vector3::Zero();
        double mass = 0.0;
        each(of, t, side, [&](const PointReport& r, double m) {
            sum += m * f(r);
            mass += m;
        });
        return sum / mass;
    }

    std::shared_ptr<const RunData> data_;
    std::shared_ptr<const std::map<int, RailWork>> works_;  // of forces that have a potential along a rail, by body
};

inline PointReport BodyMotion::report(double t, Side side) const {
    const Moment m(*data_, t, side);
    return data_->model->report(m.mode, body_, t, m.x);
}

inline double Trajectory::power(double t, LoadHandle load, Side side) const {
    const auto& loads = data_->scene.loads();
    require(load.index >= 0 && load.index < static_cast<int>(loads.size()), "Trajectory", "load", load.index,
            "a handle comes from the scene of this run");
    const auto& applied = loads[static_cast<std::size_t>(load.index)];
    const PointReport r = (*this)[BodyHandle{applied.body}].report(t, side);
    if (const Drag* drag = std::get_if<Drag>(&applied.load)) {
        const double v = r.velocity.norm();
        return -(drag->linear + drag->quadratic * v) * v * v;
    }
    return std::visit(
        [&](const auto& load_) -> double {
            if constexpr (std::is_same_v<std::decay_t<decltype(load_)>, Drag>)
                return 0.0;
            else
                return load_.template operator()<double>(t, r.position, r.velocity).dot(r.velocity);
        },
        applied.load);
}

inline double Trajectory::power(double t, CouplingHandle coupling, Side side) const {
    const Vector3 force = (*this)[coupling].force(t, side);
    const auto& c = data_->scene.connections()[static_cast<std::size_t>(coupling.index)];
    const auto velocity = [&](const End& e) -> Vector3 {
        if (const BodyHandle* body = std::get_if<BodyHandle>(&e)) return (*this)[*body].velocity(t, side);
        return Vector3::Zero();
    };
    return force.dot(velocity(c.a) - velocity(c.b));
}

inline std::map<std::string, double> Trajectory::drift() const {
    std::map<std::string, double> result;
    for (const std::string& name : data_->plan.integrals) {
        double largest = 0.0, scale = 0.0;
        if (name == "angular momentum") {
            const Vector3 first = angular_momentum(start());
            for (double time : t()) {
                largest = std::max(largest, (angular_momentum(time) - first).norm());
                double terms = 0.0;
                each({}, time, Side::after,
                     [&](const PointReport& r, double m) { terms += m * r.position.norm() * r.velocity.norm(); });
                scale = std::max(scale, terms);
            }
        } else {
            const double first = integral(name, start());
            for (double time : t()) {
                largest = std::max(largest, std::abs(integral(name, time) - first));
                double terms = 0.0;
                const bool is_users = !name.starts_with("momentum") && !name.starts_with("angular") && name != "energy";
                if (is_users)
                    terms = std::abs(integral(name, time));
                else if (name == "energy")
                    terms = kinetic_energy(time) + std::abs(potential(time));
                else
                    each({}, time, Side::after, [&](const PointReport& r, double m) {
                        terms += m * r.velocity.norm() * (name.starts_with("momentum") ? 1.0 : r.position.norm());
                    });
                scale = std::max(scale, terms);
            }
        }
        result[name] = scale > 0.0 ? largest / scale : 0.0;
    }
    return result;
}

inline std::ostream& operator<<(std::ostream& out, const Trajectory& run) {
    out << "Run: " << name_of(run.status()) << " at t = " << text(run.end()) << " s. " << advice(run.status()) << '\n';
    const auto& s = run.statistics();
    out << "  engine " << run.engine() << ", " << s.steps << " steps, " << run.events().size() << " events, ";
    if (run.error()) {
        std::ostringstream error;
        error << std::setprecision(2) << *run.error();
        out << "estimated global error " << error.str();
    } else {
        out << "no estimate of the global error (rtol)";
    }
    std::ostringstream seconds;
    seconds << std::setprecision(3) << s.seconds * 1e3;
    return out << ", " << seconds.str() << " ms\n";
}

}  // namespace rbdyn
