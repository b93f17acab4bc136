// A scene: what there is, as plain data. No numerics here; everything is checked on entry.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/body/particle.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/watch.hpp"

namespace rbdyn {

class Scene {
public:
    struct Body {
        Particle particle;
        std::variant<Free, Rail> joint;
        Vector3 position, velocity;  // a free body's start
        double parameter = 0.0;      // a bead's start
        double speed = 0.0;
        std::string name;

        const Rail* rail() const { return std::get_if<Rail>(&joint); }
        bool operator==(const Body&) const = default;
    };
    struct AppliedLoad {
        Load load;
        int body;
        bool operator==(const AppliedLoad&) const = default;
    };
    struct Connection {
        Coupling coupling;
        End a, b;
        bool operator==(const Connection&) const = default;
    };
    struct Watch {
        std::string name;
        WatchFunction function;
        WatchOptions options;
        bool operator==(const Watch& other) const {
            return name == other.name && function == other.function && options.direction == other.options.direction &&
                   options.action.kind == other.options.action.kind && !options.action.change &&
                   !other.options.action.change;
        }
    };
    struct Integral {
        std::string name;
        WatchFunction function;
        bool operator==(const Integral&) const = default;
    };

    Scene() = default;
    explicit Scene(const Vector3& gravity) { set_gravity(gravity); }

    /// Uniform field [m/s^2], world axes; none by default.
    void set_gravity(const Vector3& g) {
        for (int i = 0; i < 3; ++i)
            require(std::isfinite(g[i]), "Scene", "component " + std::to_string(i) + " of gravity", g[i],
                    "the field is finite; give it in m/s^2");
        gravity_ = g;
    }
    const Vector3& gravity() const { return gravity_; }

    BodyHandle add(const Particle& particle, const Free&, const FreeStart& start = {}, std::string name = {}) {
        particle.validate();
        name = named(std::move(name), "particle");
        for (int i = 0; i < 3; ++i) {
            require(std::isfinite(start.position[i]), name, "component " + std::to_string(i) + " of position",
                    start.position[i], "a position is finite; give it in m");
            require(std::isfinite(start.velocity[i]), name, "component " + std::to_string(i) + " of velocity",
                    start.velocity[i], "a velocity is finite; give it in m/s");
        }
        bodies_.push_back({particle, Free{}, start.position, start.velocity, 0.0, 0.0, std::move(name)});
        return {static_cast<int>(bodies_.size()) - 1};
    }
    BodyHandle add(const Particle& particle, const FreeStart& start = {}, std::string name = {}) {
        return add(particle, Free{}, start, std::move(name));
    }

    BodyHandle add(const Particle& particle, const Rail& rail, const RailStart& start = {}, std::string name = {}) {
        particle.validate();
        name = named(std::move(name), "bead");
        const Curve& curve = rail.curve();
        if (start.parameter && start.arc_length)
            throw InvalidInput(name + ": both parameter " + text(*start.parameter) + " and arc_length " +
                               text(*start.arc_length) + " are given; one of them says where it starts");
        double u = start.parameter.value_or(0.0);
        if (start.arc_length) {
            require(std::isfinite(*start.arc_length), name, "arc_length", *start.arc_length, "it is finite, in m");
            u = curve.parameter_at(arc_length_origin(curve), *start.arc_length);
        }
        require(std::isfinite(u), name, "parameter", u, "a start is a finite parameter of the curve");
        const Domain domain = curve.domain();
        require(u >= domain.begin && u <= domain.end, name, "parameter", u,
                "a start lies in the domain of its curve, " + text(domain.begin) + " to " + text(domain.end));
        require(std::isfinite(start.speed), name, "speed", start.speed, "a speed is finite; give it in m/s");
        curve.require_regular(u);
        bodies_.push_back({particle, rail, Vector3::Zero(), Vector3::Zero(), u, start.speed, std::move(name)});
        return {static_cast<int>(bodies_.size()) - 1};
    }

    LoadHandle apply(Load load, BodyHandle body) {
        require_body(body, "apply");
        if (const Drag* drag = std::get_if<Drag>(&load)) drag->validate();
        if (const Lorentz* lorentz = std::get_if<Lorentz>(&load)) lorentz->validate();
        loads_.push_back({std::move(load), body.index});
        return {static_cast<int>(loads_.size()) - 1};
    }

    CouplingHandle connect(Coupling coupling, End a, End b) {
        for (const End* end : {&a, &b}) {
            if (const BodyHandle* body = std::get_if<BodyHandle>(end)) require_body(*body, "connect");
            if (const Vector3* point = std::get_if<Vector3>(end))
                for (int i = 0; i < 3; ++i)
                    require(std::isfinite((*point)[i]), "connect", "component " + std::to_string(i) + " of a point",
                            (*point)[i], "a point of the world is finite, in m");
        }
        if (std::holds_alternative<Vector3>(a) && std::holds_alternative<Vector3>(b))
            throw InvalidInput("connect: both ends are points of the world; at least one is a body");
        if (a == b) throw InvalidInput("connect: both ends are the same body; a coupling joins two points");
        std::visit([](const auto& c) { c.validate(); }, coupling);
        connections_.push_back({std::move(coupling), std::move(a), std::move(b)});
        return {static_cast<int>(connections_.size()) - 1};
    }

    /// A function of the motion whose zeros are events: noted, or acted upon. Its name must be its own.
    WatchHandle watch(std::string name, WatchFunction function, WatchOptions options = {}) {
        if (name.empty()) throw InvalidInput("watch: name is empty; events are found by the name of their watch");
        for (const Watch& w : watches_)
            if (w.name == name) throw InvalidInput("watch: there is one named \"" + name + "\" already; names differ");
        require_observables(function, "watch " + name);
        watches_.push_back({std::move(name), std::move(function), std::move(options)});
        return {static_cast<int>(watches_.size()) - 1};
    }
    /// A function of the motion that should stay what it is: its drift is watched like that of the other integrals.
    void integral(std::string name, WatchFunction function) {
        if (name.empty()) throw InvalidInput("integral: name is empty; its drift is found by its name");
        for (const Integral& i : integrals_)
            if (i.name == name)
                throw InvalidInput("integral: there is one named \"" + name + "\" already; names differ");
        require_observables(function, "integral " + name);
        integrals_.push_back({std::move(name), std::move(function)});
    }

    /// The scene with the numbers of the user's (Parameter) as they are now: what a run is made of.
    Scene frozen() const {
        Scene result = *this;
        for (Body& b : result.bodies_)
            if (const Rail* rail = b.rail()) b.joint = rail->frozen();
        for (AppliedLoad& l : result.loads_) {
            if (const Force* force = std::get_if<Force>(&l.load)) l.load = force->frozen();
            if (const Potential* potential = std::get_if<Potential>(&l.load)) l.load = potential->frozen();
        }
        for (Watch& w : result.watches_) w.function = w.function.frozen();
        for (Integral& i : result.integrals_) i.function = i.function.frozen();
        return result;
    }

    bool operator==(const Scene&) const = default;

    const std::vector<Body>& bodies() const { return bodies_; }
    const std::vector<AppliedLoad>& loads() const { return loads_; }
    const std::vector<Connection>& connections() const { return connections_; }
    const std::vector<Watch>& watches() const { return watches_; }
    const std::vector<Integral>& integrals() const { return integrals_; }

    /// Throws InvalidInput unless the scene has what is asked for.
    void require_observable(const Observable& o, const std::string& user) const {
        if (o.quantity == Quantity::time) return;
        const bool of_coupling = o.quantity == Quantity::length || o.quantity == Quantity::coupling_force;
        const auto count = static_cast<int>(of_coupling ? connections_.size() : bodies_.size());
        require(o.subject >= 0 && o.subject < count, user, "handle", o.subject,
                "it asks for what this scene has, by handles that add() or connect() returned");
        const bool on_rail = of_coupling || bodies_[static_cast<std::size_t>(o.subject)].rail() != nullptr;
        const bool of_rail = o.quantity == Quantity::reaction || o.quantity == Quantity::parameter ||
                             o.quantity == Quantity::speed || o.quantity == Quantity::tangential_force;
        if (of_rail && !on_rail)
            throw InvalidInput(user + ": " + bodies_[static_cast<std::size_t>(o.subject)].name +
                               " is free, and only a body on a rail has a parameter, a speed along it and a reaction");
    }

private:
    void require_observables(const WatchFunction& function, const std::string& user) const {
        for (const Observable& o : function.arguments()) require_observable(o, user);
    }
    void require_body(BodyHandle body, const std::string& verb) const {
        require(body.index >= 0 && body.index < static_cast<int>(bodies_.size()), verb, "body", body.index,
                "a handle comes from add() of the same scene, which has " + std::to_string(bodies_.size()) + " bodies");
    }
    std::string named(std::string name, const std::string& kind) const {
        return name.empty() ? kind + " " + std::to_string(bodies_.size() + 1) : name;
    }

    Vector3 gravity_ = Vector3::Zero();
    std::vector<Body> bodies_;
    std::vector<AppliedLoad> loads_;
    std::vector<Connection> connections_;
    std::vector<Watch> watches_;
    std::vector<Integral> integrals_;
};

}  // namespace rbdyn
