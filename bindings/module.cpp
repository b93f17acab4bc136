// The Python module rbdyn._core.
#include <pybind11/pybind11.h>

#include <rbdyn/rbdyn.hpp>

PYBIND11_MODULE(_core, m) {
    m.doc() = "Dynamics of points and rigid bodies.";
    m.attr("__version__") = rbdyn::version;
}
