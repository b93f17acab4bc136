// The Python module rbdyn._core.
#include <pybind11/pybind11.h>

#include <cstdlib>
#include <cstring>

#include "binding.hpp"

namespace {

/// Puts the signature that inspect.signature() reads before the docstring of a function or method.
void describe(const pybind11::object& function, const std::string& signature) {
    PyObject* f = function.ptr();
    if (PyInstanceMethod_Check(f)) f = PyInstanceMethod_GET_FUNCTION(f);
    if (!PyCFunction_Check(f)) return;
    PyMethodDef* method = reinterpret_cast<PyCFunctionObject*>(f)->m_ml;
    const std::string doc = signature + "\n--\n\n" + (method->ml_doc != nullptr ? method->ml_doc : "");
    // pybind11 frees it when the function goes
    char* const kept = strdup(doc.c_str());
    if (kept == nullptr) return;
    std::free(const_cast<char*>(method->ml_doc));
    method->ml_doc = kept;
}

}  // namespace

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
    binding::bind_tree_joints(m);
    binding::bind_constraints(m);
    binding::bind_loads(m);
    binding::bind_couplings(m);
    binding::bind_scene(m);
    binding::bind_watch(m);
    binding::bind_files(m);
    binding::bind_plan(m);
    binding::bind_statics(m);
    binding::bind_trajectory(m);
    binding::bind_euler_top(m);
    binding::bind_system(m);
    binding::bind_verbs(m);
    binding::bind_many(m);
    m.def("_describe", &describe, py::arg("function"), py::arg("signature"));
}
