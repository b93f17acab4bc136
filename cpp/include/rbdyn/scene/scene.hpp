// A scene: what there is, as plain data. No numerics here; everything is checked on entry.
#pragma once

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/shared.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/particle.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/scene/constraints.hpp"
#include "rbdyn/scene/contacts.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/plan_slot.hpp"
#include "rbdyn/scene/starts.hpp"
#include "rbdyn/scene/watch.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Scene {
public:
    struct Body : Started {
        std::variant<Particle, RigidBody> body;
        Joint joint = Free{};
        int parent = -1;  // the body it is joined to; -1: the ground
        std::string name;

        const Rail* rail() const { return std::get_if<Rail>(&joint); }
        const RigidBody* rigid() const { return std::get_if<RigidBody>(&body); }
        double mass() const { return rigid() != nullptr ? rigid()->mass() : double{std::get<Particle>(body).mass}; }
        bool operator==(const Body&) const = default;
    };
    struct AppliedLoad {
        Load load;
        int body;
        std::optional<Vector3> at = std::nullopt;  // a rigid body's point, body axes; else its centre of mass
        bool operator==(const AppliedLoad&) const = default;
    };
    struct Connection {
        Coupling coupling;
        End a, b;
        bool operator==(const Connection&) const = default;
    };
    struct Held {
        Constraint constraint;
        End a, b;
        std::string name;
        bool operator==(const Held&) const = default;
    };
    struct Touch {
        ContactPart a;
        ContactSurface b;
        ContactOptions options;
        std::string name;
        bool is_gone = false;  // taken away: it keeps its place and never closes
        bool operator==(const Touch&) const = default;
    };
    struct Watch {
        std::string name;
        WatchFunction function;
        WatchOptions options;
        bool operator==(const Watch& other) const;
    };
    struct Integral {
        std::string name;
        WatchFunction function;
        bool operator==(const Integral&) const = default;
    };

    Scene() = default;
    explicit Scene(const Vector3& gravity) { set_gravity(gravity); }

    /// Uniform field [m/s^2], world axes; none by default.
    void set_gravity(const Vector3& g);
    const Vector3& gravity() const { return gravity_; }

    BodyHandle add(const Particle& particle, const Free&, const FreeStart& start = {}, std::string name = {});
    BodyHandle add(const Particle& particle, const FreeStart& start = {}, std::string name = {});

    BodyHandle add(const Particle& particle, const Rail& rail, const RailStart& start = {}, std::string name = {});

    BodyHandle add(const RigidBody& body, const Free&, const BodyStart& start = {}, std::string name = {});
    BodyHandle add(const RigidBody& body, const BodyStart& start = {}, std::string name = {});
    BodyHandle add(const RigidBody& body, const Spherical& joint, const SphericalStart& start = {},
                   std::string name = {});
    BodyHandle add(const RigidBody& body, const Revolute& joint, const RevoluteStart& start = {},
                   std::string name = {});
    BodyHandle add(const RigidBody& body, const Prismatic& joint, const PrismaticStart& start = {},
                   std::string name = {});

    BodyHandle add(const RigidBody& body, const Universal& joint, const UniversalStart& start = {},
                   std::string name = {});
    BodyHandle add(const RigidBody& body, const Cylindrical& joint, const CylindricalStart& start = {},
                   std::string name = {});
    BodyHandle add(const RigidBody& body, const Planar& joint, const PlanarStart& start = {}, std::string name = {});
    BodyHandle add(const RigidBody& body, const Fixed& joint, const FixedStart& start = {}, std::string name = {});

    /// Lets the motion of a body start elsewhere: the words of add(), all of them; those not given are zero, as there.
    /// Throws what add() throws, and InvalidInput for the words of another joint.
    void replace(BodyHandle body, const Start& start);
    /// Where the motion of a body starts, in the words of its joint, in doubles; bodies() has it in all its digits.
    Start start(BodyHandle body) const;

    /// The start of a body that turns freely, in 32 digits: what another scene has of it.
    void start_turning(BodyHandle body, const Attitude& attitude, const Vector3Of<DoubleDouble>& angular_velocity,
                       const std::optional<Vector3>& angular_velocity_world = std::nullopt);

    /// What the parameter that a bead starts at is short of 32 digits: what another scene has of it.
    void start_beyond(BodyHandle body, double rest);

    /// A load on a body. `at`: the point of a rigid body where a force acts, body axes [m]; else its centre of mass.
    LoadHandle apply(Load load, BodyHandle body, std::optional<Vector3> at = std::nullopt);

    CouplingHandle connect(Coupling coupling, End a, End b);

    /// Holds a to b beside their joints. `b`: none is the world: its origin and axes for planes and curves, else the
    /// place where a starts. Starts that do not satisfy it are moved to the nearest that do if they are within 1e-6 of
    /// the scene's size, else a run is refused; assemble() finds some from rough guesses.
    ConstraintHandle constrain(Constraint constraint, End a, std::optional<End> b = std::nullopt,
                               std::string name = {});

    /// Solves the start for all constraints from the guesses given, coordinates, then rates; those of the bodies in
    /// `keep` are left as they are. Returns how far it moved, the largest change of a coordinate. Throws InvalidInput,
    /// with the gaps left, where there is no way.
    /// Driven joints and rails that move are where they are at the time `start`.
    double assemble(const std::vector<BodyHandle>& keep = {}, double start = 0.0);

    /// Lets a part of a body touch a surface: it does not go beyond it. A start may be open, closed and at rest, or
    /// closed and moving: a gap within 1e-12 of the size of what it joins is none. Deeper is refused when a run starts.
    ContactHandle contact(ContactPart a, ContactSurface b, ContactOptions options = {}, std::string name = {});

    /// A function of the motion whose zeros are events: noted, or acted upon. Its name must be its own.
    WatchHandle watch(std::string name, WatchFunction function, WatchOptions options = {});
    /// What is done where a watched function passes zero, anew.
    void act(WatchHandle watch, WatchAction action);
    /// A function of the motion that should stay what it is: its drift is watched like that of the other integrals.
    void integral(std::string name, WatchFunction function);

    /// The scene with the numbers of the user's (Parameter) as they are now: what a run is made of.
    [[gnu::cold]] Scene frozen() const;

    /// The time at which joints and rails that move by functions of time are where this scene starts: 0 for the user's
    /// own, else when a run that is made of it starts.
    double origin() const { return origin_; }
    /// The same scene, to start at another time if that matters to it.
    Scene begun_at(double time) &&;

    /// The same scene without some effects, loads or couplings (scene/effects.hpp). What is taken away keeps its place
    /// and does nothing, so all handles stay good. Throws InvalidInput for what the scene does not have.
    Scene without(const std::vector<Removable>& parts) const;
    template <class... Parts>
    requires(std::is_constructible_v<Removable, const Parts&>&&...) Scene without(const Parts&... parts)
    const { return without(std::vector<Removable>{Removable(parts)...}); }

    bool operator==(const Scene&) const = default;

    const std::vector<Body>& bodies() const { return *bodies_; }
    /// The body of a name. Throws InvalidInput, with the names there are, for any other.
    BodyHandle body(const std::string& name) const;
    const std::vector<AppliedLoad>& loads() const { return loads_; }
    const std::vector<Connection>& connections() const { return *connections_; }
    const std::vector<Held>& constraints() const { return constraints_; }
    const std::vector<Touch>& contacts() const { return contacts_; }
    const std::vector<Watch>& watches() const { return watches_; }
    const std::vector<Integral>& integrals() const { return integrals_; }
    /// The plan that was made of it as it is, if any.
    const PlanSlot& kept_plan() const { return plan_; }

    /// Throws InvalidInput unless the scene has what is asked for.
    void require_observable(const Observable& o, const std::string& user) const;
    /// The same each time something is asked for. The scene outlives it.
    Observe checked(Observe observe, const std::string& user) const;

private:
    friend struct SceneParts;

    // a moment of inertia that is this small beside the others is rounding
    static constexpr double least_moment = 1e-15;

    static Rail without(const Rail& rail, const std::string& name, const std::vector<std::string>& gone);
    void hold_attitudes();
    BodyHandle add(const Started& start, std::variant<Particle, RigidBody> body, Joint joint, BodyHandle parent,
                   const std::string& name);
    /// The parent that a start gives: the ground, or a body of this scene.
    int parent_of(BodyHandle parent, const std::string& name) const;
    void require_end(const End& end, const std::string& verb) const;
    /// A body turns freely about a point only if no moment there vanishes.
    static void require_turnable(const RigidBody& body, const Vector3& point, const std::string& name);
    static void require_fitting(const Load& load, const Body& body, const std::optional<Vector3>& at);
    void require_observables(const WatchFunction& function, const std::string& user) const;
    void require_action(const WatchAction& action, const std::string& user) const;
    void require_body(BodyHandle body, const std::string& verb) const;
    template <class Things>
    static bool has(const Things& things, const std::string& name) {
        return std::any_of(things.begin(), things.end(), [&](const auto& thing) { return thing.name == name; });
    }
    /// Results are found by names: of bodies, watches, constraints and contacts no two are alike.
    bool is_taken(const std::string& name) const;
    void require_new_name(const std::string& name, const std::string& verb) const;
    /// The name of a new body: its own, for results are found by it.
    std::string named(std::string name, const std::string& kind) const;

    Vector3 gravity_ = Vector3::Zero();
    double origin_ = 0.0;
    // of many bodies copies are made by each run
    Shared<std::vector<Body>> bodies_;
    Shared<std::set<std::string>> body_names_;  // of those that were added
    std::vector<AppliedLoad> loads_;
    Shared<std::vector<Connection>> connections_;
    std::vector<Held> constraints_;
    std::vector<Touch> contacts_;
    std::vector<Watch> watches_;
    std::vector<Integral> integrals_;
    PlanSlot plan_;
};

}  // namespace rbdyn::inline RBDYN_FORM
