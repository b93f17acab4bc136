// The scene and its handles.
#include <algorithm>
#include <atomic>
#include <random>
#include <utility>
#include <variant>

#include "data.hpp"
#include "watch.hpp"

namespace binding {

using rbdyn::Ball, rbdyn::Hinge, rbdyn::PointOnPlane, rbdyn::Rod, rbdyn::Weld, rbdyn::Cylindrical, rbdyn::Fixed,
    rbdyn::Planar, rbdyn::Universal, rbdyn::BodyStart, rbdyn::DoubleDouble, rbdyn::Free, rbdyn::FreeStart, rbdyn::Joint,
    rbdyn::Particle, rbdyn::Prismatic, rbdyn::Rail, rbdyn::RailStart, rbdyn::Revolute, rbdyn::RigidBody, rbdyn::Scene,
    rbdyn::Spherical;

namespace {

Handle new_handle(Handle::Of of, int index, std::string name) {
    // from a start of its own in every process, so that handles of unpickled scenes meet no others
    static std::atomic<std::uint64_t> last{[] {
        std::random_device device;
        return (static_cast<std::uint64_t>(device()) << 32) ^ device();
    }()};
    return {of, index, ++last, std::move(name)};
}

/// The initial state of a body, read keyword by keyword.
class Initial {
public:
    Initial(const py::kwargs& given, std::string object) : given_(given), object_(std::move(object)) {}

    /// Throws TypeError for a keyword that is not among `allowed`.
    void require_keywords(const std::vector<std::string>& allowed, const std::string& who) const {
        for (const auto& item : given_) {
            const auto key = item.first.cast<std::string>();
            if (std::find(allowed.begin(), allowed.end(), key) != allowed.end()) continue;
            std::string list;
            for (const std::string& a : allowed) list += (list.empty() ? "" : ", ") + a;
            throw py::type_error("Scene.add: unexpected keyword \"" + key + "\"; " + who + " starts with " + list);
        }
    }
    std::optional<double> number(const char* key) const {
        if (!has(key)) return std::nullopt;
        return binding::number(given_[key], object_, key);
    }
    std::optional<Vector3> vector(const char* key) const {
        if (!has(key)) return std::nullopt;
        return vector3(given_[key], object_, key);
    }
    std::array<double, 2> pair(const char* key) const {
        if (!has(key)) return {0.0, 0.0};
        const std::vector<double> values = list_of_doubles(given_[key], object_, key);
        if (values.size() != 2)
            throw InvalidInput(object_ + ": " + key + " has " + std::to_string(values.size()) +
                               " numbers; it is two, as in [0.5, 0]");
        return {values[0], values[1]};
    }
    rbdyn::Attitude attitude() const {
        return has("attitude") ? binding::attitude(given_["attitude"], object_) : rbdyn::Attitude();
    }

private:
    bool has(const char* key) const { return given_.contains(key) && !given_[key].is_none(); }

    const py::kwargs& given_;
    std::string object_;
};

// --- what each pair of body and joint starts with ---

FreeStart start_of(const Particle&, const Free&, const Initial& initial) {
    initial.require_keywords({"position", "velocity"}, "a particle that is free");
    const Vector3 none = Vector3::Zero();
    return {initial.vector("position").value_or(none), initial.vector("velocity").value_or(none)};
}
RailStart start_of(const Particle&, const Rail&, const Initial& initial) {
    initial.require_keywords({"parameter", "arc_length", "speed"}, "a particle on a rail");
    return {initial.number("parameter"), initial.number("arc_length"), initial.number("speed").value_or(0.0)};
}
BodyStart start_of(const RigidBody&, const Free&, const Initial& initial) {
    initial.require_keywords({"position", "velocity", "attitude", "angular_velocity", "angular_velocity_world"},
                             "a body that is free");
    const Vector3 none = Vector3::Zero();
    return {initial.vector("position").value_or(none), initial.vector("velocity").value_or(none), initial.attitude(),
            initial.vector("angular_velocity"), initial.vector("angular_velocity_world")};
}
rbdyn::SphericalStart start_of(const RigidBody&, const Spherical&, const Initial& initial) {
    initial.require_keywords({"attitude", "angular_velocity", "angular_velocity_world"}, "a body on a ball joint");
    return {initial.attitude(), initial.vector("angular_velocity"), initial.vector("angular_velocity_world")};
}
rbdyn::RevoluteStart start_of(const RigidBody&, const Revolute&, const Initial& initial) {
    initial.require_keywords({"angle", "rate"}, "a body on a hinge");
    return {initial.number("angle").value_or(0.0), initial.number("rate").value_or(0.0)};
}
rbdyn::PrismaticStart start_of(const RigidBody&, const Prismatic&, const Initial& initial) {
    initial.require_keywords({"displacement", "rate"}, "a body on a slide");
    return {initial.number("displacement").value_or(0.0), initial.number("rate").value_or(0.0)};
}

rbdyn::UniversalStart start_of(const RigidBody&, const Universal&, const Initial& initial) {
    initial.require_keywords({"angles", "rates"}, "a body on a universal joint");
    return {initial.pair("angles"), initial.pair("rates")};
}
rbdyn::CylindricalStart start_of(const RigidBody&, const Cylindrical&, const Initial& initial) {
    initial.require_keywords({"angle", "rate", "displacement", "displacement_rate"}, "a body on a hinge that slides");
    return {initial.number("angle").value_or(0.0), initial.number("rate").value_or(0.0),
            initial.number("displacement").value_or(0.0), initial.number("displacement_rate").value_or(0.0)};
}
rbdyn::PlanarStart start_of(const RigidBody&, const Planar&, const Initial& initial) {
    initial.require_keywords({"position", "velocity", "angle", "rate"}, "a body in a plane");
    return {initial.pair("position"), initial.pair("velocity"), initial.number("angle").value_or(0.0),
            initial.number("rate").value_or(0.0)};
}
rbdyn::FixedStart start_of(const RigidBody&, const Fixed&, const Initial& initial) {
    initial.require_keywords({}, "a body that is welded");
    return {};
}

using AnyBody = std::variant<Particle, RigidBody>;

bool has_coupling_named(const BoundScene& scene, const std::string& name) {
    const auto& couplings = scene.handles.couplings;
    return std::any_of(couplings.begin(), couplings.end(), [&](const auto& c) { return c.name == name; });
}

BodyHandle add(BoundScene& self, const AnyBody& body, const Joint& joint, const std::optional<BodyHandle>& parent,
               const std::optional<std::string>& name, const py::kwargs& given) {
    if (name && name->empty()) throw InvalidInput("Scene.add: name is empty; give a name, or none");
    const std::string called = name.value_or("");
    if (has_coupling_named(self, called))
        throw InvalidInput("Scene.add: there is a coupling named \"" + called + "\" already; names differ");
    const Initial initial(given, called.empty() ? "Scene.add" : called);
    const auto added = std::visit(
        [&](const auto& b, const auto& j) -> rbdyn::BodyHandle {
            if constexpr (requires { start_of(b, j, initial); }) {
                auto start = start_of(b, j, initial);
                if (parent) start.parent = self.handles.body(*parent, "Scene.add");
                return self.scene.add(b, j, start, called);
            } else {
                throw InvalidInput(
                    std::holds_alternative<Particle>(body)
                        ? "Scene.add: a Particle has no attitude, and its joints are Free and Rail; this "
                          "one is for a RigidBody"
                        : "Scene.add: a Rail guides a Particle; a RigidBody has the joints Free, "
                          "Spherical, Revolute, Prismatic, Universal, Cylindrical, Planar and Fixed");
            }
        },
        body, joint);
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
    const auto& bodies = self.handles.bodies;
    int number = added.index;
    std::string name;
    do name = std::string(kind_of(coupling)) + " " + std::to_string(++number);
    while (has_coupling_named(self, name) ||
           std::any_of(bodies.begin(), bodies.end(), [&](const auto& body) { return body.name == name; }));
    return self.handles.couplings.emplace_back(CouplingHandle{new_handle(Handle::Of::coupling, added.index, name)});
}

using AnyConstraint = std::variant<Ball, Rod, Weld, Hinge, PointOnPlane, Universal>;

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

double assemble(BoundScene& self, const std::vector<BodyHandle>& keep) {
    std::vector<rbdyn::BodyHandle> kept;
    for (const BodyHandle& h : keep) kept.push_back(self.handles.body(h, "Scene.assemble"));
    return self.scene.assemble(kept);
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
    const char* kinds[] = {"drag ",   "force ",          "Lorentz force ", "potential ",
                           "torque ", "torsion spring ", "joint torque ",  "joint force "};
    return self.handles.loads.emplace_back(
        LoadHandle{new_handle(Handle::Of::load, added.index, kinds[load.index()] + std::to_string(added.index + 1))});
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
        if (py::isinstance<LoadHandle>(part) || py::isinstance<CouplingHandle>(part)) {
            const auto& handle = part.cast<const Handle&>();
            self.handles.require(handle, "Scene.without");
            if (handle.of == Handle::Of::load)
                parts.emplace_back(rbdyn::LoadHandle{handle.index});
            else
                parts.emplace_back(rbdyn::CouplingHandle{handle.index});
        } else if (py::isinstance<py::str>(part)) {
            parts.emplace_back(part.cast<std::string>());
        } else {
            throw InvalidInput("Scene.without: " + shown(part) +
                               " is neither the name of an effect nor the handle of a load or coupling");
        }
    }
    return {self.scene.without(parts), self.handles};
}

/// Handles as data: what they are of is where they stand.
template <class H>
py::list data_of(const std::vector<H>& handles) {
    py::list result;
    for (const H& h : handles) result.append(py::make_tuple(h.id, h.name));
    return result;
}
template <class H>
std::vector<H> handles_from(const py::handle& data, Handle::Of of) {
    std::vector<H> result;
    for (const py::handle item : data) {
        const auto pair = item.cast<std::pair<std::uint64_t, std::string>>();
        result.push_back(H{{of, static_cast<int>(result.size()), pair.first, pair.second}});
    }
    return result;
}

/// Numbers of 32 digits, each as two doubles.
py::list digits(std::initializer_list<DoubleDouble> numbers) {
    py::list result;
    for (const DoubleDouble& x : numbers) result.append(py::make_tuple(x.hi, x.lo));
    return result;
}
template <std::size_t n>
std::array<DoubleDouble, n> digits_from(const py::handle& data) {
    std::array<DoubleDouble, n> result;
    const auto pairs = data.cast<std::array<std::pair<double, double>, n>>();
    for (std::size_t i = 0; i < n; ++i) result[i] = {pairs[i].first, pairs[i].second};
    return result;
}

/// An attitude by the angles it was given by, if it was, else by its quaternion.
py::object attitude_data(const rbdyn::Attitude& attitude) {
    if (attitude.given_angles()) return py::cast(*attitude.given_angles());
    const auto& q = attitude.exact();
    return digits({q.w, q.x, q.y, q.z});
}
rbdyn::Attitude attitude_from(const py::handle& data) {
    if (py::isinstance<rbdyn::EulerAngles>(data)) return data.cast<rbdyn::EulerAngles>();
    const auto q = digits_from<4>(data);
    return rbdyn::QuaternionOf<DoubleDouble>{q[0], q[1], q[2], q[3]};
}

/// Parts and surfaces of contacts, as data and back.
py::tuple side_data(const rbdyn::ContactPart& part) {
    if (const auto* body = std::get_if<rbdyn::BodyHandle>(&part)) return py::make_tuple("body", body->index);
    if (const auto* p = std::get_if<rbdyn::BodyPoint>(&part))
        return py::make_tuple("point", p->body, tuple_of(p->point));
    if (const auto* s = std::get_if<rbdyn::BodySphere>(&part))
        return py::make_tuple("sphere", s->body, s->radius, tuple_of(s->center));
    if (const auto* d = std::get_if<rbdyn::BodyDisc>(&part))
        return py::make_tuple("disc", d->body, d->radius, tuple_of(d->normal), tuple_of(d->center));
    const auto& e = std::get<rbdyn::BodyEllipsoid>(part);
    return py::make_tuple("ellipsoid", e.body, tuple_of(e.semi_axes), tuple_of(e.center), attitude_data(e.attitude));
}
rbdyn::ContactPart part_from(const py::tuple& d) {
    const auto kind = d[0].cast<std::string>();
    const int body = d[1].cast<int>();
    if (kind == "body") return rbdyn::BodyHandle{body};
    if (kind == "point") return rbdyn::BodyPoint{body, vector_from(d[2])};
    if (kind == "sphere") return rbdyn::BodySphere{body, d[2].cast<double>(), vector_from(d[3])};
    if (kind == "disc") return rbdyn::BodyDisc{body, d[2].cast<double>(), vector_from(d[3]), vector_from(d[4])};
    return rbdyn::BodyEllipsoid{body, vector_from(d[2]), vector_from(d[3]), attitude_from(d[4])};
}
py::tuple side_data(const rbdyn::ContactSurface& surface) {
    if (const auto* p = std::get_if<rbdyn::Plane>(&surface)) return py::make_tuple(-1, *p);
    if (const auto* s = std::get_if<rbdyn::Sphere>(&surface)) return py::make_tuple(-1, *s);
    if (const auto* p = std::get_if<rbdyn::BodyPlane>(&surface)) return py::make_tuple(p->body, p->plane);
    const auto& s = std::get<rbdyn::BodySphere>(surface);
    return py::make_tuple(s.body, rbdyn::Sphere{s.center, s.radius});
}
rbdyn::ContactSurface surface_from(const py::tuple& d) {
    const int body = d[0].cast<int>();
    if (py::isinstance<rbdyn::Plane>(d[1])) {
        const auto plane = d[1].cast<rbdyn::Plane>();
        if (body < 0) return plane;
        return rbdyn::BodyPlane{body, plane};
    }
    const auto sphere = d[1].cast<rbdyn::Sphere>();
    if (body < 0) return sphere;
    return rbdyn::BodySphere{body, sphere.radius, sphere.center};
}
py::list contacts_data(const BoundScene& s) {
    py::list contacts;
    for (const auto& c : s.scene.contacts())
        contacts.append(
            py::make_tuple(side_data(c.a), side_data(c.b), c.options.friction, c.options.restitution, c.name));
    return contacts;
}

py::tuple scene_data(const BoundScene& s) {
    py::list bodies, loads, couplings, watches, integrals;
    for (const Scene::Body& b : s.scene.bodies()) {
        const auto& w = b.angular_velocity;
        bodies.append(py::make_tuple(b.body, b.joint, b.name, tuple_of(b.position), tuple_of(b.velocity), b.parameter,
                                     b.speed, attitude_data(b.attitude), digits({w[0], w[1], w[2]}), b.parameter_rest,
                                     b.parent, b.coordinates, b.rates));
    }
    const auto point = [](const std::optional<Vector3>& p) -> py::object {
        return p ? py::object(tuple_of(*p)) : py::none();
    };
    for (const auto& l : s.scene.loads()) loads.append(py::make_tuple(l.load, l.body, point(l.at)));
    const auto end = [](const rbdyn::End& e) {
        const auto* of_body = std::get_if<rbdyn::BodyPoint>(&e);
        const auto* of_world = std::get_if<Vector3>(&e);
        const Vector3* place = of_body != nullptr ? &of_body->point : of_world;
        return py::make_tuple(body_of(e), place != nullptr ? py::object(tuple_of(*place)) : py::none());
    };
    for (const auto& c : s.scene.connections()) couplings.append(py::make_tuple(c.coupling, end(c.a), end(c.b)));
    for (const auto& w : s.scene.watches()) {
        if (w.options.action.change)
            throw py::type_error("Scene: the action of watch \"" + w.name +
                                 "\" is a function of Python's own, and a scene "
                                 "with one cannot be pickled");
        const char* action = w.options.action.kind == rbdyn::WatchAction::Kind::stop ? "stop" : "record";
        watches.append(py::make_tuple(w.name, watch_data(w.function, "watch \"" + w.name + "\""),
                                      word_for(w.options.direction, directions), action));
    }
    for (const auto& i : s.scene.integrals())
        integrals.append(py::make_tuple(i.name, watch_data(i.function, "integral \"" + i.name + "\"")));
    py::list constraints;
    for (const auto& c : s.scene.constraints()) {
        const py::object kind = std::visit(
            [](const auto& one) -> py::object {
                if constexpr (std::is_same_v<std::decay_t<decltype(one)>, rbdyn::PointOnCurve>)
                    return py::none();
                else
                    return py::cast(one);
            },
            c.constraint);
        constraints.append(py::make_tuple(kind, end(c.a), end(c.b), c.name));
    }
    return py::make_tuple(
        to_python(s.scene.gravity()), bodies, loads, couplings, watches, integrals,
        py::make_tuple(data_of(s.handles.bodies), data_of(s.handles.loads), data_of(s.handles.couplings),
                       data_of(s.handles.watches), data_of(s.handles.constraints), data_of(s.handles.contacts)),
        constraints, contacts_data(s));
}

/// Where a body starts as a scene keeps it, in the words of each joint.
struct Started {
    Vector3 position, velocity;
    double parameter, speed;
    std::array<double, 3> coordinates{}, rates{};

    FreeStart as(const Particle&, const Free&) const { return {position, velocity}; }
    RailStart as(const Particle&, const Rail&) const { return {.parameter = parameter, .speed = speed}; }
    BodyStart as(const RigidBody&, const Free&) const { return {position, velocity}; }
    rbdyn::SphericalStart as(const RigidBody&, const Spherical&) const { return {}; }
    rbdyn::RevoluteStart as(const RigidBody&, const Revolute&) const { return {parameter, speed}; }
    rbdyn::PrismaticStart as(const RigidBody&, const Prismatic&) const { return {parameter, speed}; }
    rbdyn::UniversalStart as(const RigidBody&, const Universal&) const {
        return {{coordinates[0], coordinates[1]}, {rates[0], rates[1]}};
    }
    rbdyn::CylindricalStart as(const RigidBody&, const Cylindrical&) const {
        return {coordinates[0], rates[0], coordinates[1], rates[1]};
    }
    rbdyn::PlanarStart as(const RigidBody&, const Planar&) const {
        return {{coordinates[0], coordinates[1]}, {rates[0], rates[1]}, coordinates[2], rates[2]};
    }
    rbdyn::FixedStart as(const RigidBody&, const Fixed&) const { return {}; }
};

BoundScene scene_from(const py::tuple& d) {
    BoundScene s{Scene(vector3(d[0], "Scene", "gravity")), {}};
    for (const py::handle item : d[1]) {
        const auto b = item.cast<py::tuple>();
        Started at{.position = vector_from(b[3]),
                   .velocity = vector_from(b[4]),
                   .parameter = b[5].cast<double>(),
                   .speed = b[6].cast<double>()};
        rbdyn::BodyHandle parent;
        if (b.size() > 10) {
            parent.index = b[10].cast<int>();
            at.coordinates = b[11].cast<std::array<double, 3>>();
            at.rates = b[12].cast<std::array<double, 3>>();
        }
        const auto body = b[0].cast<AnyBody>();
        const auto joint = b[1].cast<Joint>();
        std::visit(
            [&](const auto& one, const auto& held) {
                if constexpr (requires { at.as(one, held); }) {
                    auto start = at.as(one, held);
                    start.parent = parent;
                    s.scene.add(one, held, start, b[2].cast<std::string>());
                }
            },
            body, joint);
        const auto w = digits_from<3>(b[8]);
        const rbdyn::BodyHandle last{static_cast<int>(s.scene.bodies().size()) - 1};
        s.scene.start_turning(last, attitude_from(b[7]), {w[0], w[1], w[2]});
        if (b.size() > 9) s.scene.start_beyond(last, b[9].cast<double>());
    }
    const auto point = [](const py::handle p) { return p.is_none() ? std::nullopt : std::optional(vector_from(p)); };
    for (const py::handle item : d[2]) {
        const auto l = item.cast<py::tuple>();
        s.scene.apply(load_from(l[0].cast<AnyLoad>()), rbdyn::BodyHandle{l[1].cast<int>()}, point(l[2]));
    }
    const auto end = [&](const py::handle data) -> rbdyn::End {
        const auto e = data.cast<py::tuple>();
        const rbdyn::BodyHandle body{e[0].cast<int>()};
        const auto place = point(e[1]);
        if (!place) return body;
        if (body.index < 0) return *place;
        return body.point(*place);
    };
    for (const py::handle item : d[3]) {
        const auto c = item.cast<py::tuple>();
        s.scene.connect(c[0].cast<AnyCoupling>(), end(c[1]), end(c[2]));
    }
    for (const py::handle item : d[4]) {
        const auto w = item.cast<py::tuple>();
        rbdyn::WatchOptions options;
        options.direction = one_of(w[2].cast<std::string>(), directions, "Scene.watch", "direction");
        if (w[3].cast<std::string>() == "stop") options.action.kind = rbdyn::WatchAction::Kind::stop;
        s.scene.watch(w[0].cast<std::string>(), watch_from(w[1]), options);
    }
    for (const py::handle item : d[5]) {
        const auto i = item.cast<py::tuple>();
        s.scene.integral(i[0].cast<std::string>(), watch_from(i[1]));
    }
    if (d.size() > 7)
        for (const py::handle item : d[7]) {
            const auto c = item.cast<py::tuple>();
            const auto kind = c[0].cast<AnyConstraint>();
            std::visit([&](const auto& one) { s.scene.constrain(one, end(c[1]), end(c[2]), c[3].cast<std::string>()); },
                       kind);
        }
    if (d.size() > 8)
        for (const py::handle item : d[8]) {
            const auto c = item.cast<py::tuple>();
            s.scene.contact(
                part_from(c[0]), surface_from(c[1]),
                {.friction = c[2].cast<std::optional<rbdyn::Coulomb>>(), .restitution = c[3].cast<double>()},
                c[4].cast<std::string>());
        }
    const auto handles = d[6].cast<py::tuple>();
    s.handles = {handles_from<BodyHandle>(handles[0], Handle::Of::body),
                 handles_from<LoadHandle>(handles[1], Handle::Of::load),
                 handles_from<CouplingHandle>(handles[2], Handle::Of::coupling),
                 handles_from<WatchHandle>(handles[3], Handle::Of::watch),
                 handles.size() > 4 ? handles_from<ConstraintHandle>(handles[4], Handle::Of::constraint)
                                    : std::vector<ConstraintHandle>(),
                 handles.size() > 5 ? handles_from<ContactHandle>(handles[5], Handle::Of::contact)
                                    : std::vector<ContactHandle>()};
    return s;
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
            "assemble", &assemble, py::arg("keep") = std::vector<BodyHandle>{},
            R"(Solves the start for all constraints from the guesses given, coordinates, then rates; those of the bodies in keep stay
as they are. Returns the largest change of a coordinate. Raises InvalidInput, with the gaps left, where there is no way.)")
        .def("contact", &contact, py::arg("a"), py::arg("b"), py::kw_only(), py::arg("friction") = py::none(),
             py::arg("restitution") = 0.0, py::arg("name") = py::none(),
             R"(Lets a touch b: it does not go beyond it. Returns a handle.

a: a particle, a point of a body, or handle.sphere(), .disc(), .ellipsoid(); b: a Plane or a Sphere of the world, or
handle.plane(), handle.sphere() of another body. restitution: Newton's, 0 to 1: what is left of the speed of approach.
friction: Coulomb(...); none: it is smooth.

A start may be open, closed and at rest, or closed and moving; a gap within 1e-12 of the size of what it joins is none.
run[handle] has gap, force, slip and state; events of kind land, impact, detach, accumulation name it.)")
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
            R"(The same scene without some of what acts in it: names of effects, handles of loads and couplings, several at once.

    scene.without("drag", "static friction", spring)

What is taken away keeps its place and does nothing, so every handle is good for the new scene and its runs. The effects:
gravity, rotation, spring, damper, drag, gravitation, central force, user force, user torque, drive, moving rail, dynamic
friction, static friction, contact, impact. "static friction" beside dynamic friction is what it has more than that.
Without "rotation" a free body is a particle at its centre of mass.

Raises InvalidInput for a name that is none, and for an effect that the scene does not have or cannot be without.)")
        .def("__eq__",
             [](const BoundScene& a, const py::object& b) {
                 return py::isinstance<BoundScene>(b) && a.scene == b.cast<const BoundScene&>().scene;
             })
        .def(py::pickle(&scene_data, &scene_from))
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
