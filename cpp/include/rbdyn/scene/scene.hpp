// A scene: what there is, as plain data. No numerics here; everything is checked on entry.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/body/particle.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"

namespace rbdyn {

/// A body of a scene, by order of addition.
struct BodyHandle {
    int index = -1;
    bool operator==(const BodyHandle&) const = default;
};
/// A load of a scene, by order of application.
struct LoadHandle {
    int index = -1;
    bool operator==(const LoadHandle&) const = default;
};
/// A coupling of a scene, by order of connection.
struct CouplingHandle {
    int index = -1;
    bool operator==(const CouplingHandle&) const = default;
};

/// An end of a coupling: a body, or a point of the world.
using End = std::variant<BodyHandle, Vector3>;

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
    };
    struct AppliedLoad {
        Load load;
        int body;
    };
    struct Connection {
        Coupling coupling;
        End a, b;
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

    const std::vector<Body>& bodies() const { return bodies_; }
    const std::vector<AppliedLoad>& loads() const { return loads_; }
    const std::vector<Connection>& connections() const { return connections_; }

private:
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
};

}  // namespace rbdyn
