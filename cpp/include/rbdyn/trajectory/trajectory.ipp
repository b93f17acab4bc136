// Definitions of rbdyn/trajectory/trajectory.hpp.
#pragma once

#include "rbdyn/trajectory/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/model/point_laws.hpp"
#include "rbdyn/model/points.hpp"
#include "rbdyn/model/rigid_law.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/plan/integrals.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/parts.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/torque.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/statics/rail_work.hpp"
#include "rbdyn/trajectory/body_motion.hpp"
#include "rbdyn/trajectory/run_data.hpp"
#include "rbdyn/trajectory/work.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct Trajectory::BodyWork {
    int body;
    RailWork work;
};

template <class F>
double Trajectory::now(double t, Side side, F&& f) const {
    if (!data_->parts.empty()) return f(observing_parts(t, side));
    const Moment m(*data_, t, side);
    return f(data_->model->observing(m.mode, t, m.x));
}

template <class F>
double Trajectory::work_between(double t0, double t1, F&& forwards) const {
    for (const double t : {t0, t1}) {
        const double near = 4.0 * std::numeric_limits<double>::epsilon() * std::abs(end());
        if (!(t >= start() - near && t <= end() + near))
            throw InvalidInput("Trajectory: time is " + text(t) + "; this run goes from " + text(start()) + " to " +
                               text(end()) + " s");
    }
    return t1 > t0 ? forwards(t0, t1) : t1 < t0 ? -forwards(t1, t0) : 0.0;
}

template <class F>
void Trajectory::each(const Bodies& of, double t, Side side, F&& f) const {
    const auto& bodies = data_->scene.bodies();
    if (of.empty()) {
        for (int i = 0; i < static_cast<int>(bodies.size()); ++i)
            f((*this)[BodyHandle{i}].report(t, side), bodies[static_cast<std::size_t>(i)].mass());
    } else {
        for (BodyHandle b : of) f((*this)[b].report(t, side), bodies[static_cast<std::size_t>(b.index)].mass());
    }
}

template <class F>
Vector3 Trajectory::mean(const Bodies& of, double t, Side side, F&& f) const {
    Vector3 sum = Vector3::Zero();
    double mass = 0.0;
    each(of, t, side, [&](const PointReport& r, double m) {
        sum += m * f(r);
        mass += m;
    });
    return sum / mass;
}

RBDYN_INLINE Trajectory::Trajectory(RunData data)
    : AnyRun(data.record.status, data.record.start, data.record.end.hi, data.certain_until, data.engine, data.error),
      data_(std::make_shared<const RunData>(std::move(data))) {
    std::vector<BodyWork> works;
    std::vector<bool> has_work(data_->scene.bodies().size());
    for (const Scene::AppliedLoad& load : data_->scene.loads())
        if (planning::has_potential_along_rail(data_->scene, load))
            has_work[static_cast<std::size_t>(load.body)] = true;
    for (int body = 0; body < static_cast<int>(has_work.size()); ++body)
        if (has_work[static_cast<std::size_t>(body)]) works.push_back({body, RailWork(data_->scene, BodyHandle{body})});
    works_ = std::make_shared<const std::vector<BodyWork>>(std::move(works));
}

RBDYN_INLINE const Statistics& Trajectory::statistics() const { return data_->statistics; }

RBDYN_INLINE const Events& Trajectory::events() const& { return data_->events; }

RBDYN_INLINE Events Trajectory::events() && { return data_->events; }

RBDYN_INLINE const Plan& Trajectory::plan() const { return data_->plan; }

RBDYN_INLINE const Scene& Trajectory::scene() const { return data_->scene; }

RBDYN_INLINE std::shared_ptr<const RunData> Trajectory::data() const { return data_; }

RBDYN_INLINE std::vector<double> Trajectory::t() const {
    std::vector<double> times;
    const auto take = [&](const Record& record) {
        if (record.closed && record.empty()) times.push_back(start());
        for (const auto& e : record.entries()) times.push_back(e.start.hi);
    };
    take(data_->record);
    for (const RunData& part : data_->parts) take(part.record);
    if (!data_->parts.empty()) {
        std::sort(times.begin(), times.end());
        times.erase(std::unique(times.begin(), std::lower_bound(times.begin(), times.end(), end())), times.end());
    }
    times.push_back(end());
    return times;
}

RBDYN_INLINE BodyMotion Trajectory::operator[](BodyHandle body) const {
    require(body.index >= 0 && body.index < static_cast<int>(data_->scene.bodies().size()), "Trajectory", "body",
            body.index, "a handle comes from the scene of this run");
    return {data_, body.index};
}

RBDYN_INLINE SpringMotion Trajectory::operator[](CouplingHandle coupling) const {
    require(coupling.index >= 0 && coupling.index < static_cast<int>(data_->scene.connections().size()), "Trajectory",
            "coupling", coupling.index, "a handle comes from the scene of this run");
    return {data_, coupling.index};
}

RBDYN_INLINE ConstraintMotion Trajectory::operator[](ConstraintHandle constraint) const {
    require(constraint.index >= 0 && constraint.index < static_cast<int>(data_->scene.constraints().size()),
            "Trajectory", "constraint", constraint.index, "a handle comes from the scene of this run");
    return {data_, constraint.index};
}

RBDYN_INLINE ContactMotion Trajectory::operator[](ContactHandle contact) const {
    require(contact.index >= 0 && contact.index < static_cast<int>(data_->scene.contacts().size()), "Trajectory",
            "contact", contact.index, "a handle comes from the scene of this run");
    return {data_, contact.index};
}

RBDYN_INLINE double Trajectory::kinetic_energy(double t, const Bodies& of, Side side) const {
    double sum = 0.0;
    each(of, t, side,
         [&](const PointReport& r, double m) { sum += 0.5 * m * r.velocity.squaredNorm() + r.spin_energy; });
    return sum;
}

RBDYN_INLINE double Trajectory::potential_energy(double t, Side side) const { return -potential(t, side); }

RBDYN_INLINE double Trajectory::potential(double t, Side side) const {
    double sum = 0.0;
    each({}, t, side, [&](const PointReport& r, double m) { sum += m * data_->scene.gravity().dot(r.position); });
    for (const auto& load : data_->scene.loads())
        if (const auto own = potential_of(load, t, side)) sum += *own;
    for (const auto& [body, work] : *works_) sum += work((*this)[BodyHandle{body}].parameter(t, side));
    for (int i = 0; i < static_cast<int>(data_->scene.connections().size()); ++i)
        sum += potential_of(CouplingHandle{i}, t, side);
    return sum;
}

RBDYN_INLINE double Trajectory::energy(double t, Side side) const {
    return kinetic_energy(t, {}, side) - potential(t, side);
}

RBDYN_INLINE double Trajectory::power(double t, const Bodies& of, Side side) const {
    double sum = 0.0;
    each(of, t, side,
         [&](const PointReport& r, double) { sum += (r.force + r.reaction).dot(r.velocity) + r.spin_power; });
    return sum;
}

RBDYN_INLINE Vector3 Trajectory::momentum(double t, const Bodies& of, Side side) const {
    Vector3 sum = Vector3::Zero();
    each(of, t, side, [&](const PointReport& r, double m) { sum += m * r.velocity; });
    return sum;
}

RBDYN_INLINE Vector3 Trajectory::angular_momentum(double t, const Vector3& pole, const Bodies& of, Side side) const {
    Vector3 sum = Vector3::Zero();
    each(of, t, side,
         [&](const PointReport& r, double m) { sum += (r.position - pole).cross(m * r.velocity) + r.spin_momentum; });
    return sum;
}

RBDYN_INLINE Vector3 Trajectory::center_of_mass(double t, const Bodies& of, Side side) const {
    return mean(of, t, side, [](const PointReport& r) { return r.position; });
}

RBDYN_INLINE Vector3 Trajectory::center_of_mass_velocity(double t, const Bodies& of, Side side) const {
    return mean(of, t, side, [](const PointReport& r) { return r.velocity; });
}

RBDYN_INLINE Vector3 Trajectory::center_of_mass_acceleration(double t, const Bodies& of, Side side) const {
    return mean(of, t, side, [](const PointReport& r) { return r.acceleration; });
}

RBDYN_INLINE double Trajectory::watched(WatchHandle watch, double t, Side side) const {
    const auto& watches = data_->scene.watches();
    require(watch.index >= 0 && watch.index < static_cast<int>(watches.size()), "Trajectory", "watch", watch.index,
            "a handle comes from the scene of this run");
    if (data_->parts.empty()) {
        const Moment m(*data_, t, side);
        return data_->model->watched(m.mode, watch.index, t, m.x);
    }
    const Scene::Watch& given = watches[static_cast<std::size_t>(watch.index)];
    for (const RunData& part : data_->parts)
        for (std::size_t i = 0; i < part.scene.watches().size(); ++i) {
            if (part.scene.watches()[i].name != given.name) continue;
            const Moment m(part, t, side);
            return part.model->watched(m.mode, static_cast<int>(i), t, m.x);
        }
    return now(t, side, [&](const Observe& observe) { return given.function(observe); });
}

RBDYN_INLINE const Scene::AppliedLoad& Trajectory::applied(LoadHandle load) const {
    const auto& loads = data_->scene.loads();
    require(load.index >= 0 && load.index < static_cast<int>(loads.size()), "Trajectory", "load", load.index,
            "a handle comes from the scene of this run");
    return loads[static_cast<std::size_t>(load.index)];
}

RBDYN_INLINE std::pair<Vector3, Vector3> Trajectory::place_of(const Scene::AppliedLoad& load, double t,
                                                              Side side) const {
    const BodyMotion motion = (*this)[BodyHandle{load.body}];
    if (load.at) return motion.point(*load.at, t, side);
    const PointReport r = motion.report(t, side);
    return {r.position, r.velocity};
}

RBDYN_INLINE std::optional<double> Trajectory::potential_of(const Scene::AppliedLoad& load, double t, Side side) const {
    if (const Force* f = std::get_if<Force>(&load.load); f != nullptr && f->is_constant() && f->frame() == Frame::world)
        return f->constant().dot(place_of(load, t, side).first);
    if (const Potential* u = std::get_if<Potential>(&load.load)) return u->value<double>(place_of(load, t, side).first);
    if (const TorsionSpring* s = std::get_if<TorsionSpring>(&load.load)) {
        const double turned = (*this)[BodyHandle{load.body}].angle(t, side) - s->rest_angle;
        return -0.5 * s->stiffness * turned * turned;
    }
    return std::nullopt;
}

RBDYN_INLINE double Trajectory::potential_of(CouplingHandle coupling, double t, Side side) const {
    const Spring& s = std::get<Spring>(scene().connections()[static_cast<std::size_t>(coupling.index)].coupling);
    const double stretch = SpringMotion(data_, coupling.index).length(t, side) - s.rest_length;
    return -0.5 * s.stiffness * stretch * stretch;
}

RBDYN_INLINE double Trajectory::work(double t0, double t1, const Bodies& of) const {
    return work_between(t0, t1, [&](double from, double to) {
        if (data_->parts.empty())
            return working::gain(*data_, from, to, [&](double t, Side side) { return kinetic_energy(t, of, side); });
        double sum = 0.0;
        for (const SceneParts::Part& part : data_->plan.apart->parts) {
            Bodies own;
            for (const int body : part.bodies) {
                const auto times = of.empty() ? 1 : std::count(of.begin(), of.end(), BodyHandle{body});
                own.insert(own.end(), static_cast<std::size_t>(times), BodyHandle{body});
            }
            if (own.empty()) continue;
            const auto run = part_of(data_, &SceneParts::bodies, part.bodies.front()).first;
            sum += working::gain(*run, from, to, [&](double t, Side side) { return kinetic_energy(t, own, side); });
        }
        return sum;
    });
}

RBDYN_INLINE double Trajectory::work(double t0, double t1, LoadHandle load) const {
    const Scene::AppliedLoad& given = applied(load);
    // a magnetic force does none
    if (!is_present(given.load) || std::holds_alternative<Lorentz>(given.load)) return 0.0;
    const auto run = part_of(data_, &SceneParts::loads, load.index).first;
    const auto potential_gain = [&](const Scene::AppliedLoad& of, double from, double to) {
        return working::gain(*run, from, to, [&](double t, Side side) { return *potential_of(of, t, side); });
    };
    const TorsionSpring* spring = std::get_if<TorsionSpring>(&given.load);
    const bool is_damped = spring != nullptr && spring->damping != 0.0;
    return work_between(t0, t1, [&](double from, double to) {
        if (!is_damped && potential_of(given, from, Side::after)) return potential_gain(given, from, to);
        // in closed form a damped spring about a hinge is alone with what has a potential
        if (is_damped && run->record.closed && !std::isfinite(run->record.closed->pace())) {
            double sum = work(from, to, Bodies{{given.body}});
            const Vector3 weight = scene().gravity() * scene().bodies()[static_cast<std::size_t>(given.body)].mass();
            sum -= working::gain(*run, from, to, [&](double t, Side side) {
                return weight.dot((*this)[BodyHandle{given.body}].center_of_mass(t, side));
            });
            for (const Scene::AppliedLoad& other : scene().loads())
                if (other.body == given.body && &other != &given && is_present(other.load))
                    sum -= potential_gain(other, from, to);
            return sum;
        }
        return working::integral(run->record, from, to, [&](double t) { return power(t, load); });
    });
}

RBDYN_INLINE double Trajectory::work(double t0, double t1, CouplingHandle coupling) const {
    (void)(*this)[coupling];
    const Coupling& given = scene().connections()[static_cast<std::size_t>(coupling.index)].coupling;
    if (!is_present(given)) return 0.0;
    const auto run = part_of(data_, &SceneParts::couplings, coupling.index).first;
    return work_between(t0, t1, [&](double from, double to) {
        if (std::get<Spring>(given).damping == 0.0)
            return working::gain(*run, from, to, [&](double t, Side side) { return potential_of(coupling, t, side); });
        return working::integral(run->record, from, to, [&](double t) { return power(t, coupling); });
    });
}

RBDYN_INLINE Observe Trajectory::observing_parts(double t, Side side) const {
    struct Present {
        Moment moment;
        Observe observe;
    };
    // the state of each part that is asked for, once
    const auto known = std::make_shared<std::map<const RunData*, Present>>();
    return [=, run = data_](const Observable& o) {
        if (o.quantity == Quantity::time) return t;
        const bool of_coupling = is_of_coupling(o.quantity);
        const auto [part, index] = part_of(run, of_coupling ? &SceneParts::couplings : &SceneParts::bodies, o.subject);
        if (part == run) {
            const SpringMotion idle(run, index);
            return o.quantity == Quantity::length ? idle.length(t, side) : idle.force(t, side)[o.component];
        }
        auto present = known->find(part.get());
        if (present == known->end()) {
            present = known->emplace(part.get(), Present{Moment(*part, t, side), {}}).first;
            const Moment& m = present->second.moment;
            present->second.observe = part->model->observing(m.mode, t, m.x);
        }
        return present->second.observe({o.quantity, index, o.component});
    };
}

RBDYN_INLINE double Trajectory::power(double t, LoadHandle load, Side side) const {
    (void)applied(load);
    const auto [part, index] = part_of(data_, &SceneParts::loads, load.index);
    const Moment m(*part, t, side);
    return part->model->power(m.mode, part->scene.loads()[static_cast<std::size_t>(index)], index, t, m.x);
}

RBDYN_INLINE double Trajectory::power(double t, CouplingHandle coupling, Side side) const {
    const SpringMotion spring = (*this)[coupling];
    return spring.force(t, side).dot(spring.relative(t, side).second);
}

RBDYN_INLINE double Trajectory::integral(const std::string& name, double t, Side side) const {
    if (name == "energy") return energy(t, side);
    if (name.starts_with("momentum ")) return momentum(t, {}, side)[name.back() - 'x'];
    const Plan& p = data_->plan;
    if (name == "angular momentum") return angular_momentum(t, p.pole, {}, side).norm();
    if (name == "angular momentum z") return angular_momentum(t, p.pole, {}, side)[2];
    if (name == "vertical angular momentum") return angular_momentum(t, p.pole, {}, side).dot(p.up);
    if ((name == "spin" || name == "Kovalevskaya") && data_->parts.empty()) {
        const PointLaws& laws = *data_->model->special();
        const RigidLaw& law = *laws.body(0).rigid;
        const PointLaws::Variables own = laws.variables_of(laws.body(0), Moment(*data_, t, side).x);
        const RigidState<double> s = law.state(own.q, own.v);
        if (name == "spin") return s.omega[2];
        return planning::kovalevskaya(law, data_->scene.gravity().norm(), s.omega, s.to_frame(p.up));
    }
    for (const auto& i : data_->scene.integrals())
        if (i.name == name) return now(t, side, [&](const Observe& observe) { return i.function(observe); });
    throw InvalidInput("Trajectory: no first integral is named \"" + name + "\" in this scene");
}

RBDYN_INLINE std::map<std::string, double> Trajectory::drift() const {
    std::map<std::string, double> result;
    std::vector<double> times = t();
    // a closed form has no pieces to look between
    const auto is_closed = [](const RunData& run) { return run.record.closed != nullptr; };
    if ((is_closed(*data_) || std::any_of(data_->parts.begin(), data_->parts.end(), is_closed)) &&
        times.size() < closed_times)
        for (int i = 0; i <= closed_times; ++i) times.push_back(start() + (end() - start()) * i / closed_times);
    for (const std::string& name : data_->plan.integrals) {
        const bool is_vector = name == "angular momentum";
        const Vector3 vector = is_vector ? angular_momentum(start(), data_->plan.pole) : Vector3::Zero().eval();
        const double first = is_vector ? 0.0 : integral(name, start());
        double largest = 0.0, scale = 0.0;
        for (const double time : times) {
            largest = std::max(largest, is_vector ? (angular_momentum(time, data_->plan.pole) - vector).norm()
                                                  : std::abs(integral(name, time) - first));
            scale = std::max(scale, size_of_terms(name, time));
        }
        result[name] = scale > 0.0 ? largest / scale : 0.0;
    }
    return result;
}

RBDYN_INLINE double Trajectory::size_of_terms(const std::string& name, double time) const {
    if (name == "energy") return kinetic_energy(time) + std::abs(potential(time));
    const bool is_momentum = name.starts_with("momentum "), is_angular = name.find("angular") != std::string::npos;
    if (!is_momentum && !is_angular) return std::abs(integral(name, time));
    double terms = 0.0;
    each({}, time, Side::after, [&](const PointReport& r, double m) {
        terms += is_momentum ? m * r.velocity.norm()
                             : m * (r.position - data_->plan.pole).norm() * r.velocity.norm() + r.spin_momentum.norm();
    });
    return terms;
}

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const Trajectory& run) {
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

}  // namespace rbdyn::inline RBDYN_FORM
