// The Python module rbdyn._core.
#include <pybind11/pybind11.h>

#include "binding.hpp"

PYBIND11_MODULE(_core, m) {
    namespace py = pybind11;
    m.doc() = "Dynamics of points and rigid bodies.";
    // errors that carry a run are raised in verbs.cpp
    py::register_local_exception_translator([](std::exception_ptr thrown) {
        const auto raise = [](const char* name, const std::exception& e) {
            py::set_error(py::module_::import("rbdyn.errors").attr(name), e.what());
        };
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const rbdyn::InvalidInput& e) {
            raise("InvalidInput", e);
        } catch (const rbdyn::Error& e) {
            raise("Error", e);
        }
    });
    binding::bind_expressions(m);
    binding::bind_parameters(m);
    binding::bind_functions(m);
    binding::bind_curves(m);
    binding::bind_attitude(m);
    binding::bind_bodies(m);
    binding::bind_poinsot(m);
    binding::bind_rails(m);
    binding::bind_joints(m);
    binding::bind_loads(m);
    binding::bind_scene(m);
    binding::bind_watch(m);
    binding::bind_plan(m);
    binding::bind_statics(m);
    binding::bind_trajectory(m);
    binding::bind_euler_top(m);
    binding::bind_verbs(m);
}
