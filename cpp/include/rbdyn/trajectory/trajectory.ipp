// Definitions of rbdyn/trajectory/trajectory.hpp.
#pragma once

#include "rbdyn/trajectory/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <ostream>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/interruption.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/expression/given.hpp"
#include "rbdyn/model/body_report.hpp"
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
#include "rbdyn/special/lone_body.hpp"
#include "rbdyn/statics/rail_work.hpp"
#include "rbdyn/trajectory/body_motion.hpp"
#include "rbdyn/trajectory/pole.hpp"
#include "rbdyn/trajectory/run_data.hpp"
#include "rbdyn/trajectory/theorems.hpp"
#include "rbdyn/trajectory/work.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct Trajectory::BodyWork {
    int body;
    RailWork work;
};

struct Trajectory::Lengths {
    std::once_flag known;
    std::vector<double> values;
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

namespace events {

/// The same run, its events told the names in its scene: a run is long to move.
RBDYN_INLINE RunData& named(RunData& data) {
    std::vector<std::string> names;
    names.reserve(data.scene.bodies().size() + data.scene.watches().size() + data.scene.contacts().size());
    const auto add = [&](const auto& things) {
        for (const auto& thing : things) names.push_back(thing.name);
    };
    add(data.scene.bodies());
    add(data.scene.watches());
    add(data.scene.contacts());
    data.events = std::move(data.events).among(std::move(names));
    return data;
}

}  // namespace events

RBDYN_INLINE Trajectory::Trajectory(RunData data)
    : AnyRun(data.record.status, data.record.start, data.record.end.hi, data.certain_until, data.engine, data.error),
      data_(std::make_shared<const RunData>(std::move(events::named(data)))) {
    std::vector<BodyWork> works;
    std::vector<bool> has_work(data_->scene.bodies().size());
    for (const Scene::AppliedLoad& load : data_->scene.loads())
        if (planning::has_potential_along_rail(data_->scene, load))
            has_work[static_cast<std::size_t>(load.body)] = true;
    for (int body = 0; body < static_cast<int>(has_work.size()); ++body)
        if (has_work[static_cast<std::size_t>(body)]) works.push_back({body, RailWork(data_->scene, BodyHandle{body})});
    works_ = std::make_shared<const std::vector<BodyWork>>(std::move(works));
    start_lengths_ = std::make_shared<Lengths>();
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

RBDYN_INLINE BodyPointMotion Trajectory::operator[](const BodyPoint& point) const {
    return {(*this)[BodyHandle{point.body}], point.point};
}

RBDYN_INLINE CouplingMotion Trajectory::operator[](CouplingHandle coupling) const {
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

RBDYN_INLINE SystemReport Trajectory::system_at(double t, Side side, Asked asked) const {
    if (data_->parts.empty()) {
        const Moment m(*data_, t, side);
        return data_->model->system_report(m.mode, t, m.x, asked);
    }
    SystemReport all;
    const SceneParts& apart = *data_->plan.apart;
    all.bodies.resize(data_->scene.bodies().size());
    all.couplings.resize(data_->scene.connections().size());
    std::vector<SystemReport> parts;
    for (const RunData& part : data_->parts) {
        const Moment m(part, t, side);
        parts.push_back(part.model->system_report(m.mode, t, m.x, asked));
    }
    for (std::size_t i = 0; i < all.bodies.size(); ++i) {
        const auto [part, index] = apart.bodies[i];
        all.bodies[i] = parts[static_cast<std::size_t>(part)].bodies[static_cast<std::size_t>(index)];
    }
    for (std::size_t k = 0; k < all.couplings.size(); ++k) {
        CouplingReport& c = all.couplings[k];
        const auto [part, index] = apart.couplings[k];
        // what does nothing may be in no part
        if (part >= 0) c = parts[static_cast<std::size_t>(part)].couplings[static_cast<std::size_t>(index)];
        c.a = body_of(data_->scene.connections()[k].a);
        c.b = body_of(data_->scene.connections()[k].b);
    }
    return all;
}

RBDYN_INLINE double Trajectory::kinetic_energy(double t, const Bodies& of, Side side) const {
    const SystemReport system = system_at(t, side, Asked::motion);
    return SystemPart(system, of).kinetic_energy();
}

RBDYN_INLINE double Trajectory::relative_kinetic_energy(double t, const std::optional<Pole>& pole, const Bodies& of,
                                                        Side side) const {
    const SystemReport system = system_at(t, side, Asked::motion);
    const SystemPart part(system, of);
    return part.kinetic_energy(pole ? pole->at(t, system).velocity : part.center_of_mass_velocity());
}

RBDYN_INLINE double Trajectory::potential_energy(double t, const Bodies& of, Side side) const {
    return -potential(t, of, side);
}

RBDYN_INLINE double Trajectory::potential(double t, const Bodies& of, Side side) const {
    return potential_in(system_at(t, side, Asked::motion), of);
}

RBDYN_INLINE double Trajectory::potential_in(const SystemReport& system, const Bodies& of) const {
    const SystemPart part(system, of);
    double sum = 0.0;
    std::vector<bool> is_meant(system.bodies.size(), false);
    part.each([&](const BodyReport& b, int i) {
        sum += b.mass * data_->scene.gravity().dot(b.position);
        is_meant[static_cast<std::size_t>(i)] = true;
    });
    for (const Scene::AppliedLoad& load : data_->scene.loads()) {
        const auto body = static_cast<std::size_t>(load.body);
        if (!is_meant[body]) continue;
        if (const auto own = potential_of(load, system.bodies[body])) sum += *own;
    }
    for (const auto& [body, work] : *works_)
        if (const auto i = static_cast<std::size_t>(body); is_meant[i]) sum += work(system.bodies[i].coordinate);
    for (std::size_t k = 0; k < system.couplings.size(); ++k)
        if (part.is_within_or_to_world(system.couplings[k]))
            sum += potential_of(system.couplings[k], static_cast<int>(k));
    return sum;
}

RBDYN_INLINE double Trajectory::energy(double t, const Bodies& of, Side side) const {
    const SystemReport system = system_at(t, side, Asked::motion);
    return SystemPart(system, of).kinetic_energy() - potential_in(system, of);
}

RBDYN_INLINE double Trajectory::power(double t, const Bodies& of, Side side) const {
    const SystemReport system = system_at(t, side, Asked::forces);
    return SystemPart(system, of).power();
}

RBDYN_INLINE Vector3 Trajectory::momentum(double t, const Bodies& of, Side side) const {
    const SystemReport system = system_at(t, side, Asked::motion);
    return SystemPart(system, of).momentum();
}

RBDYN_INLINE Vector3 Trajectory::angular_momentum(double t, const Pole& pole, const Bodies& of, Side side) const {
    const SystemReport system = system_at(t, side, Asked::motion);
    return SystemPart(system, of).angular_momentum(pole.at(t, system).place);
}

RBDYN_INLINE Vector3 Trajectory::center_of_mass(double t, const Bodies& of, Side side) const {
    const SystemReport system = system_at(t, side, Asked::motion);
    return SystemPart(system, of).center_of_mass();
}

RBDYN_INLINE Vector3 Trajectory::center_of_mass_velocity(double t, const Bodies& of, Side side) const {
    const SystemReport system = system_at(t, side, Asked::motion);
    return SystemPart(system, of).center_of_mass_velocity();
}

RBDYN_INLINE Vector3 Trajectory::center_of_mass_acceleration(double t, const Bodies& of, Side side) const {
    const SystemReport system = system_at(t, side, Asked::forces);
    return SystemPart(system, of).center_of_mass_acceleration();
}

RBDYN_INLINE Vector3 Trajectory::external_force(double t, const Bodies& of, Side side) const {
    const SystemReport system = system_at(t, side, Asked::forces);
    return SystemPart(system, of).external_force();
}

RBDYN_INLINE Vector3 Trajectory::external_moment(double t, const Pole& pole, const Bodies& of, Side side) const {
    const SystemReport system = system_at(t, side, Asked::forces);
    return SystemPart(system, of).external_moment(pole.at(t, system).place);
}

RBDYN_INLINE std::pair<Vector3, Vector3> Trajectory::cardinal_residuals(double t, const Pole& pole, const Bodies& of,
                                                                        Side side) const {
    const SystemReport system = system_at(t, side, Asked::forces);
    return SystemPart(system, of).cardinal_residuals(pole.at(t, system));
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
    return now(t, side,
               [&](const Observe& observe) { return observed(given.function, observe, "watch " + given.name); });
}

RBDYN_INLINE const Scene::AppliedLoad& Trajectory::applied(LoadHandle load) const {
    const auto& loads = data_->scene.loads();
    require(load.index >= 0 && load.index < static_cast<int>(loads.size()), "Trajectory", "load", load.index,
            "a handle comes from the scene of this run");
    return loads[static_cast<std::size_t>(load.index)];
}

RBDYN_INLINE std::optional<double> Trajectory::potential_of(const Scene::AppliedLoad& load, const BodyReport& body) {
    const auto place = [&] { return load.at ? body.place(*load.at) : body.position; };
    if (const Force* f = std::get_if<Force>(&load.load); f != nullptr && f->is_constant() && f->frame() == Frame::world)
        return f->constant().dot(place());
    if (const Potential* u = std::get_if<Potential>(&load.load)) return u->value<double>(place());
    if (const TorsionSpring* s = std::get_if<TorsionSpring>(&load.load)) {
        const double turned = body.coordinate - s->rest_angle;
        return -0.5 * s->stiffness * turned * turned;
    }
    return std::nullopt;
}

RBDYN_INLINE double Trajectory::potential_of(const CouplingReport& coupling, int index) const {
    const auto k = static_cast<std::size_t>(index);
    const Coupling& given = data_->scene.connections()[k].coupling;
    const auto mass = [&](int body) {
        return body >= 0 ? data_->scene.bodies()[static_cast<std::size_t>(body)].mass() : 0.0;
    };
    const double reference = std::holds_alternative<Central>(given) ? start_lengths()[k] : 0.0;
    return rbdyn::potential_of(given, coupling.length(), reference, mass(coupling.a) * mass(coupling.b)).value_or(0.0);
}

RBDYN_INLINE const std::vector<double>& Trajectory::start_lengths() const {
    std::call_once(start_lengths_->known, [&] {
        std::vector<double>& lengths = start_lengths_->values;
        lengths.resize(data_->scene.connections().size());
        const auto of = [&](const RunData& run) {
            const SceneModel& model = *run.model;
            return model.system_report(model.undecided(), run.origin, model.start(run.origin), Asked::motion);
        };
        std::vector<SystemReport> parts;
        if (data_->parts.empty()) parts.push_back(of(*data_));
        for (const RunData& part : data_->parts) parts.push_back(of(part));
        for (std::size_t k = 0; k < lengths.size(); ++k) {
            const auto [part, own] =
                data_->parts.empty() ? SceneParts::Place{0, static_cast<int>(k)} : data_->plan.apart->couplings[k];
            if (part >= 0)
                lengths[k] = parts[static_cast<std::size_t>(part)].couplings[static_cast<std::size_t>(own)].length();
        }
    });
    return start_lengths_->values;
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
    const auto body = [&](int index, double t, Side side) {
        return system_at(t, side, Asked::motion).bodies[static_cast<std::size_t>(index)];
    };
    const auto potential_gain = [&](const Scene::AppliedLoad& of, double from, double to) {
        return working::gain(*run, from, to,
                             [&](double t, Side side) { return *potential_of(of, body(of.body, t, side)); });
    };
    const TorsionSpring* spring = std::get_if<TorsionSpring>(&given.load);
    const bool is_damped = spring != nullptr && spring->damping != 0.0;
    return work_between(t0, t1, [&](double from, double to) {
        if (!is_damped && potential_of(given, body(given.body, from, Side::after)))
            return potential_gain(given, from, to);
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
        if (keeps_energy(given))
            return working::gain(*run, from, to, [&](double t, Side side) {
                const SystemReport system = system_at(t, side, Asked::motion);
                return potential_of(system.couplings[static_cast<std::size_t>(coupling.index)], coupling.index);
            });
        return working::integral(run->record, from, to, [&](double t) { return power(t, coupling); });
    });
}

RBDYN_INLINE double Trajectory::observed(const WatchFunction& function, const Observe& observe,
                                         const std::string& user) const {
    // what is recorded was looked at when it was given
    return function(function.is_recorded() ? observe : data_->scene.checked(observe, user));
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
            const CouplingMotion idle(run, index);
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
    const CouplingMotion spring = (*this)[coupling];
    return spring.force(t, side).dot(spring.relative(t, side).second);
}

RBDYN_INLINE double Trajectory::integral(const std::string& name, double t, Side side) const {
    return integral_of(name, system_at(t, side, Asked::motion), t, side).first;
}

RBDYN_INLINE std::pair<double, double> Trajectory::integral_of(const std::string& name, const SystemReport& system,
                                                               double t, Side side) const {
    const SystemPart all(system);
    if (name == "energy") {
        const double kinetic = all.kinetic_energy(), potential = potential_in(system, {});
        return {kinetic - potential, kinetic + std::abs(potential)};
    }
    if (name.starts_with("momentum ")) return {all.momentum()[name.back() - 'x'], all.size_of_momentum()};
    const Plan& p = data_->plan;
    if (name.find("angular momentum") != std::string::npos) {
        const Vector3 k = all.angular_momentum(p.pole);
        const double size = all.size_of_angular_momentum(p.pole);
        if (name == "angular momentum") return {k.norm(), size};
        if (name.starts_with("axial")) return {k.dot(p.axis), size};
        return {name.starts_with("vertical") ? k.dot(p.up) : k[name.back() - 'x'], size};
    }
    const auto alone = [](double value) { return std::pair{value, std::abs(value)}; };
    if ((name == "spin" || name == "Kovalevskaya") && data_->parts.empty()) {
        const std::vector<double> x = Moment(*data_, t, side).x;
        return alone(name == "spin" ? planning::spin(*data_->model, x)
                                    : planning::kovalevskaya(*data_->model, x, data_->scene.gravity().norm(), p.up));
    }
    for (const auto& i : data_->scene.integrals())
        if (i.name == name)
            return alone(now(
                t, side, [&](const Observe& observe) { return observed(i.function, observe, "integral " + i.name); }));
    throw InvalidInput("Trajectory: no first integral is named \"" + name + "\" in this scene");
}

RBDYN_INLINE std::map<std::string, double> Trajectory::drift() const {
    std::vector<double> times = t();
    // a closed form has no pieces to look between
    const auto is_closed = [](const RunData& run) { return run.record.closed != nullptr; };
    if ((is_closed(*data_) || std::any_of(data_->parts.begin(), data_->parts.end(), is_closed)) &&
        times.size() < closed_times)
        for (int i = 0; i <= closed_times; ++i) times.push_back(start() + (end() - start()) * i / closed_times);
    const std::vector<std::string>& names = data_->plan.integrals;
    if (names.empty()) return {};
    const auto is_vector = [](const std::string& name) { return name == "angular momentum"; };
    const Vector3& pole = data_->plan.pole;
    const SystemReport begin = system_at(start(), Side::after, Asked::motion);
    const Vector3 vector = SystemPart(begin).angular_momentum(pole);
    std::vector<double> first, largest(names.size()), scale(names.size());
    for (const std::string& name : names) first.push_back(integral_of(name, begin, start(), Side::after).first);
    for (const double time : times) {
        Interruption::point();
        const SystemReport system = system_at(time, Side::after, Asked::motion);
        for (std::size_t k = 0; k < names.size(); ++k) {
            const auto [value, size] = integral_of(names[k], system, time, Side::after);
            largest[k] =
                std::max(largest[k], is_vector(names[k]) ? (SystemPart(system).angular_momentum(pole) - vector).norm()
                                                         : std::abs(value - first[k]));
            scale[k] = std::max(scale[k], size);
        }
    }
    std::map<std::string, double> result;
    for (std::size_t k = 0; k < names.size(); ++k) result[names[k]] = scale[k] > 0.0 ? largest[k] / scale[k] : 0.0;
    return result;
}

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const Trajectory& run) {
    out << "Run: " << name_of(run.status()) << " at t = " << text(run.end()) << " s. " << advice(run.status()) << '\n';
    const auto& s = run.statistics();
    out << "  engine " << run.engine() << ", " << s.steps << " steps, " << run.events().size() << " events, ";
    out << error_in_words(run);
    std::ostringstream seconds;
    seconds << std::setprecision(3) << s.seconds * 1e3;
    return out << ", " << seconds.str() << " ms\n";
}

}  // namespace rbdyn::inline RBDYN_FORM
