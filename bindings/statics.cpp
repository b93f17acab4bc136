// What a scene says at rest: equilibria, normal modes, and the potential of a bead along its rail.
#include <rbdyn/statics/equilibria.hpp>
#include <rbdyn/statics/normal_modes.hpp>
#include <rbdyn/statics/rail_potential.hpp>

#include "handles.hpp"

namespace binding {

namespace {

std::string tuple_text(const std::vector<double>& values) {
    std::string text = "(";
    for (std::size_t k = 0; k < values.size(); ++k) text += (k == 0 ? "" : ", ") + rbdyn::text(values[k]);
    return text + (values.size() == 1 ? ",)" : ")");
}
py::array_t<double> array_of(const std::vector<double>& values) {
    return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}
py::tuple numbers_of(const std::vector<double>& values) {
    py::tuple result(values.size());
    for (std::size_t k = 0; k < values.size(); ++k) result[k] = values[k];
    return result;
}
std::string tuple_text(const std::vector<Vector3>& vectors) {
    std::string text = "(";
    for (std::size_t k = 0; k < vectors.size(); ++k) text += (k == 0 ? "" : ", ") + list_text(vectors[k]);
    return text + (vectors.size() == 1 ? ",)" : ")");
}
std::string shown_value(const std::optional<double>& value) { return value ? rbdyn::text(*value) : "None"; }

void bind_equilibria(py::module_& m) {
    using rbdyn::Equilibrium;
    py::class_<Equilibrium>(m, "Equilibrium", "Where a scene stays at rest, and what it does nearby (eq. 7.16).")
        .def_property_readonly(
            "coordinates", [](const Equilibrium& e) { return array_of(e.coordinates); },
            R"(In order of addition (n,): the parameter of a bead; x, y, z of a free particle [m]; the angle of a hinge
[rad], in (-pi, pi] of one body alone without torsion spring; the displacement of a slide [m]; the attitude of a body on
a ball joint, quaternion (w, x, y, z); position [m] and attitude of a free body, seven numbers.)")
        .def_readonly(
            "stable", &Equilibrium::stable,
            R"(Whether U has a strict maximum there, or friction holds it. False where it is indifferent; turns about `axes`
are left aside.)")
        .def_readonly("decided", &Equilibrium::decided,
                      "Whether `stable` is known: not where rounding hides what forces do nearby, or it is not proven.")
        .def_readonly(
            "interval", &Equilibrium::interval,
            R"(The coordinates of one bead, hinge or slide between which all is equilibrium, or None: what friction holds
on a rough rail, or where no force acts along it.)")
        .def_property_readonly(
            "axes", [](const Equilibrium& e) { return rows_of(e.axes); },
            R"(Directions in the world about which one body alone may be turned, and all stay at rest (k, 3).

A heavy body on a ball joint has the vertical; `coordinates` are then one of these states. Empty where there are none.)")
        .def_property_readonly(
            "periods", [](const Equilibrium& e) { return array_of(e.periods); },
            "Of small oscillations about it [s], the longest first; empty where there are none. (n,)")
        .def("__eq__",
             [](const Equilibrium& a, const py::object& b) {
                 return py::isinstance<Equilibrium>(b) && a == b.cast<const Equilibrium&>();
             })
        .def("__hash__", [](const Equilibrium& e) { return py::hash(numbers_of(e.coordinates)); })
        .def(py::pickle(
            [](const Equilibrium& e) {
                return py::make_tuple(e.coordinates, e.stable, e.interval, e.periods, rows_of(e.axes), e.decided);
            },
            [](const py::tuple& d) {
                Equilibrium e{d[0].cast<std::vector<double>>(), d[1].cast<bool>()};
                e.interval = d[2].cast<std::optional<std::pair<double, double>>>();
                e.periods = d[3].cast<std::vector<double>>();
                for (const auto& [x, y, z] : d[4].cast<std::vector<std::tuple<double, double, double>>>())
                    e.axes.emplace_back(x, y, z);
                e.decided = d[5].cast<bool>();
                return e;
            }))
        .def("__str__", &printed<Equilibrium>)
        .def("__repr__", [](const Equilibrium& e) {
            return "Equilibrium(coordinates=" + tuple_text(e.coordinates) +
                   ", stable=" + (e.stable ? "True" : "False") + ", interval=" +
                   (e.interval ? tuple_text({e.interval->first, e.interval->second}) : std::string("None")) +
                   ", periods=" + tuple_text(e.periods) + (e.axes.empty() ? "" : ", axes=" + tuple_text(e.axes)) +
                   (e.decided ? ")" : ", decided=False)");
        });

    m.def(
        "equilibria",
        [](const BoundScene& scene, const std::optional<ArrayLike>& near) {
            std::vector<double> place;
            if (near) {
                const Array given = doubles(*near, "equilibria", "near");
                if (given.ndim() > 1)
                    throw InvalidInput("equilibria: near has shape " + shape_of(given) +
                                       "; it is a list of the coordinates, in order of addition");
                place.assign(given.data(), given.data() + given.size());
            }
            const rbdyn::Scene copy = scene.scene;
            return unlocked([&] { return rbdyn::equilibria(copy, place); });
        },
        py::arg("scene"), py::arg("near") = py::none(),
        R"(The states of rest of a scene, velocities zero (eqs. 7.16, 7.60).

One bead on a rail, one body on a hinge or a slide with all that is fixed to it: all there are, in order of the coordinate.
A hinge is searched for one turn, with a torsion spring as far as that lets there be any, 1000 turns to both sides at most.
A slide, a rail without ends that is not closed, or a hinge with a torque that is another one after a turn, is searched
on both sides of `near`, its coordinate (the start otherwise), as far as 32 Taylor series on each side go, each up to twice
as long as the one before. On a rough rail each is an `interval`. A bead that is only pressed against an end of its rail is
in none.
One body on a ball joint: those found from `near`, or from its start, and from attitudes spread over all; stable ones
first. A heavy body has two, its centre of mass below and above the point that is held, free to turn about the vertical
(`axes`): the attitudes given are those reached without such a turn.
More freedoms: at most one, that in which a slow and damped motion from the start of the scene ends, or where that leads
to none, one near it; given `near`, all coordinates in order of addition, the nearest of those, stable or not, that searches
from there and from places about it lead to: by the sum of squares of the differences [m, rad], without whole turns that
change nothing. On rough rails it is one among others. So for bodies joined to bodies and constraints, which hold there; their coordinates are those
a scene starts with: of a joint with a parent relative to it.
An empty list: none was found. Raises InvalidInput for a scene without bodies or with contacts, with forces or torques that
depend on time or are called back, or with rails or joints that are driven.)");
}

py::array_t<double> matrix_of(const rbdyn::Matrix& m) {
    return py::array_t<double>({m.rows(), m.columns()}, m.entries().data());
}

void bind_normal_modes(py::module_& m) {
    using rbdyn::NormalModes;
    const auto data = [](const NormalModes& n) { return py::make_tuple(n.squares, n.frequencies, n.shapes.entries()); };
    py::class_<NormalModes>(m, "NormalModes", "Small oscillations about a state of rest.")
        .def_property_readonly(
            "frequencies", [](const NormalModes& n) { return array_of(n.frequencies); },
            R"(In ascending order (n,) [rad/s]; zero where nothing pushes back, not a number where the rest is unstable.)")
        .def_property_readonly(
            "squares", [](const NormalModes& n) { return array_of(n.squares); },
            R"(Of the frequencies, in the same order (n,) [1/s^2]; negative where the rest is unstable.)")
        .def_property_readonly(
            "shapes", [](const NormalModes& n) { return matrix_of(n.shapes); },
            R"(One a column (m, n), of unit length in the metric of the kinetic energy: s.M s = 1; m is n without constraints.

The component of largest size is positive. Rows, in order of addition: the parameter of a bead; x, y, z of a free particle;
the angle of a hinge; the displacement of a slide; the coordinates of a joint that has more; of a body that turns freely the
place of its centre of mass, if it is free, and small turns about the body's axes [rad].)")
        .def("__eq__",
             [](const NormalModes& a, const py::object& other) {
                 if (!py::isinstance<NormalModes>(other)) return false;
                 const auto& b = other.cast<const NormalModes&>();
                 return a.squares == b.squares && a.shapes == b.shapes;
             })
        .def("__hash__", [](const NormalModes& n) { return py::hash(numbers_of(n.squares)); })
        .def(py::pickle(
            data,
            [](const py::tuple& d) {
                NormalModes n{d[0].cast<std::vector<double>>(), d[1].cast<std::vector<double>>(), rbdyn::Matrix()};
                const auto entries = d[2].cast<std::vector<double>>();
                const int size = static_cast<int>(n.squares.size());
                if (n.frequencies.size() != n.squares.size() ||
                    (size == 0 ? !entries.empty() : entries.size() % n.squares.size() != 0))
                    throw InvalidInput("NormalModes: its data have " + std::to_string(size) + " squares, " +
                                       std::to_string(n.frequencies.size()) + " frequencies and " +
                                       std::to_string(entries.size()) +
                                       " numbers of shapes; there are as many of each, and some rows of them");
                n.shapes = rbdyn::Matrix(size == 0 ? 0 : static_cast<int>(entries.size()) / size, size);
                for (int i = 0; i < static_cast<int>(entries.size()); ++i)
                    n.shapes(i / size, i % size) = entries[static_cast<std::size_t>(i)];
                return n;
            }))
        .def("__str__", &printed<NormalModes>)
        .def("__repr__", [](const NormalModes& n) { return "<NormalModes: squares " + tuple_text(n.squares) + ">"; });
    m.def(
        "normal_modes",
        [](const BoundScene& scene, const rbdyn::Equilibrium& at) {
            const rbdyn::Scene copy = scene.scene;
            return unlocked([&] { return rbdyn::normal_modes(copy, at); });
        },
        py::arg("scene"), py::arg("at"),
        R"(The small oscillations of a scene about one of its equilibria: K s = square M s.

M is the mass matrix of the kinetic energy, K the stiffness, exact derivatives of the recorded forces. Damping and all that
depends on velocity is left aside. Raises InvalidInput where `at` is no equilibrium, where friction holds a bead, and where
forces depend on time, are called back, or have no potential.)");
}

/// A potential with the scene it is of, as that was.
struct BoundPotential : rbdyn::RailPotential {
    BoundPotential(const BoundScene& given, const BodyHandle& handle)
        : RailPotential(given.scene, given.handles.body(handle, "rail_potential")),
          scene{given.scene.frozen(), given.handles},
          bead(handle) {}
    BoundScene scene;
    BodyHandle bead;
};

/// A quantity of one, without Python's lock.
template <class R, class... Arguments>
auto without_lock(R (rbdyn::RailPotential::*quantity)(Arguments...) const) {
    return [quantity](const BoundPotential& self, Arguments... arguments) {
        return unlocked([&] { return (self.*quantity)(arguments...); });
    };
}

void bind_rail_potential(py::module_& m) {
    using rbdyn::RailPotential, rbdyn::TurningPoints;
    py::class_<TurningPoints>(m, "TurningPoints", "Where a motion along a rail turns round next, as parameters.")
        .def_readonly("below", &TurningPoints::below, "On the side of smaller parameters; None if it does not.")
        .def_readonly("above", &TurningPoints::above, "On the side of larger parameters; None if it does not.")
        .def("__eq__",
             [](const TurningPoints& a, const py::object& b) {
                 return py::isinstance<TurningPoints>(b) && a == b.cast<const TurningPoints&>();
             })
        .def("__hash__", [](const TurningPoints& t) { return py::hash(py::make_tuple(t.below, t.above)); })
        .def(
            py::pickle([](const TurningPoints& t) { return py::make_tuple(t.below, t.above); },
                       [](const py::tuple& d) {
                           return TurningPoints{d[0].cast<std::optional<double>>(), d[1].cast<std::optional<double>>()};
                       }))
        .def("__iter__", [](const TurningPoints& t) { return py::iter(py::make_tuple(t.below, t.above)); })
        .def("__repr__", [](const TurningPoints& t) {
            return "TurningPoints(below=" + shown_value(t.below) + ", above=" + shown_value(t.above) + ")";
        });

    const char* const user = "RailPotential";
    const auto rule = [] {
        return std::string(
            "it is beyond what a double holds, or what acts there is without bound; give another parameter");
    };
    const auto at = [user, rule](const ArrayLike& u, const char* quantity, const auto& f) {
        return finite_over(u, user, "parameter", quantity, f, rule);
    };
    py::class_<BoundPotential>(
        m, "RailPotential",
        R"(The potential of a bead along its rail at rest (eqs. 7.18-7.22), F_t = +dU/ds (the chapter's sign).

U is zero at the beginning of the curve, or at u = 0 where it has none. A parameter is a number, or an array of any
shape.)")
        .def(
            "value",
            [at](const BoundPotential& p, const ArrayLike& u) {
                return at(u, "U", [&](double x) { return p.value(x); });
            },
            py::arg("u"), "U [J].")
        .def(
            "tangential_force",
            [at](const BoundPotential& p, const ArrayLike& u) {
                return at(u, "F_t", [&](double x) { return p.tangential_force(x); });
            },
            py::arg("u"), "F_t = dU/ds [N] (eq. 7.15). Raises InvalidInput at a cusp.")
        .def(
            "work_of_forces",
            [at](const BoundPotential& p, const ArrayLike& u) {
                return at(u, "work of forces", [&](double x) { return p.work_of_forces(x); });
            },
            py::arg("u"), "The part of U that is the work of Force functions [J].")
        .def(
            "energy",
            [user, rule](const BoundPotential& p, const ArrayLike& u, const ArrayLike& speed) {
                return over_both(u, speed, user, "parameter", "speed", [&](double x, double v) {
                    const double energy = p.energy(x, v);
                    require_finite(
                        energy, user,
                        [&] { return "energy at parameter " + rbdyn::text(x) + " and speed " + rbdyn::text(v); }, rule);
                    return energy;
                });
            },
            py::arg("u"), py::arg("speed") = 0.0, "m speed^2/2 - U [J] (eq. 7.20). Arrays are broadcast.")
        .def(
            "speed",
            [at](const BoundPotential& p, const ArrayLike& u, double energy) {
                return at(u, "speed", [&](double x) { return p.speed(x, energy); });
            },
            py::arg("u"), py::arg("energy"),
            "|ds/dt| at u of the motion with an energy [m/s] (eq. 7.21). Raises InvalidInput where it does not come.")
        .def("turning_points", without_lock(&RailPotential::turning_points), py::arg("energy"), py::arg("start"),
             R"(Where the motion with an energy [J] that passes the parameter `start` turns round next, either way.

None where it passes on for ever or the curve ends; on a curve without end that is looked for as far as 1000 Taylor
series go. At rest in equilibrium both are the start. With the energy of a separatrix: the equilibrium that it only
comes nearer to.)")
        .def("period", without_lock(&RailPotential::period), py::arg("energy"), py::arg("start"),
             R"(The time there and back between the turning points [s] (eq. 7.22).

On a closed curve round which it passes on: of the next round from `start`, the parameter growing. At rest in stable
equilibrium that of small oscillations, at other equilibria and on a separatrix infinite. Raises InvalidInput for a
motion that does not come back.)")
        .def("time", without_lock(&RailPotential::time), py::arg("energy"), py::arg("u0"), py::arg("u1"),
             R"(The time of the motion with an energy [J] straight from u0 to u1 [s] (eq. 7.22), negative if u1 < u0.

Raises InvalidInput if it turns round before.)")
        .def(py::pickle(
            [](const BoundPotential& p) { return py::make_tuple(p.scene, p.bead); },
            [](const py::tuple& d) { return BoundPotential(d[0].cast<const BoundScene&>(), d[1].cast<BodyHandle>()); }))
        .def("__repr__", [](const BoundPotential& p) { return "<RailPotential: " + printed<RailPotential>(p) + ">"; });

    m.def(
        "rail_potential", [](const BoundScene& scene, const BodyHandle& bead) { return BoundPotential(scene, bead); },
        py::arg("scene"), py::arg("bead"),
        R"(The potential of a bead of a scene along its rail at rest (eq. 7.18), also where a force has none in space.

Raises InvalidInput, naming what stands against it, unless the tangential force depends on the place alone: friction,
drag, dampers, a rail that moves, springs to other bodies, forces that depend on velocity or time.)");
}

}  // namespace

void bind_statics(py::module_& m) {
    bind_equilibria(m);
    bind_normal_modes(m);
    bind_rail_potential(m);
}

}  // namespace binding
