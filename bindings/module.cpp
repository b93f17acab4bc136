// The Python module rbdyn._core.
#include <pybind11/pybind11.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>
#include <stdexcept>

#include "binding.hpp"

namespace {

constexpr const char* lack_of_memory =
    "rbdyn: there is not the memory for what is asked; ask for fewer points, times or members at once";

/// Gives a function or method the signature that inspect.signature() reads, and a docstring.
void describe(const pybind11::object& function, const std::string& signature, const std::string& text) {
    PyObject* f = function.ptr();
    if (PyInstanceMethod_Check(f)) f = PyInstanceMethod_GET_FUNCTION(f);
    if (!PyCFunction_Check(f)) return;
    PyMethodDef* method = reinterpret_cast<PyCFunctionObject*>(f)->m_ml;
    const std::string doc = signature + "\n--\n\n" + text;
    // pybind11 frees it when the function goes
    char* const kept = strdup(doc.c_str());
    if (kept == nullptr) return;
    std::free(const_cast<char*>(method->ml_doc));
    method->ml_doc = kept;
}

/// What a call is that no overload takes, in one sentence (python/rbdyn/bad_calls.py).
bool explain(PyObject* const* arguments, std::size_t count, PyObject* names) {
    namespace py = pybind11;
    py::object type, value, trace;
    PyErr_Fetch(&type.ptr(), &value.ptr(), &trace.ptr());
    PyErr_NormalizeException(&type.ptr(), &value.ptr(), &trace.ptr());
    try {
        const py::str text(value);
        const py::object contains = text.attr("find")(" arguments. The following argument types are supported:");
        if (contains.cast<int>() >= 0) {
            const auto positional = static_cast<std::size_t>(PyVectorcall_NARGS(count));
            py::list given;
            for (std::size_t i = 0; i < positional; ++i) given.append(py::handle(arguments[i]));
            py::dict named;
            if (names != nullptr)
                for (py::ssize_t i = 0; i < PyTuple_GET_SIZE(names); ++i)
                    named[PyTuple_GET_ITEM(names, i)] = py::handle(arguments[positional + static_cast<std::size_t>(i)]);
            const py::object sentence = py::module_::import("rbdyn.bad_calls").attr("sentence")(text, given, named);
            PyErr_SetObject(PyExc_TypeError, sentence.ptr());
            return true;
        }
    } catch (py::error_already_set& e) {
        // what cannot be told is told as it was, but for an interruption
        if (!e.matches(PyExc_Exception)) {
            e.restore();
            return true;
        }
    } catch (const std::exception&) {
    }
    PyErr_Restore(type.release().ptr(), value.release().ptr(), trace.release().ptr());
    return false;
}

// pybind11's own, one for all functions, and of its type: it takes the count without a sign
using FastCall = PyObject* (*)(PyObject*, PyObject* const*, std::size_t, PyObject*);
FastCall dispatch = nullptr;

/// Whether UTF-8 can write all of the words.
bool are_written(PyObject* names) {
    for (Py_ssize_t i = 0; names != nullptr && i < PyTuple_GET_SIZE(names); ++i) {
        if (PyUnicode_AsUTF8(PyTuple_GET_ITEM(names, i)) != nullptr) continue;
        PyErr_Clear();
        return false;
    }
    return true;
}

/// The words, what UTF-8 cannot write escaped.
pybind11::tuple escaped(PyObject* names) {
    pybind11::tuple all(static_cast<std::size_t>(PyTuple_GET_SIZE(names)));
    for (std::size_t i = 0; i < all.size(); ++i)
        all[i] = pybind11::str(binding::plain(PyTuple_GET_ITEM(names, static_cast<Py_ssize_t>(i))));
    return all;
}

/// As pybind11 calls a function. What it says of a call that no overload takes is made outside what it catches: half a
/// character in a keyword, say, would end the process. No argument has such a name, so that the call is refused by it.
PyObject* called(PyObject* self, PyObject* const* arguments, std::size_t count, PyObject* names) {
    try {
        if (are_written(names)) return dispatch(self, arguments, count, names);
        const pybind11::tuple words = escaped(names);
        return dispatch(self, arguments, count, words.ptr());
    } catch (pybind11::error_already_set& e) {
        e.restore();
    } catch (const std::exception&) {
        PyErr_SetString(PyExc_MemoryError, lack_of_memory);
    }
    return nullptr;
}

/// An argument that says it has more items than a machine counts is named: Python's own error names none.
void explain_length(PyObject* self, PyObject* const* arguments, std::size_t count, PyObject* names) {
    namespace py = pybind11;
    py::object raised[3];
    PyErr_Fetch(&raised[0].ptr(), &raised[1].ptr(), &raised[2].ptr());
    try {
        const auto positional = static_cast<std::size_t>(PyVectorcall_NARGS(count));
        const std::size_t all = positional + (names != nullptr ? static_cast<std::size_t>(PyTuple_GET_SIZE(names)) : 0);
        const auto* const record = py::detail::function_record_ptr_from_PyObject(self);
        for (std::size_t i = 0; i < all; ++i) {
            if (PyObject_Size(arguments[i]) >= 0) continue;
            const bool is_counted = PyErr_ExceptionMatches(PyExc_OverflowError) == 0;
            PyErr_Clear();
            if (is_counted) continue;
            const bool is_named = i < record->args.size() && record->args[i].name != nullptr;
            const std::string name =
                i >= positional ? binding::plain(PyTuple_GET_ITEM(names, static_cast<Py_ssize_t>(i - positional)))
                : is_named      ? record->args[i].name
                                : "argument " + std::to_string(i);
            std::string function = record->name;
            if (record->is_method) {
                const std::string kind = py::str(py::type::handle_of(arguments[0]).attr("__name__"));
                function = record->is_constructor ? kind : kind + "." + function;
            }
            const std::string sentence = function + ": " + name + " is " + binding::shown(arguments[i]) +
                                         ", whose length is 2**63 or more; give a list";
            py::set_error(PyExc_TypeError, sentence.c_str());
            return;
        }
    } catch (py::error_already_set& e) {
        e.restore();
        return;
    }
    PyErr_Restore(raised[0].release().ptr(), raised[1].release().ptr(), raised[2].release().ptr());
}

PyObject* explained(PyObject* self, PyObject* const* arguments, std::size_t count, PyObject* names) {
    PyObject* const result = called(self, arguments, count, names);
    if (result != nullptr) return result;
    if (PyErr_ExceptionMatches(PyExc_TypeError) != 0)
        explain(arguments, count, names);
    else if (PyErr_ExceptionMatches(PyExc_OverflowError) != 0)
        explain_length(self, arguments, count, names);
    return nullptr;
}

/// The same of __setstate__: what is raised where data are not as they were pickled says whose they are.
PyObject* explained_state(PyObject* self, PyObject* const* arguments, std::size_t count, PyObject* names) {
    namespace py = pybind11;
    PyObject* const result = called(self, arguments, count, names);
    if (result != nullptr || PyVectorcall_NARGS(count) < 1) return result;
    for (PyObject* const type : {PyExc_LookupError, PyExc_TypeError, PyExc_AttributeError, PyExc_OverflowError}) {
        if (PyErr_ExceptionMatches(type) == 0) continue;
        py::object raised[3];
        PyErr_Fetch(&raised[0].ptr(), &raised[1].ptr(), &raised[2].ptr());
        PyErr_NormalizeException(&raised[0].ptr(), &raised[1].ptr(), &raised[2].ptr());
        PyErr_Format(py::module_::import("rbdyn.errors").attr("InvalidInput").ptr(),
                     "%s: its data are not as they were pickled (%S); give them unchanged",
                     Py_TYPE(arguments[0])->tp_name, raised[1].ptr());
        break;
    }
    return result;
}

/// Functions of the module say in one sentence what is wrong with a call.
void explain_calls(const pybind11::handle& function) {
    PyObject* f = function.ptr();
    if (PyInstanceMethod_Check(f)) f = PyInstanceMethod_GET_FUNCTION(f);
    if (PyObject_TypeCheck(f, &PyStaticMethod_Type)) return explain_calls(pybind11::handle(f).attr("__func__"));
    if (!PyCFunction_Check(f)) return;
    PyMethodDef* const method = reinterpret_cast<PyCFunctionObject*>(f)->m_ml;
    if (method->ml_flags != (METH_FASTCALL | METH_KEYWORDS)) return;
    const auto known = reinterpret_cast<FastCall>(reinterpret_cast<void (*)()>(method->ml_meth));
    if (known == &explained || known == &explained_state || (dispatch != nullptr && known != dispatch)) return;
    dispatch = known;
    const bool is_state = std::strcmp(method->ml_name, "__setstate__") == 0;
    method->ml_meth =
        reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(is_state ? &explained_state : &explained));
}

/// An object that __new__ made and nothing else has no value: pybind11 would give it raw memory for one.
void* refuse_raw(std::size_t) {
    throw pybind11::type_error(
        "an object of rbdyn's was made by __new__ alone and has no value; make it by calling its class");
}

// --- the base of all classes, which is pybind11's own and every module's ---

newfunc make = nullptr;

/// As pybind11 makes an object, which ends the process where a class is none of C++'s, as that base is.
PyObject* made(PyTypeObject* type, PyObject* arguments, PyObject* names) {
    if (!pybind11::detail::all_type_info(type).empty()) return make(type, arguments, names);
    PyErr_Format(PyExc_TypeError,
                 "%s makes no objects: it is the base of classes, or derived from that base alone; call one of those "
                 "classes, and pickle with pickle.dumps() or __reduce_ex__()",
                 type->tp_name);
    return nullptr;
}

/// For a class and what is derived from it, now and later: Python has them make their objects alike.
void guard_making(pybind11::handle type) {
    auto* const object = reinterpret_cast<PyTypeObject*>(type.ptr());
    if (object->tp_new == make) object->tp_new = &made;
    for (const pybind11::handle derived : pybind11::type::handle_of(type).attr("__subclasses__")(type))
        guard_making(derived);
}

/// What pickle keeps of an object, by any protocol as by the second: those before it would make the base anew.
pybind11::object reduced(const pybind11::object& self, int protocol) {
    const pybind11::handle object(reinterpret_cast<PyObject*>(&PyBaseObject_Type));
    return object.attr("__reduce_ex__")(self, std::max(protocol, 2));
}

void guard_base() {
    namespace py = pybind11;
    const py::handle base = py::detail::get_internals().instance_base;
    if (make != nullptr) return;
    make = reinterpret_cast<PyTypeObject*>(base.ptr())->tp_new;
    guard_making(base);
    const py::cpp_function reduce(&reduced, py::name("__reduce_ex__"), py::is_method(base), py::arg("protocol"));
    explain_calls(reduce);
    py::setattr(base, "__reduce_ex__", reduce);
}

/// The first two for all that a module holds.
void guard(const pybind11::module_& m) {
    namespace py = pybind11;
    for (const auto& [name, thing] : py::dict(m.attr("__dict__"))) {
        if (!PyType_Check(thing.ptr())) {
            explain_calls(thing);
            continue;
        }
        py::detail::type_info* const info = py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(thing.ptr()));
        if (info == nullptr || !thing.attr("__module__").equal(m.attr("__name__"))) continue;
        info->operator_new = &refuse_raw;
        for (const auto& [word, member] : py::dict(thing.attr("__dict__"))) {
            explain_calls(member);
            if (!PyObject_TypeCheck(member.ptr(), &PyProperty_Type)) continue;
            for (const char* const accessor : {"fget", "fset"}) explain_calls(member.attr(accessor));
        }
    }
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
        } catch (const std::bad_alloc&) {
            py::set_error(PyExc_MemoryError, lack_of_memory);
        } catch (const std::length_error&) {
            py::set_error(PyExc_MemoryError, lack_of_memory);
        } catch (const py::cast_error&) {
            // of data that was changed, say, or half a character in a word
            py::set_error(py::module_::import("rbdyn.errors").attr("InvalidInput"),
                          "rbdyn: a value given, or in the data of a state, is of a kind that is not taken there; give "
                          "what the documentation names, and data as they were pickled");
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
    binding::bind_cost(m);
    binding::bind_verbs(m);
    binding::bind_many(m);
    m.def("_describe", &describe, py::arg("function"), py::arg("signature"), py::arg("text"));
    guard(m);
    guard_base();
}
