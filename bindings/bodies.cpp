// Rigid bodies and shapes.
#include <rbdyn/body/shapes.hpp>
#include <rbdyn/body/solid.hpp>

#include "binding.hpp"

namespace binding {

using rbdyn::DoubleDouble, rbdyn::Inertia, rbdyn::InertiaAbout, rbdyn::MassProperties, rbdyn::Matrix3;
using rbdyn::RigidBody, rbdyn::text;
namespace shapes = rbdyn::shapes;

namespace {

constexpr const char* body_name = "RigidBody";

const Words<InertiaAbout> poles = {{"com", InertiaAbout::com}, {"origin", InertiaAbout::origin}};

Inertia inertia(const ArrayLike& value) {
    const Array a = doubles(value, body_name, "inertia");
    if (a.ndim() == 1 && a.size() == 3) return {a.at(0), a.at(1), a.at(2)};
    if (a.ndim() == 2 && a.shape(0) == 3 && a.shape(1) == 3)
        return Matrix3(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(a.data()));
    throw InvalidInput("RigidBody: inertia has shape " + shape_of(a) +
                       "; it is three principal moments, or a matrix (3, 3)");
}

/// f about "com", about "origin" or about a point.
template <class F>
auto about(const RigidBody& body, const PoleLike& pole, F&& f) {
    if (!py::isinstance<py::str>(pole)) return f(vector3(pole, body_name, "about"));
    const bool is_com = one_of(plain(pole), poles, body_name, "about") == InertiaAbout::com;
    return f(is_com ? body.com() : Vector3(0, 0, 0));
}

std::string matrix_text(const Matrix3& m) {
    if (Matrix3(m.diagonal().asDiagonal()) == m) return list_text(m.diagonal());
    return "[" + list_text(m.row(0)) + ", " + list_text(m.row(1)) + ", " + list_text(m.row(2)) + "]";
}

std::string repr(const RigidBody& b) {
    std::string result = "RigidBody(mass=" + text(b.mass()) + ", inertia=" + matrix_text(b.given_inertia());
    if (b.com() != Vector3(0, 0, 0)) result += ", com=" + list_text(b.com());
    if (b.inertia_about() == InertiaAbout::origin) result += ", inertia_about=\"origin\"";
    return result + ")";
}

// numbers of 32 digits as Python's tuples hold them
py::tuple body_data(const RigidBody& b) {
    const MassProperties& given = b.given();
    std::vector<double> digits;
    const auto put = [&](const DoubleDouble& x) { digits.insert(digits.end(), {x.hi, x.lo}); };
    put(given.mass);
    for (int i = 0; i < 3; ++i) put(given.com[i]);
    for (int i = 0; i < 9; ++i) put(given.inertia(i / 3, i % 3));
    return py::make_tuple(digits, word_for(b.inertia_about(), poles));
}
RigidBody body_from(const py::tuple& d) {
    const auto digits = d[0].cast<std::vector<double>>();
    std::size_t next = 0;
    const auto take = [&] {
        next += 2;
        return DoubleDouble(digits.at(next - 2), digits.at(next - 1));
    };
    MassProperties given;
    given.mass = take();
    for (int i = 0; i < 3; ++i) given.com[i] = take();
    for (int i = 0; i < 9; ++i) given.inertia(i / 3, i % 3) = take();
    return RigidBody(given, one_of(d[1].cast<std::string>(), poles, body_name, "inertia_about"));
}

/// A range of a coordinate, from two numbers.
shapes::Range range(py::handle value, const char* coordinate) {
    const auto ends = list_of_doubles(value, "solid", std::string("the bounds of ") + coordinate);
    if (ends.size() != 2)
        throw InvalidInput(std::string("solid: bounds of ") + coordinate + " has " + std::to_string(ends.size()) +
                           " numbers; it is two, from and to");
    return {ends[0], ends[1]};
}

shapes::SolidBounds solid_bounds(const py::object& value) {
    const auto bounds = py::reinterpret_steal<py::object>(PySequence_Tuple(value.ptr()));
    if (!bounds || py::len(bounds) != 3) {
        PyErr_Clear();
        throw InvalidInput("solid: bounds is " + shown(value) + "; it is three ranges, of x, y and z");
    }
    const py::object y = bounds[py::int_(1)], z = bounds[py::int_(2)];
    const bool y_depends = PyCallable_Check(y.ptr()) != 0, z_depends = PyCallable_Check(z.ptr()) != 0;
    const shapes::Range y_range = y_depends ? shapes::Range{} : range(y, "y"),
                        z_range = z_depends ? shapes::Range{} : range(z, "z");
    return {range(bounds[py::int_(0)], "x"), [=](double at) { return y_depends ? range(y(at), "y") : y_range; },
            [=](double at_x, double at_y) { return z_depends ? range(z(at_x, at_y), "z") : z_range; }};
}

/// Densities by a function of arrays x, y, z if it takes them, else of three floats.
class PythonDensity {
public:
    explicit PythonDensity(const DensityLike& density)
        : density_(density), is_uniform_(PyCallable_Check(density.ptr()) == 0) {
        if (is_uniform_) uniform_ = number(density, "solid", "density");
    }
    Eigen::ArrayXd operator()(const shapes::Points& p) {
        if (is_uniform_) return Eigen::ArrayXd::Constant(p.cols(), uniform_);
        if (takes_arrays_) {
            try {
                return at_arrays(p);
            } catch (const py::error_already_set& error) {
                // what math.exp of an array, and the truth of one, raise
                if (!error.matches(PyExc_TypeError) && !error.matches(PyExc_ValueError)) throw;
                takes_arrays_ = false;
            }
        }
        Eigen::ArrayXd values(p.cols());
        for (Eigen::Index k = 0; k < p.cols(); ++k)
            values[k] = number(density_(p(0, k), p(1, k), p(2, k)), "solid", "density");
        return values;
    }

private:
    Eigen::ArrayXd at_arrays(const shapes::Points& p) const {
        const auto row = [&](int i) { return py::array_t<double>(p.cols(), p.row(i).data()); };
        const Array values = doubles(density_(row(0), row(1), row(2)), "solid", "density");
        if (values.ndim() == 0) return Eigen::ArrayXd::Constant(p.cols(), *values.data());
        if (values.ndim() != 1 || values.size() != p.cols())
            throw InvalidInput("solid: density has shape " + shape_of(values) + " for arrays of shape (" +
                               std::to_string(p.cols()) + ",); it gives a number for each point");
        return Eigen::Map<const Eigen::ArrayXd>(values.data(), values.size());
    }

    py::object density_;
    bool is_uniform_, takes_arrays_ = true;
    double uniform_ = 0.0;
};

}  // namespace

void bind_bodies(py::module_& m) {
    py::class_<RigidBody>(m, "RigidBody", R"(A rigid body: mass, centre of mass and inertia, in axes fixed in it.

Bodies in the same axes are added where they are welded: a + b. What derives from the numbers given is computed in 32
digits.)")
        .def(
            py::init([](double mass, const ArrayLike& moments, const ArrayLike& com, const std::string& inertia_about) {
                return RigidBody(mass, inertia(moments),
                                 {.com = vector3(com, body_name, "com"),
                                  .inertia_about = one_of(inertia_about, poles, body_name, "inertia_about")});
            }),
            py::arg("mass"), py::arg("inertia"), py::kw_only(),
            py::arg_v("com", ArrayLike(py::make_tuple(0.0, 0.0, 0.0)), "(0, 0, 0)"), py::arg("inertia_about") = "com",
            R"(mass: [kg], positive.

inertia: three principal moments along the body's axes, or the symmetric matrix (3, 3) with elements -Int rho x_i x_j
off its diagonal (eq. 7.33) [kg m^2].

com: the centre of mass in the body's axes [m]. inertia_about: "com", or "origin" of the body's axes.

Raises InvalidInput if no distribution of mass has these properties: a moment below zero, or above the sum of the other
two. Discs, laminae and rods are bodies.)")
        .def_property_readonly("mass", &RigidBody::mass, "[kg]")
        .def_property_readonly(
            "com", [](const RigidBody& b) { return Vectors(to_python(b.com())); },
            "Centre of mass from the body's origin, body axes, (3,) [m].")
        .def_property_readonly(
            "inertia_about", [](const RigidBody& b) { return word_for(b.inertia_about(), poles); },
            R"(What the inertia was given about: "com" or "origin".)")
        .def(
            "inertia",
            [](const RigidBody& b, const PoleLike& pole) {
                return about(b, pole, [&](const Vector3& p) { return to_array(b.inertia(p)); });
            },
            py::arg("about") = "com",
            R"(The matrix of inertia about "com", "origin" or a point (3,) [m]; body axes, (3, 3) [kg m^2].

Huygens-Steiner; elements -Int rho x_i x_j off the diagonal (eq. 7.33).)")
        .def(
            "principal",
            [](const RigidBody& b, const PoleLike& pole) {
                const auto p = about(b, pole, [&](const Vector3& at) { return b.principal(at); });
                return PrincipalObject(
                    py::module_::import("rbdyn.frames").attr("PrincipalAxes")(to_python(p.moments), to_array(p.axes)));
            },
            py::arg("about") = "com",
            R"(Principal moments (3,) [kg m^2] and axes about "com", "origin" or a point [m]: a named tuple.

The columns of axes (3, 3) are unit vectors in body axes, right-handed, each the one nearest to its body axis.)")
        .def("is_gyroscope", &RigidBody::is_gyroscope, py::arg("rtol") = 1e-9,
             "Whether two principal moments about the centre of mass differ by at most rtol, relative (Def. 7.4).")
        .def(
            "gyroscope_axis",
            [](const RigidBody& b, double rtol) {
                const auto axis = b.gyroscope_axis(rtol);
                return axis ? std::optional(Vectors(to_python(*axis))) : std::nullopt;
            },
            py::arg("rtol") = 1e-9,
            "The gyroscopic axis e_3, a unit vector in body axes, or None; the third axis if all moments are equal.")
        .def(
            "imbalance",
            [](const RigidBody& b, const ArrayLike& axis, const ArrayLike& point) {
                const rbdyn::Imbalance i =
                    b.imbalance(vector3(axis, body_name, "axis"), vector3(point, body_name, "point"));
                return ImbalanceObject(
                    py::module_::import("rbdyn.frames").attr("Imbalance")(to_python(i.offset), to_python(i.couple)));
            },
            py::arg("axis"), py::arg("point") = py::make_tuple(0.0, 0.0, 0.0),
            R"(What the body asks of the bearings of an axis, by its motion alone: a named tuple (7.47).

axis: a direction (3,) through a point (3,) [m], fixed in the body, body axes. offset (3,) [kg m]: mass times the way
from the axis to the centre of mass, across it. couple (3,) [kg m^2]: e x I e, with I about the point. Turning at a rate
w the bearings exert the force -w^2 offset and about the point the moment w^2 couple, body axes.)")
        .def(
            "is_balanced",
            [](const RigidBody& b, const ArrayLike& axis, const ArrayLike& point, double rtol) {
                return b.is_balanced(vector3(axis, body_name, "axis"), vector3(point, body_name, "point"), rtol);
            },
            py::arg("axis"), py::arg("point") = py::make_tuple(0.0, 0.0, 0.0), py::arg("rtol") = 1e-9,
            R"(Whether it turns about an axis without load on its bearings: a principal axis about the centre of mass.

axis: a direction (3,) through a point (3,) [m], body axes. rtol: of the moments about the point, and of mass times
radius of gyration.)")
        .def_property_readonly("is_rod", &RigidBody::is_rod,
                               "Whether all mass lies on a line: nothing resists a spin about it.")
        .def(
            "shifted", [](const RigidBody& b, const ArrayLike& r) { return b.shifted(vector3(r, body_name, "r")); },
            py::arg("r"), "Moved by r in its own axes [m]: what was at the origin is at r.")
        .def(
            "rotated",
            [](const RigidBody& b, const AttitudeLike& value) { return b.rotated(attitude(value, body_name)); },
            py::arg("attitude"),
            R"(Turned about the origin of its axes: what lay along v lies along R v.

attitude: a quaternion (w, x, y, z), a matrix (3, 3), EulerAngles or a scipy Rotation.)")
        .def(
            "__add__", [](const RigidBody& a, const RigidBody& b) { return a + b; }, py::is_operator())
        .def("__eq__",
             [](const RigidBody& a, const py::object& b) {
                 return py::isinstance<RigidBody>(b) && a == b.cast<const RigidBody&>();
             })
        .def("__hash__", [](const RigidBody& b) { return py::hash(py::make_tuple(b.mass(), b.com()[0], b.com()[1])); })
        .def(py::pickle(&body_data, &body_from))
        .def("__repr__", &repr);

    m.def(
        "rod",
        [](double mass, double length, const ArrayLike& along) {
            return shapes::rod(mass, length, vector3(along, "rod", "along"));
        },
        py::arg("mass"), py::arg("length"), py::arg("along"),
        "A thin straight rod centred on the origin: m l^2/12 across, 0 along it.");
    m.def(
        "box", [](double mass, const ArrayLike& size) { return shapes::box(mass, vector3(size, "box", "size")); },
        py::arg("mass"), py::arg("size"),
        "A block centred on the origin, its three edges along the body's axes: m (b^2 + c^2)/12 and so on.");
    m.def(
        "disc",
        [](double mass, double radius, const ArrayLike& normal) {
            return shapes::disc(mass, radius, vector3(normal, "disc", "normal"));
        },
        py::arg("mass"), py::arg("radius"), py::arg("normal"),
        "A thin disc centred on the origin: m r^2/2 about its normal, half of it across.");
    m.def(
        "ring",
        [](double mass, double radius, const ArrayLike& normal) {
            return shapes::ring(mass, radius, vector3(normal, "ring", "normal"));
        },
        py::arg("mass"), py::arg("radius"), py::arg("normal"),
        "A thin ring centred on the origin: m r^2 about its normal, half of it across.");
    m.def(
        "cylinder",
        [](double mass, double radius, double height, const ArrayLike& axis) {
            return shapes::cylinder(mass, radius, height, vector3(axis, "cylinder", "axis"));
        },
        py::arg("mass"), py::arg("radius"), py::arg("height"), py::arg("axis"),
        "A solid cylinder centred on the origin: m r^2/2 about its axis, m (3 r^2 + h^2)/12 across.");
    m.def("sphere", &shapes::sphere, py::arg("mass"), py::arg("radius"),
          "A solid ball centred on the origin: 2/5 m r^2.");
    m.def("shell", &shapes::shell, py::arg("mass"), py::arg("radius"),
          "A thin spherical shell centred on the origin: 2/3 m r^2.");
    m.def(
        "cone",
        [](double mass, double radius, double height, const ArrayLike& axis) {
            return shapes::cone(mass, radius, height, vector3(axis, "cone", "axis"));
        },
        py::arg("mass"), py::arg("radius"), py::arg("height"), py::arg("axis"),
        R"(A solid cone with its apex at the origin, axis from there to the middle of its base.

Its centre of mass is at 3/4 of its height; about it 3/10 m r^2 about the axis, 3/80 m (4 r^2 + h^2) across.)");
    m.def(
        "ellipsoid",
        [](double mass, const ArrayLike& semi_axes) {
            return shapes::ellipsoid(mass, vector3(semi_axes, "ellipsoid", "semi_axes"));
        },
        py::arg("mass"), py::arg("semi_axes"),
        "A solid ellipsoid centred on the origin, semi-axes along the body's axes: m (b^2 + c^2)/5 and so on.");
    m.def(
        "points",
        [](const ArrayLike& masses, const ArrayLike& positions) {
            return shapes::points(list_of_doubles(masses, "points", "masses"),
                                  rows(positions, "points", "positions", "a point a row"));
        },
        py::arg("masses"), py::arg("positions"), "Points of mass (n,) [kg] at positions (n, 3) [m], held together.");
    m.def(
        "solid",
        [](const DensityLike& density, const BoundsLike& bounds, double error) {
            return shapes::solid_of_points(PythonDensity(density), solid_bounds(bounds), error);
        },
        py::arg("density"), py::arg("bounds"), py::kw_only(), py::arg("error") = 1e-12,
        R"(A body from its density, by quadrature (as in eqs. 7.28, 7.30b, 7.33 and 7.36).

density: a number, or a function of x, y, z [m] that gives kg/m^3, zero or positive; it is called with arrays, and with
floats if it cannot take arrays.

bounds: three ranges [m], as in [(0, 1), (0, 2), (0, 3)]; that of y may be a function of x, and that of z one of x
and y, which give (from, to).

error: relative, of mass, centre of mass and inertia. Raises InvalidInput if it is out of reach, as for a density that
jumps: then give the bounds of each part as functions and add the parts.)");
}

}  // namespace binding
