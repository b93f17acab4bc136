// Functions of the user's that are called back with numbers while a run goes on: Python functions, and compiled ones by
// their address.
//
// A Python function is given floats and arrays. An array is filled again for the next call if nobody kept it, or a part
// of it; else the next call has a new one: what a user keeps never changes, and what nobody keeps costs nothing.
#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <string_view>

#include "recording.hpp"

namespace binding {

namespace {

/// Python's lock, held as long as this lives.
class Lock {
public:
    Lock() : state_(PyGILState_Ensure()) {}
    ~Lock() { PyGILState_Release(state_); }
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

private:
    PyGILState_STATE state_;
};

/// Keeps a Python object, and may be dropped by any thread.
class Held {
public:
    explicit Held(py::object object) : object_(object.release().ptr()) {}
    Held(const Held&) = delete;
    Held& operator=(const Held&) = delete;
    ~Held() {
        if (Py_IsInitialized() == 0) return;
        const Lock lock;
        Py_DECREF(object_);
    }
    PyObject* get() const { return object_; }

private:
    PyObject* object_;
};

/// A Python function and the arguments it was last called with.
class PythonFunction {
public:
    PythonFunction(const py::object& f, Signature signature, bool spread, std::string user)
        : f_(f), signature_(std::move(signature)), user_(std::move(user)), name_(name_of(f)) {
        for (std::size_t k = 0; k < signature_.arguments.size(); ++k) {
            const std::vector<py::ssize_t> shape = signature_.shape(k);
            const auto size = static_cast<std::size_t>(signature_.arguments[k]);
            if (!shape.empty() && !spread) {
                shapes_.push_back(shape);
                sizes_.push_back(size);
            } else {
                shapes_.insert(shapes_.end(), size, {});
                sizes_.insert(sizes_.end(), size, 1);
            }
        }
        arrays_.resize(sizes_.size());
    }
    PythonFunction(const PythonFunction&) = delete;
    PythonFunction& operator=(const PythonFunction&) = delete;
    ~PythonFunction() {
        if (Py_IsInitialized() == 0) {
            for (py::object& a : arrays_) a.release();
            return;
        }
        const Lock lock;
        arrays_.clear();
    }

    void operator()(const double* x, double* y) {
        const Lock lock;
        const CallingBack here;
        constexpr std::size_t most = 16;
        std::array<PyObject*, most + 1> arguments{};  // one before them, for methods
        const std::size_t count = sizes_.size();
        for (std::size_t i = 0; i < count; ++i) {
            arguments[i + 1] = argument(i, x);
            x += sizes_[i];
        }
        PyObject* const returned =
            PyObject_Vectorcall(f_.get(), arguments.data() + 1, count | PY_VECTORCALL_ARGUMENTS_OFFSET, nullptr);
        for (std::size_t i = 0; i < count; ++i) Py_DECREF(arguments[i + 1]);
        if (returned == nullptr) throw py::error_already_set();
        read(py::reinterpret_steal<py::object>(returned), y);
    }

private:
    /// A new reference to argument i.
    PyObject* argument(std::size_t i, const double* x) {
        if (shapes_[i].empty()) {
            PyObject* const value = PyFloat_FromDouble(*x);
            if (value == nullptr) throw py::error_already_set();
            return value;
        }
        py::object& array = arrays_[i];
        // nobody else holds it: neither what the function kept, nor a call that is still under way
        if (!array || Py_REFCNT(array.ptr()) != 1) array = py::array_t<double>(shapes_[i]);
        std::memcpy(py::detail::array_proxy(array.ptr())->data, x, sizes_[i] * sizeof(double));
        return array.inc_ref().ptr();
    }

    void read(const py::object& returned, double* y) const {
        if (signature_.is_motion) {
            for (const py::handle item :
                 py::module_::import("rbdyn.tracing").attr("rigid_motion")(returned, user_, name_))
                *y++ = number(item, user_, "what function " + name_ + " returns");
            return;
        }
        PyObject* const value = returned.ptr();
        const int wanted = signature_.results;
        if (wanted == 1 && (!signature_.is_state || PyFloat_Check(value) != 0)) {
            if (!plain(value, *y)) *y = number(returned, user_, "what function " + name_ + " returns");
            return;
        }
        if (PyTuple_Check(value) != 0 || PyList_Check(value) != 0) {
            if (PySequence_Fast_GET_SIZE(value) == wanted) {
                PyObject** items = PySequence_Fast_ITEMS(value);
                int read = 0;
                while (read < wanted && plain(items[read], y[read])) ++read;
                if (read == wanted) return;
            }
        }
        const Array array = doubles(returned, user_, "what function " + name_ + " returns");
        if (!signature_.fits(array))
            throw InvalidInput(user_ + ": function " + name_ + " returns " + form_of(returned, array) + "; " +
                               signature_.rule);
        std::copy_n(array.data(), wanted, y);
    }
    static bool plain(PyObject* value, double& y) {
        if (PyFloat_Check(value) != 0) {
            y = PyFloat_AS_DOUBLE(value);
            return true;
        }
        if (PyLong_CheckExact(value) == 0) return false;
        y = PyLong_AsDouble(value);
        if (y == -1.0 && PyErr_Occurred() != nullptr) throw py::error_already_set();
        return true;
    }

    Held f_;
    Signature signature_;
    std::string user_, name_;
    std::vector<std::vector<py::ssize_t>> shapes_;  // of the arguments; empty: a number
    std::vector<std::size_t> sizes_;
    std::vector<py::object> arrays_;  // the last arguments
};

// --- compiled functions ---

/// C's way to write the signature, without blanks: void(double,double*,double*,double*)
std::string c_signature(const Signature& signature) {
    std::string arguments;
    for (std::size_t k = 0; k < signature.arguments.size(); ++k)
        arguments += std::string(arguments.empty() ? "" : ",") + (signature.shape(k).empty() ? "double" : "double*");
    return signature.results == 1 && !signature.is_state ? "double(" + arguments + ")"
                                                         : "void(" + arguments + ",double*)";
}

std::string without_blanks(std::string text) {
    for (std::size_t at; (at = text.find("const ")) != std::string::npos;) text.erase(at, 6);
    std::erase_if(text, [](unsigned char c) { return std::isspace(c) != 0; });
    return text;
}

struct Compiled {
    void* address = nullptr;
    void* data = nullptr;   // of the user's, passed last
    std::string signature;  // as c_signature() writes it; "void*" last: takes data
};

std::string joined(const std::string& returned, const std::vector<std::string>& arguments) {
    std::string text = returned + "(";
    for (std::size_t i = 0; i < arguments.size(); ++i) text += (i == 0 ? "" : ",") + arguments[i];
    return text + ")";
}

/// An object of numba.cfunc.
std::optional<Compiled> from_numba(const py::object& f) {
    const std::string module = py::str(py::getattr(py::type::of(f), "__module__", py::str("")));
    if (!module.starts_with("numba.") || !py::hasattr(f, "address")) return std::nullopt;
    Compiled c;
    c.address = PyLong_AsVoidPtr(py::object(f.attr("address")).ptr());
    const py::object signature = py::getattr(f, "_sig", py::none());
    if (signature.is_none()) return c;
    const auto word = [](const py::handle type) {
        std::string text = py::str(type);
        if (text == "none") return std::string("void");
        if (text.starts_with("float64")) text.replace(0, 7, "double");
        return text;
    };
    std::vector<std::string> arguments;
    for (const py::handle a : signature.attr("args")) arguments.push_back(word(a));
    c.signature = joined(word(signature.attr("return_type")), arguments);
    return c;
}

/// A scipy.LowLevelCallable: a tuple that starts with a capsule, whose name is the signature.
std::optional<Compiled> from_scipy(const py::object& f) {
    if (PyTuple_Check(f.ptr()) == 0 || std::string_view(Py_TYPE(f.ptr())->tp_name) != "LowLevelCallable")
        return std::nullopt;
    PyObject* const capsule = PyTuple_GET_ITEM(f.ptr(), 0);
    if (PyCapsule_CheckExact(capsule) == 0) return std::nullopt;
    const char* const name = PyCapsule_GetName(capsule);
    Compiled c{PyCapsule_GetPointer(capsule, name), PyCapsule_GetContext(capsule),
               name != nullptr ? without_blanks(name) : ""};
    if (PyErr_Occurred() != nullptr) throw py::error_already_set();
    return c;
}

/// A function pointer of ctypes.
std::optional<Compiled> from_ctypes(const py::object& f, const std::string& user) {
    // who has one has imported ctypes
    const py::dict modules = py::module_::import("sys").attr("modules");
    if (!modules.contains("ctypes")) return std::nullopt;
    const py::object ctypes = modules["ctypes"];
    if (!py::isinstance(f, ctypes.attr("_CFuncPtr"))) return std::nullopt;
    const auto word = [&](const py::handle type) -> std::string {
        if (type.is(ctypes.attr("c_double"))) return "double";
        const py::object pointed = py::getattr(type, "_type_", py::none());
        const bool is_pointer = pointed.is(ctypes.attr("c_double")) || type.is(ctypes.attr("c_void_p")) ||
                                py::hasattr(type, "_dtype_");  // numpy.ctypeslib.ndpointer
        return is_pointer ? "double*" : std::string(py::str(py::getattr(type, "__name__", type)));
    };
    const py::object types = f.attr("argtypes"), returned = f.attr("restype");
    if (types.is_none())
        throw InvalidInput(user + ": function pointer " + shown(f) +
                           " does not say what it takes; set its argtypes and restype");
    std::vector<std::string> arguments;
    for (const py::handle t : types) arguments.push_back(word(t));
    const py::object address = ctypes.attr("cast")(f, ctypes.attr("c_void_p")).attr("value");
    return Compiled{PyLong_AsVoidPtr(address.ptr()), nullptr,
                    joined(returned.is_none() ? "void" : word(returned), arguments)};
}

// calls by address, for each kind of signature; the Python object lives as long as its address is called
template <class... Tail>
std::function<void(const double*, double*)> caller(const std::string& kind, const Signature& signature, void* address,
                                                   const std::shared_ptr<Held>& held, Tail... tail) {
    // what is pointed to is the callee's to write in
    if (kind == "double(double)")
        return [f = reinterpret_cast<double (*)(double, Tail...)>(address), held, tail...](const double* x, double* y) {
            *y = f(*x, tail...);
        };
    if (kind == "double(double*)")
        return
            [f = reinterpret_cast<double (*)(double*, Tail...)>(address), held, tail...](const double* x, double* y) {
                std::array<double, 3> a{x[0], x[1], x[2]};
                *y = f(a.data(), tail...);
            };
    if (kind == "void(double,double*,double*)")
        return [f = reinterpret_cast<void (*)(double, double*, double*, Tail...)>(address), held,
                count = signature.inputs(), tail...](const double* x, double* y) {
            std::vector<double> a(x + 1, x + count);
            f(*x, a.data(), y, tail...);
        };
    if (kind == "void(double,double*)")
        return [f = reinterpret_cast<void (*)(double, double*, Tail...)>(address), held, tail...](
                   const double* x, double* y) { f(*x, y, tail...); };
    if (kind == "void(double,double*,double*,double*)")
        return [f = reinterpret_cast<void (*)(double, double*, double*, double*, Tail...)>(address), held,
                size = signature.arguments[1], count = signature.inputs(), tail...](const double* x, double* y) {
            std::array<double, 12> a{};  // a matrix and a vector
            std::copy(x + 1, x + count, a.begin());
            f(*x, a.data(), a.data() + size, y, tail...);
        };
    if (kind == "void(double,double*,double*,double*,double*,double*)")
        return [f = reinterpret_cast<void (*)(double, double*, double*, double*, double*, double*, Tail...)>(address),
                held, tail...](const double* x, double* y) {
            std::array<double, 12> a{};
            std::copy(x + 1, x + 13, a.begin());
            f(*x, a.data(), a.data() + 3, a.data() + 6, a.data() + 9, y, tail...);
        };
    return {};
}

}  // namespace

std::shared_ptr<const rbdyn::Callback> python_callback(const py::object& f, const Signature& signature, bool spread,
                                                       const std::string& user, const std::string& reason) {
    auto callback = std::make_shared<rbdyn::Callback>();
    callback->name = py::str(py::getattr(f, "__name__", py::str(shown(f))));
    callback->reason = reason;
    callback->inputs = signature.inputs();
    callback->outputs = signature.results;
    callback->is_python = true;
    const auto function = std::make_shared<PythonFunction>(f, signature, spread, user);
    callback->function = [function](const double* x, double* y) { (*function)(x, y); };
    return callback;
}

std::shared_ptr<const rbdyn::Callback> native_callback(const py::object& f, const Signature& signature,
                                                       const std::string& user) {
    std::optional<Compiled> compiled = from_numba(f);
    if (!compiled) compiled = from_scipy(f);
    if (!compiled) compiled = from_ctypes(f, user);
    if (!compiled) return nullptr;
    const std::string wanted = signature.is_motion ? "" : c_signature(signature);
    if (wanted.empty()) throw InvalidInput(user + ": it takes no compiled function; give one written in Python");
    const std::string& found = compiled->signature;
    const std::string with_data = wanted.substr(0, wanted.size() - 1) + ",void*)";
    const bool takes_data = found == with_data;
    if (!found.empty() && found != wanted && !takes_data)
        throw InvalidInput(user + ": the compiled function is " + found + "; here it is " + wanted);
    auto callback = std::make_shared<rbdyn::Callback>();
    const auto held = std::make_shared<Held>(f);
    callback->function = takes_data ? caller(wanted, signature, compiled->address, held, compiled->data)
                                    : caller(wanted, signature, compiled->address, held);
    if (!callback->function) throw InvalidInput(user + ": it takes no compiled function; give a Python function");
    if (compiled->address == nullptr)
        throw InvalidInput(user + ": the compiled function's address is zero; it has one");
    callback->name = py::str(py::getattr(f, "__name__", py::str("compiled function")));
    callback->reason = "it is compiled";
    callback->inputs = signature.inputs();
    callback->outputs = signature.results;
    return callback;
}

}  // namespace binding
