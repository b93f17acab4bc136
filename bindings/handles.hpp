// Handles: what a scene gives back for a thing it has taken, and what a run is asked with.
//
// Every handle has a number of its own in this process. A scene keeps those of what it holds, and so do its copies and
// its runs: a handle is good for each of them, and for no other scene.
#pragma once

#include <memory>
#include <optional>
#include <rbdyn/scene/scene.hpp>
#include <string>
#include <unordered_set>
#include <variant>
#include <vector>

#include "binding.hpp"

namespace binding {

struct Handle {
    enum class Of { body, load, coupling, watch, constraint, contact } of = Of::body;
    int index = -1;
    std::uint64_t id = 0;
    std::string name;

    bool operator==(const Handle& other) const { return id == other.id; }
};

// one Python class for each, so that type checkers know what run[handle] is
struct BodyHandle : Handle {};
struct LoadHandle : Handle {};
struct CouplingHandle : Handle {};
struct WatchHandle : Handle {};
struct ConstraintHandle : Handle {};
struct ContactHandle : Handle {};

/// A point of a body, in body axes.
struct BodyPoint {
    BodyHandle body;
    Vector3 point;
    bool operator==(const BodyPoint& other) const { return body.id == other.body.id && point == other.point; }
};

/// A part of a body that touches, or a surface of it, in body axes.
struct BodyShape {
    using Shape = std::variant<rbdyn::BodySphere, rbdyn::BodyDisc, rbdyn::BodyEllipsoid, rbdyn::BodyPlane>;

    BodyHandle body;
    Shape shape;
    bool operator==(const BodyShape& other) const { return body.id == other.body.id && shape == other.shape; }
};

/// The handles of a scene, by order of addition.
struct Handles {
    std::vector<BodyHandle> bodies;
    std::vector<LoadHandle> loads;
    std::vector<CouplingHandle> couplings;
    std::vector<WatchHandle> watches;
    std::vector<ConstraintHandle> constraints = {};
    std::vector<ContactHandle> contacts = {};
    // names that a coupling cannot be given: of couplings, and of as many bodies as were looked at
    std::unordered_set<std::string> taken = {};
    std::size_t looked_at = 0;

    bool has(const Handle& h) const {
        const auto among = [&](const auto& known) {
            const auto index = static_cast<std::size_t>(h.index);
            return h.index >= 0 && index < known.size() && known[index] == h;
        };
        switch (h.of) {
            case Handle::Of::body: return among(bodies);
            case Handle::Of::load: return among(loads);
            case Handle::Of::coupling: return among(couplings);
            case Handle::Of::constraint: return among(constraints);
            case Handle::Of::contact: return among(contacts);
            default: return among(watches);
        }
    }
    /// Throws InvalidInput for a handle of another scene.
    void require(const Handle& h, const std::string& user) const {
        if (!has(h))
            throw InvalidInput(user + ": \"" + h.name +
                               "\" is a handle of another scene; use what add(), connect(), constrain(), contact(), "
                               "apply() or watch() of this one returned");
    }
    /// The handle of a name, as the Python object of its class. Throws InvalidInput, with the names there are, for any
    /// other.
    py::object find(const std::string& name, const std::string& user) const {
        std::string names;
        py::object found;
        const auto look = [&](const auto& known) {
            for (const auto& h : known) {
                if (h.name == name && !found) found = py::cast(h);
                names += (names.empty() ? "\"" : ", \"") + h.name + "\"";
            }
        };
        look(bodies);
        look(couplings);
        look(constraints);
        look(contacts);
        look(watches);
        look(loads);
        if (found) return found;
        throw InvalidInput(user + ": there is nothing named \"" + name + "\"; " +
                           (names.empty() ? "the scene is empty: add() something" : "there are " + names));
    }
    /// The body of a handle. Throws InvalidInput for any other handle.
    rbdyn::BodyHandle body(const Handle& h, const std::string& user) const {
        require(h, user);
        if (h.of != Handle::Of::body)
            throw InvalidInput(user + ": \"" + h.name + "\" is not a body; use the handle that add() returned");
        return {h.index};
    }
};

/// A scene with its handles.
struct BoundScene {
    rbdyn::Scene scene;
    Handles handles;
};

}  // namespace binding
