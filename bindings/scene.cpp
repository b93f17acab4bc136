// The scene and its handles.
#include <algorithm>
#include <utility>
#include <variant>

#include "data.hpp"
#include "files.hpp"
#include "starts.hpp"
#include "watch.hpp"

namespace binding {

using rbdyn::Ball, rbdyn::Hinge, rbdyn::PointOnCurve, rbdyn::PointOnPlane, rbdyn::Rod, rbdyn::Weld, rbdyn::Cylindrical,
    rbdyn::Fixed, rbdyn::Planar, rbdyn::Universal, rbdyn::BodyStart, rbdyn::DoubleDouble, rbdyn::Free, rbdyn::FreeStart,
    rbdyn::Joint, rbdyn::Particle, rbdyn::Prismatic, rbdyn::Rail, rbdyn::RailStart, rbdyn::Revolute, rbdyn::RigidBody,
    rbdyn::Scene, rbdyn::Spherical;

namespace {

/// Adds a body with a start in the words of its joint.
rbdyn::BodyHandle add_started(Scene& scene, const AnyBody& body, const Joint& joint, const rbdyn::Start& start,
                              rbdyn::BodyHandle parent, const std::string& name) {
    return std::visit(
        [&](const auto& b, const auto& j, auto s) -> rbdyn::BodyHandle {
            if constexpr (requires { scene.add(b, j, s, name); }) {
                s.parent = parent;
                return scene.add(b, j, s, name);
            } else {
                throw rbdyn::Error("a start that is none of its joint's");
            }
        },
        body, joint, start);
}

BodyHandle add(BoundScene& self, const AnyBody& body, const Joint& joint, const std::optional<BodyHandle>& parent,
               const std::optional<std::string>& name, const py::kwargs& given) {
    if (name && name->empty()) throw InvalidInput("Scene.add: name is empty; give a name, or none");
    const std::string called = name.value_or("");
    if (has_coupling_named(self, called))
        throw InvalidInput("Scene.add: there is a coupling named \"" + called + "\" already; names differ");
    const auto start = start_of(body, joint, {given, called.empty() ? "Scene.add" : called, "Scene.add"});
    if (!start)
        throw InvalidInput(std::holds_alternative<Particle>(body)
                               ? "Scene.add: a Particle has no attitude, and its joints are Free and Rail; this "
                                 "one is for a RigidBody. A bob on a thread, of the world or of a body that moves, is "
                                 "a Particle and a Rod: constrain(Rod(length), bob, point)"
                               : "Scene.add: a Rail guides a Particle; a RigidBody has the joints Free, "
                                 "Spherical, Revolute, Prismatic, Universal, Cylindrical, Planar and Fixed");
    const auto joined = parent ? self.handles.body(*parent, "Scene.add") : rbdyn::BodyHandle{};
    const auto added = add_started(self.scene, body, joint, *start, joined, called);
    const std::string& known = self.scene.bodies()[static_cast<std::size_t>(added.index)].name;
    return self.handles.bodies.emplace_back(BodyHandle{new_handle(Handle::Of::body, added.index, known)});
}

rbdyn::End end_of(const BoundScene& self, const py::object& end, const char* which,
                  const char* verb = "Scene.connect") {
    if (py::isinstance<Handle>(end)) return self.handles.body(end.cast<const Handle&>(), verb);
    if (py::isinstance<BodyPoint>(end)) {
        const auto& point = end.cast<const BodyPoint&>();
        return self.handles.body(point.body, verb).point(point.point);
    }
    return vector3(end, verb, which);
}

// the first of them can be made from nothing, as Python's arguments must
using AnyCoupling = std::variant<rbdyn::Spring, rbdyn::Gravitation, rbdyn::Central, rbdyn::PairForce>;

CouplingHandle connect(BoundScene& self, const AnyCoupling& given, const ArrayLike& a, const ArrayLike& b) {
    const rbdyn::Coupling coupling = given;
    const auto added = self.scene.connect(coupling, end_of(self, a, "a"), end_of(self, b, "b"));
    return add_coupling(self, added.index);
}

using AnyConstraint = std::variant<Ball, Rod, Weld, Hinge, PointOnPlane, PointOnCurve, Universal>;

ConstraintHandle constrain(BoundScene& self, const AnyConstraint& constraint, const ArrayLike& a,
                           const std::optional<ArrayLike>& b, const std::optional<std::string>& name) {
    const auto end = b ? std::optional(end_of(self, *b, "b", "Scene.constrain")) : std::nullopt;
    const auto added = std::visit(
        [&](const auto& c) {
            return self.scene.constrain(c, end_of(self, a, "a", "Scene.constrain"), end, name.value_or(""));
        },
        constraint);
    const std::string& known = self.scene.constraints()[static_cast<std::size_t>(added.index)].name;
    return self.handles.constraints.emplace_back(
        ConstraintHandle{new_handle(Handle::Of::constraint, added.index, known)});
}

using AnyPart = std::variant<BodyHandle, BodyPoint, BodyShape>;
// a handle alone is none: it is told what is
using AnySurface = std::variant<rbdyn::Plane, rbdyn::Sphere, BodyShape, BodyHandle, BodyPoint>;

rbdyn::ContactPart part_of(const BoundScene& self, const AnyPart& part) {
    const char* verb = "Scene.contact";
    if (const BodyHandle* body = std::get_if<BodyHandle>(&part)) return self.handles.body(*body, verb);
    if (const BodyPoint* point = std::get_if<BodyPoint>(&part))
        return self.handles.body(point->body, verb).point(point->point);
    const BodyShape& shape = std::get<BodyShape>(part);
    const int index = self.handles.body(shape.body, verb).index;
    return std::visit(
        [&](auto s) -> rbdyn::ContactPart {
            if constexpr (std::is_same_v<decltype(s), rbdyn::BodyPlane>) {
                throw InvalidInput(
                    "Scene.contact: a is a plane; give a point or a round part as a, and the plane as b");
            } else {
                s.body = index;
                return s;
            }
        },
        shape.shape);
}
rbdyn::ContactSurface surface_of(const BoundScene& self, const AnySurface& surface) {
    if (const auto* plane = std::get_if<rbdyn::Plane>(&surface)) return *plane;
    if (const auto* sphere = std::get_if<rbdyn::Sphere>(&surface)) return *sphere;
    const BodyHandle* body = std::get_if<BodyHandle>(&surface);
    if (const BodyPoint* point = std::get_if<BodyPoint>(&surface)) body = &point->body;
    if (body != nullptr)
        throw InvalidInput("Scene.contact: b is " + body->name +
                           " or a point of it, which has no surface; b is a Plane, a "
                           "Sphere, or handle.plane(...) or handle.sphere(...) of a body");
    const BodyShape& shape = std::get<BodyShape>(surface);
    const int index = self.handles.body(shape.body, "Scene.contact").index;
    if (auto plane = std::get_if<rbdyn::BodyPlane>(&shape.shape)) return rbdyn::BodyPlane{index, plane->plane};
    if (auto ball = std::get_if<rbdyn::BodySphere>(&shape.shape))
        return rbdyn::BodySphere{index, ball->radius, ball->center};
    throw InvalidInput("Scene.contact: b is a disc or an ellipsoid; it is a plane or a sphere, and those are a");
}

/// A shape of a body as data, and from it: the handle, which shape it is, its sizes, place and axes.
py::tuple parts_of_shape(const BodyShape& shape) {
    const auto kind = py::int_(shape.shape.index());
    if (const auto* s = std::get_if<rbdyn::BodySphere>(&shape.shape))
        return py::make_tuple(shape.body, kind, s->radius, tuple_of(s->center));
    if (const auto* d = std::get_if<rbdyn::BodyDisc>(&shape.shape))
        return py::make_tuple(shape.body, kind, d->radius, tuple_of(d->normal), tuple_of(d->center));
    if (const auto* p = std::get_if<rbdyn::BodyPlane>(&shape.shape))
        return py::make_tuple(shape.body, kind, tuple_of(p->plane.normal), tuple_of(p->plane.point));
    const auto& e = std::get<rbdyn::BodyEllipsoid>(shape.shape);
    const auto& q = e.attitude.exact();
    return py::make_tuple(shape.body, kind, tuple_of(e.semi_axes), tuple_of(e.center),
                          py::make_tuple(q.w.hi, q.w.lo, q.x.hi, q.x.lo, q.y.hi, q.y.lo, q.z.hi, q.z.lo));
}
BodyShape shape_from(const py::tuple& d) {
    const auto body = d[0].cast<BodyHandle>();
    const auto kind = d[1].cast<std::size_t>();
    if (kind == 0) return {body, rbdyn::BodySphere{-1, d[2].cast<double>(), vector_from(d[3])}};
    if (kind == 1) return {body, rbdyn::BodyDisc{-1, d[2].cast<double>(), vector_from(d[3]), vector_from(d[4])}};
    if (kind == 3) return {body, rbdyn::BodyPlane{-1, {vector_from(d[2]), vector_from(d[3])}}};
    const auto q = d[4].cast<std::array<double, 8>>();
    const rbdyn::QuaternionOf<DoubleDouble> attitude{DoubleDouble(q[0], q[1]), DoubleDouble(q[2], q[3]),
                                                     DoubleDouble(q[4], q[5]), DoubleDouble(q[6], q[7])};
    return {body, rbdyn::BodyEllipsoid{-1, vector_from(d[2]), vector_from(d[3]), attitude}};
}

ContactHandle contact(BoundScene& self, const AnyPart& a, const AnySurface& b,
                      const std::optional<rbdyn::Coulomb>& friction, double restitution,
                      const std::optional<std::string>& name) {
    const auto added = self.scene.contact(part_of(self, a), surface_of(self, b),
                                          {.friction = friction, .restitution = restitution}, name.value_or(""));
    const std::string& known = self.scene.contacts()[static_cast<std::size_t>(added.index)].name;
    return self.handles.contacts.emplace_back(ContactHandle{new_handle(Handle::Of::contact, added.index, known)});
}

double assemble(BoundScene& self, const std::vector<BodyHandle>& keep, double start) {
    std::vector<rbdyn::BodyHandle> kept;
    for (const BodyHandle& h : keep) kept.push_back(self.handles.body(h, "Scene.assemble"));
    // a copy, since other threads may read and change the scene meanwhile; what ends it leaves the scene as it was
    const rbdyn::Scene before = self.scene;
    rbdyn::Scene assembled = before;
    const double moved = unlocked([&] { return assembled.assemble(kept, start); });
    if (!(self.scene == before))
        throw InvalidInput("Scene.assemble: another thread has changed the scene meanwhile; assemble it again");
    self.scene = std::move(assembled);
    return moved;
}

// the first of them can be made from nothing, as Python's arguments must
using AnyLoad = std::variant<rbdyn::Drag, rbdyn::Force, rbdyn::Lorentz, rbdyn::Potential, rbdyn::Torque,
                             rbdyn::TorsionSpring, rbdyn::JointTorque, rbdyn::JointForce>;

rbdyn::Load load_from(const AnyLoad& load) {
    return std::visit([](const auto& l) { return rbdyn::Load(l); }, load);
}

LoadHandle apply(BoundScene& self, const AnyLoad& load, const Handle& handle, const std::optional<ArrayLike>& at) {
    const rbdyn::BodyHandle body = self.handles.body(handle, "Scene.apply");
    const auto place = at ? std::optional(vector3(*at, "Scene.apply", "at")) : std::nullopt;
    const auto added = self.scene.apply(load_from(load), body, place);
    return add_load(self, added.index);
}

WatchHandle watch(BoundScene& self, const std::string& name, const py::object& function, const std::string& direction,
                  const ActionName& action, std::optional<bool> trace) {
    rbdyn::WatchOptions options;
    options.direction = one_of(direction, directions, "Scene.watch", "direction");
    options.action = action_of(action, self, name);
    const auto added =
        self.scene.watch(name, watched_function(function, self, trace, "watch \"" + name + "\""), options);
    return self.handles.watches.emplace_back(WatchHandle{new_handle(Handle::Of::watch, added.index, name)});
}

BoundScene without(const BoundScene& self, const py::args& what) {
    std::vector<rbdyn::Removable> parts;
    for (const py::handle part : what) {
        if (py::isinstance<LoadHandle>(part) || py::isinstance<CouplingHandle>(part) ||
            py::isinstance<ContactHandle>(part)) {
            const auto& handle = part.cast<const Handle&>();
            self.handles.require(handle, "Scene.without");
            if (handle.of == Handle::Of::load)
                parts.emplace_back(rbdyn::LoadHandle{handle.index});
            else if (handle.of == Handle::Of::contact)
                parts.emplace_back(rbdyn::ContactHandle{handle.index});
            else
                parts.emplace_back(rbdyn::CouplingHandle{handle.index});
        } else if (py::isinstance<py::str>(part)) {
            parts.emplace_back(part.cast<std::string>());
        } else {
            throw InvalidInput("Scene.without: " + shown(part) +
                               " is neither the name of an effect nor the handle of a load, coupling or contact");
        }
    }
    return {self.scene.without(parts), self.handles};
}

}  // namespace

void bind_scene(py::module_& m) {
    py::class_<Handle>(m, "Handle", R"(What a scene returns for a body, a load or a coupling it has taken.

Good for its scene, for copies of that scene and for their runs; equal only to itself.)")
        .def_readonly("name", &Handle::name, "Of what it stands for.")
        .def("__eq__", [](const Handle& a,
                          const py::object& b) { return py::isinstance<Handle>(b) && a == b.cast<const Handle&>(); })
        .def("__hash__", [](const Handle& h) { return h.id; })
        .def("__copy__", [](const py::object& self) { return self; })
        .def(
            "__deepcopy__", [](const py::object& self, const py::dict&) { return self; }, py::arg("memo"))
        .def("__repr__", [](const Handle& h) { return "<Handle: " + h.name + ">"; });
    const auto pickled = [](auto& type, auto of) {
        using H = typename std::decay_t<decltype(type)>::type;
        type.def(py::pickle([](const H& h) { return py::make_tuple(h.index, h.id, h.name); },
                            [of](const py::tuple& d) {
                                return H{{of, d[0].cast<int>(), d[1].cast<std::uint64_t>(), d[2].cast<std::string>()}};
                            }));
    };

    py::class_<BodyHandle, Handle> body(m, "BodyHandle", "The handle of a body; run[handle] is a BodyMotion.");
    py::class_<BodyPoint> point(m, "BodyPoint", "A point of a rigid body: an end of a coupling.");
    point.def_readonly("body", &BodyPoint::body, "The handle of its body.")
        .def_property_readonly(
            "point", [](const BodyPoint& p) { return to_python(p.point); }, "In body axes (3,) [m].")
        .def("__repr__",
             [](const BodyPoint& p) { return "<BodyPoint: " + p.body.name + " at " + list_text(p.point) + ">"; });
    as_data(
        point, [](const BodyPoint& p) { return py::make_tuple(p.body, tuple_of(p.point)); },
        [](const py::tuple& d) {
            return BodyPoint{d[0].cast<BodyHandle>(), vector_from(d[1])};
        });
    body.def(
        "point",
        [](const BodyHandle& h, const ArrayLike& place) {
            return BodyPoint{h, vector3(place, h.name, "point")};
        },
        py::arg("place"), "The point of the body at a place (3,) from the origin of its axes, body axes [m].");
    py::class_<LoadHandle, Handle> load(m, "LoadHandle", "The handle of a load.");
    py::class_<CouplingHandle, Handle> coupling(m, "CouplingHandle",
                                                "The handle of a coupling; run[handle] is a CouplingMotion.");
    py::class_<WatchHandle, Handle> watched(m, "WatchHandle",
                                            "The handle of a watched function; run[handle] is a Watched.");
    pickled(body, Handle::Of::body);
    pickled(load, Handle::Of::load);
    pickled(coupling, Handle::Of::coupling);
    pickled(watched, Handle::Of::watch);
    py::class_<ConstraintHandle, Handle> constraint(m, "ConstraintHandle",
                                                    "The handle of a constraint; run[handle] is a ConstraintMotion.");
    pickled(constraint, Handle::Of::constraint);
    py::class_<ContactHandle, Handle> touching(m, "ContactHandle",
                                               "The handle of a contact; run[handle] is a ContactMotion.");
    pickled(touching, Handle::Of::contact);
    py::class_<BodyShape> shape(m, "BodyShape", "A part of a body that touches, or a surface of it.");
    as_data(shape, parts_of_shape, shape_from);
    shape.def_readonly("body", &BodyShape::body, "The handle of its body.").def("__repr__", [](const BodyShape& s) {
        const char* kinds[] = {"sphere", "disc", "ellipsoid", "plane"};
        return "<BodyShape: " + std::string(kinds[s.shape.index()]) + " of " + s.body.name + ">";
    });
    const std::vector<double> middle = {0.0, 0.0, 0.0};
    body.def(
            "sphere",
            [](const BodyHandle& h, double radius, const ArrayLike& center) {
                return BodyShape{h, rbdyn::BodySphere{-1, radius, vector3(center, h.name, "center")}};
            },
            py::arg("radius"), py::arg("center") = middle,
            "A sphere of the body: radius [m], center (3,) in body axes [m].")
        .def(
            "disc",
            [](const BodyHandle& h, double radius, const ArrayLike& normal, const ArrayLike& center) {
                return BodyShape{h, rbdyn::BodyDisc{-1, radius, vector3(normal, h.name, "normal"),
                                                    vector3(center, h.name, "center")}};
            },
            py::arg("radius"), py::arg("normal"), py::arg("center") = middle,
            "A disc of the body without thickness: radius [m], normal (3,) and center (3,) [m] in body axes.")
        .def(
            "ellipsoid",
            [](const BodyHandle& h, const ArrayLike& semi_axes, const ArrayLike& center,
               const std::optional<AttitudeLike>& attitude) {
                return BodyShape{h, rbdyn::BodyEllipsoid{
                                        -1, vector3(semi_axes, h.name, "semi_axes"), vector3(center, h.name, "center"),
                                        attitude ? binding::attitude(*attitude, h.name) : rbdyn::Attitude()}};
            },
            py::arg("semi_axes"), py::arg("center") = middle, py::arg("attitude") = py::none(),
            "An ellipsoid of the body: semi_axes (3,) [m], center (3,) [m] in body axes, attitude of its axes in the "
            "body.")
        .def(
            "plane",
            [](const BodyHandle& h, const ArrayLike& normal, const ArrayLike& place) {
                return BodyShape{
                    h, rbdyn::BodyPlane{-1, {vector3(normal, h.name, "normal"), vector3(place, h.name, "point")}}};
            },
            py::arg("normal"), py::arg("point") = middle,
            "A plane of the body: normal (3,), point (3,) [m], body axes.");

    py::class_<BoundScene>(m, "Scene",
                           R"(What there is, as data: bodies with their joints, loads, couplings, a uniform field.

Everything is checked on entry. A run copies its scene; later changes do not touch that run.)")
        .def(py::init([](const std::optional<ArrayLike>& gravity) {
                 if (!gravity) return BoundScene{};
                 return BoundScene{Scene(vector3(*gravity, "Scene", "gravity")), {}};
             }),
             py::arg("gravity") = py::none(), "gravity: uniform field (3,) [m/s^2], world axes; none by default.")
        .def_property(
            "gravity", [](const BoundScene& s) { return py::array_t<double>(3, s.scene.gravity().data()); },
            [](BoundScene& s, const ArrayLike& gravity) { s.scene.set_gravity(vector3(gravity, "Scene", "gravity")); },
            "Uniform field (3,) [m/s^2], world axes. Assign a whole vector to change it.")
        .def_property_readonly(
            "bodies", [](const BoundScene& s) { return s.handles.bodies; },
            "Handles of the bodies, in order of addition.")
        .def_property_readonly(
            "loads", [](const BoundScene& s) { return s.handles.loads; }, "Handles of the loads, in order of addition.")
        .def_property_readonly(
            "couplings", [](const BoundScene& s) { return s.handles.couplings; },
            "Handles of the couplings, in order of addition.")
        .def("add", &add, py::arg("body"), py::arg_v("joint", Joint(Free{}), "Free()"), py::kw_only(),
             py::arg("parent") = py::none(), py::arg("name") = py::none(),
             R"(Adds a body with the joint to its parent, and its initial state in the joint's words.

parent: the handle of a rigid body, or the ground. With a parent, `at`, axes and curves of the joint are in its axes, and
the initial state is relative to it; at coordinates zero the axes of both coincide.

A Particle, Free(): position, velocity (3,) [m], [m/s], world axes. Rail(): parameter or arc_length [m], one of them, and
speed = ds/dt [m/s].

A RigidBody, Free(): position, velocity of the origin of its axes, attitude, and angular_velocity (3,) [rad/s] in body
axes or angular_velocity_world. Spherical(): attitude, angular_velocity or angular_velocity_world. Revolute(): angle
[rad], rate [rad/s]. Prismatic(): displacement [m], rate [m/s]. Universal(): angles (2,), rates (2,). Cylindrical(): angle,
rate, displacement, displacement_rate. Planar(): position (2,), velocity (2,), angle, rate. Fixed(): nothing. An attitude is a quaternion (w, x, y, z), a rotation
matrix (3, 3), EulerAngles or a SciPy Rotation.

Zero by default, body axes along the world's. Returns a handle. Raises InvalidInput for numbers that break a rule and for
a joint that cannot hold the body, TypeError for another keyword.)")
        .def(
            "connect", &connect, py::arg("coupling"), py::arg("a"), py::arg("b"),
            R"(Joins two ends by a Spring, a Gravitation, a Central or a PairForce: handles of bodies (of a rigid body its centre of mass), points of bodies, handle.point([x, y, z]),
or one of them a point of the world (3,) [m]. Returns a handle.)")
        .def(
            "constrain", &constrain, py::arg("constraint"), py::arg("a"), py::arg("b") = py::none(), py::kw_only(),
            py::arg("name") = py::none(),
            R"(Holds a to b beside their joints: closes a loop, holds a point. Ends as in connect(); axes, planes and curves are in
the axes of b. Without b: the world, and of two points that coincide the place where a starts. Returns a handle.

A start that does not satisfy it is moved to the nearest that does if it is within 1e-6 of the scene's size, else a run is
refused; assemble() finds one from rough guesses.)")
        .def(
            "assemble", &assemble, py::arg("keep") = std::vector<BodyHandle>{}, py::kw_only(), py::arg("start") = 0.0,
            R"(Solves the start for all constraints from the guesses given, coordinates, then rates; those of the bodies in keep stay
as they are. start [s]: when a run is to start, which is where driven joints and rails that move are. Returns the largest
change of a coordinate. Raises InvalidInput, with the gaps left, where there is no way.)")
        .def("contact", &contact, py::arg("a"), py::arg("b"), py::kw_only(), py::arg("friction") = py::none(),
             py::arg("restitution") = 0.0, py::arg("name") = py::none(),
             R"(Lets a touch b: it does not go beyond it. Returns a handle.

a: a particle, a point of a body, or handle.sphere(), .disc(), .ellipsoid(); b: a Plane or a Sphere of the world, or
handle.plane(), handle.sphere() of another body. restitution: Newton's, 0 to 1: what is left of the speed of approach.
friction: Coulomb(...); none: it is smooth.

A start may be open, closed and at rest, or closed and moving; a gap within 1e-12 of the size of what it joins is none.
run[handle] has gap, force, slip and state; events of kind land, impact, detach, accumulation name it.)")
        .def(
            "replace",
            [](BoundScene& self, const Handle& handle, const py::kwargs& initial) {
                const rbdyn::BodyHandle moved = self.handles.body(handle, "Scene.replace");
                restart(self.scene, moved, {initial, handle.name, "Scene.replace"});
            },
            py::arg("handle"),
            R"(Lets the motion of a body start elsewhere, in the words of add(). What is not given stays as it is, an angular
velocity in the axes it was given in. Raises what add() raises.)")
        .def(
            "__getitem__",
            [](const BoundScene& self, const std::string& name) { return self.handles.find(name, "Scene"); },
            py::arg("name"),
            "The handle of a name: of a body, a coupling, a watch, a constraint, a contact or a load. Raises "
            "InvalidInput, "
            "with the names there are, for any other.")
        .def_property_readonly(
            "contacts", [](const BoundScene& s) { return s.handles.contacts; },
            "Handles of the contacts, in order of addition.")
        .def_property_readonly(
            "constraints", [](const BoundScene& s) { return s.handles.constraints; },
            "Handles of the constraints, in order of addition.")
        .def(
            "apply", &apply, py::arg("load"), py::arg("handle"), py::arg("at") = py::none(),
            R"(Applies a load to a body. at (3,): the point of a rigid body where it acts, body axes [m]; by default the centre
of mass. Returns a handle.)")
        .def("watch", &watch, py::arg("name"), py::arg("function"), py::kw_only(), py::arg("direction") = "either",
             py::arg("action") = "record", py::arg("trace") = py::none(),
             R"(Watches a function of the motion: where it passes zero is an event of kind "watch". Returns a handle.

function: function(now) -> number, with now.time [s] and now[handle].quantity for the quantities of BodyNow and, of a
coupling, length and force. It is recorded, so that its zeros are found on its Taylor series, each one; what cannot be recorded is called back
with numbers, and its zeros are located but not certain (trace as for Force).

direction: "rising", "falling" or "either". action: "record" it, "stop" the run there, or a function of now (numbers) that
changes the state: it returns {handle: {"velocity": ...}}, in the joint's own words as add() takes them.

run[handle].value(t) is its value. Raises InvalidInput for a name that is taken, or a quantity that is not there.)")
        .def(
            "integral",
            [](BoundScene& self, const std::string& name, const py::object& function) {
                self.scene.integral(name, watched_function(function, self, true, "integral \"" + name + "\""));
            },
            py::arg("name"), py::arg("function"),
            R"(A first integral of one's own: function(now) as for watch(). run.drift[name] says how far it departs from its value
at the start, relative to its largest size.)")
        .def(
            "without", &without,
            R"(The same scene without some of what acts in it: names of effects, handles of loads, couplings and contacts.

Several at once:

    scene.without("drag", "static friction", spring)

What is taken away keeps its place and does nothing, so every handle is good for the new scene and its runs. The effects:
gravity, rotation, spring, damper, drag, gravitation, central force, user force, user torque, drive, moving rail, dynamic
friction, static friction, contact, impact. "static friction" beside dynamic friction is what it has more than that.
Without "rotation" a free body is a particle at its centre of mass. Without "impact" nothing bounces: restitution goes.

Raises InvalidInput for a name that is none, and for an effect that the scene does not have or cannot be without.)")
        .def("__eq__",
             [](const BoundScene& a, const py::object& b) {
                 return py::isinstance<BoundScene>(b) && a.scene == b.cast<const BoundScene&>().scene;
             })
        .def_property_readonly("handles", &handles_by_name,
                               "All handles of the scene by their names: bodies, loads, couplings, constraints, "
                               "contacts and watches.")
        .def_property_readonly("parameters", &parameters_of,
                               "The numbers by reference that it uses: each Parameter once.")
        .def(py::pickle(&scene_state, &scene_from_state))
        .def("__copy__", [](const BoundScene& s) { return BoundScene(s); })
        .def(
            "__deepcopy__", [](const BoundScene& s, const py::dict&) { return BoundScene(s); }, py::arg("memo"))
        .def("__repr__", [](const BoundScene& s) {
            const auto count = [](std::size_t n, const char* one, const char* several) {
                return std::to_string(n) + " " + (n == 1 ? one : several);
            };
            return "<Scene: gravity " + list_text(s.scene.gravity()) + ", " +
                   count(s.handles.bodies.size(), "body", "bodies") + ", " +
                   count(s.handles.loads.size(), "load", "loads") + ", " +
                   count(s.handles.couplings.size(), "coupling", "couplings") +
                   (s.handles.watches.empty() ? "" : ", " + count(s.handles.watches.size(), "watch", "watches")) + ">";
        });
}

}  // namespace binding
