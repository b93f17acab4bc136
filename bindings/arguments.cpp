// Arguments from Python: numbers and vectors of the right shape, or an InvalidInput that says what they are.
#include <algorithm>

#include "binding.hpp"

namespace binding {

std::string plain(py::handle text) {
    const auto bytes =
        py::reinterpret_steal<py::object>(PyUnicode_AsEncodedString(text.ptr(), "utf-8", "backslashreplace"));
    if (!bytes) throw py::error_already_set();
    std::string result = py::reinterpret_borrow<py::bytes>(bytes);
    // a message ends at a zero
    for (std::size_t at; (at = result.find('\0')) != std::string::npos;) result.replace(at, 1, "\\x00");
    return result;
}

std::string shown(py::handle value) {
    constexpr std::size_t longest = 60;
    std::string text;
    try {
        text = plain(py::repr(value));
    } catch (py::error_already_set& e) {
        // one that cannot tell what it is; but for an interruption
        if (!e.matches(PyExc_Exception)) throw;
        text = "<" + plain(py::str(py::type::handle_of(value).attr("__name__"))) + ">";
    }
    if (text.size() <= longest) return text;
    // not within a letter
    std::size_t end = longest - 3;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
    return text.substr(0, end) + "...";
}

std::string shape_of(const py::array& array) { return py::str(array.attr("shape")); }

/// Whether a value, or an item of a list, has a unit, which NumPy would drop.
static bool has_unit(py::handle value) {
    const auto is_plain = [](PyObject* one) {
        return PyFloat_CheckExact(one) || PyLong_CheckExact(one) ||
               Py_TYPE(one) == py::detail::npy_api::get().PyArray_Type_;
    };
    if (is_plain(value.ptr())) return false;
    if (PyList_CheckExact(value.ptr()) || PyTuple_CheckExact(value.ptr())) {
        const auto items = py::reinterpret_borrow<py::sequence>(value);
        bool all = true;
        for (std::size_t i = 0; all && i < items.size(); ++i) all = is_plain(py::object(items[i]).ptr());
        if (all) return false;
    }
    return py::module_::import("rbdyn.quantities").attr("has_unit")(value).cast<bool>();
}

py::array numpy_array(py::handle value, PyObject* type, int flags) {
    const auto& numpy = py::detail::npy_api::get();
    Py_XINCREF(type);
    PyObject* const array =
        numpy.PyArray_FromAny_(value.ptr(), type, 0, 0, py::detail::npy_api::NPY_ARRAY_ENSUREARRAY_ | flags, nullptr);
    if (array == nullptr) {
        // where memory ran out NumPy says for what
        if (PyErr_ExceptionMatches(PyExc_Exception) == 0 || PyErr_ExceptionMatches(PyExc_MemoryError) != 0)
            throw py::error_already_set();
        PyErr_Clear();
    }
    return py::reinterpret_steal<py::array>(array);
}

Array doubles(py::handle value, const std::string& object, const std::string& what) {
    if (has_parameters(value))
        throw InvalidInput(object + ": " + what + " is " + shown(value) +
                           ", and would stay at what the parameter is now; give its .value, and make anew what it is "
                           "in for each value");
    const auto refuse = [&] {
        throw InvalidInput(object + ": " + what + " is " + shown(value) + "; give numbers, or an array of numbers");
    };
    if (has_unit(value))
        throw InvalidInput(object + ": " + what + " is " + shown(value) + "; " +
                           py::module_::import("rbdyn.quantities").attr("RULE").cast<std::string>());
    const py::array array = numpy_array(value);
    if (!array) refuse();
    switch (array.dtype().kind()) {
        case 'b':
        case 'i':
        case 'u':
        case 'f': break;
        case 'O':
            // which NumPy would make NaN of
            for (const py::handle item : array.attr("flat"))
                if (item.is_none()) refuse();
            break;
        default: refuse();
    }
    const Array numbers = py::reinterpret_borrow<Array>(
        numpy_array(array, py::dtype::of<double>().ptr(), py::array::c_style | py::array::forcecast));
    if (!numbers) refuse();
    return numbers;
}

double number(py::handle value, const std::string& object, const std::string& what) {
    const Array array = doubles(value, object, what);
    if (array.ndim() != 0)
        throw InvalidInput(object + ": " + what + " has shape " + shape_of(array) + "; it is one number");
    return *array.data();
}

Vector3 vector3(py::handle value, const std::string& object, const std::string& what) {
    const Array array = doubles(value, object, what);
    if (array.ndim() != 1 || array.size() != 3)
        throw InvalidInput(object + ": " + what + " has shape " + shape_of(array) +
                           "; a vector has three components, as in [0, 0, 1]");
    return {array.at(0), array.at(1), array.at(2)};
}

Vector3 finite_vector3(py::handle value, const std::string& object, const std::string& what) {
    const Vector3 v = vector3(value, object, what);
    for (int i = 0; i < 3; ++i)
        rbdyn::require(std::isfinite(v[i]), object, "component " + std::to_string(i) + " of " + what, v[i],
                       "it is finite; give it in SI units");
    return v;
}

std::vector<Vector3> rows(py::handle value, const std::string& object, const std::string& what,
                          const std::string& rule) {
    const Array a = doubles(value, object, what);
    if (a.ndim() != 2 || a.shape(1) != 3)
        throw InvalidInput(object + ": " + what + " has shape " + shape_of(a) + "; it is (n, 3), " + rule);
    const double* const x = a.data();
    const auto count = static_cast<std::size_t>(a.shape(0));
    return unlocked([&] {
        std::vector<Vector3> result;
        result.reserve(count);
        for (std::size_t k = 0; k < count; ++k) {
            if (k % 1024 == 0) rbdyn::Interruption::point();
            result.emplace_back(x[3 * k], x[3 * k + 1], x[3 * k + 2]);
        }
        return result;
    });
}

std::vector<double> list_of_doubles(py::handle value, const std::string& object, const std::string& what) {
    const Array array = doubles(value, object, what);
    if (array.ndim() != 1)
        throw InvalidInput(object + ": " + what + " has shape " + shape_of(array) + "; it is a list of numbers");
    return {array.data(), array.data() + array.size()};
}

std::array<double, 2> pair_of(py::handle value, const std::string& object, const std::string& what) {
    const std::vector<double> values = list_of_doubles(value, object, what);
    if (values.size() != 2)
        throw InvalidInput(object + ": " + what + " has " + std::to_string(values.size()) +
                           " numbers; it is two, as in [0.5, 0]");
    return {values[0], values[1]};
}

Values over_both(const ArrayLike& first, const ArrayLike& second, const std::string& object, const char* a,
                 const char* b, FunctionRef<double, double, double> f) {
    Array x = doubles(first, object, a), y = doubles(second, object, b);
    for (py::ssize_t i = 1; i <= std::min(x.ndim(), y.ndim()); ++i) {
        const py::ssize_t m = x.shape(x.ndim() - i), n = y.shape(y.ndim() - i);
        if (m != n && m != 1 && n != 1)
            throw InvalidInput(object + ": " + a + " has shape " + shape_of(x) + " and " + b + " " + shape_of(y) +
                               "; give two of one shape, or a number and an array");
    }
    if (x.ndim() == 0 && y.ndim() == 0)
        return py::reinterpret_borrow<Values>(to_python(unlocked([&] { return f(*x.data(), *y.data()); })));
    // a number beside an array is read where it is; only what differs in shape is spread out first
    const bool is_plain = x.ndim() == 0 || y.ndim() == 0 ||
                          (x.ndim() == y.ndim() && std::equal(x.shape(), x.shape() + x.ndim(), y.shape()));
    if (!is_plain) {
        const py::sequence both = py::module_::import("numpy").attr("broadcast_arrays")(x, y);
        x = both[0].cast<Array>();
        y = both[1].cast<Array>();
    }
    const Array& larger = x.ndim() == 0 ? y : x;
    py::array_t<double> result(std::vector<py::ssize_t>(larger.shape(), larger.shape() + larger.ndim()));
    const double *in = x.data(), *other = y.data();
    const py::ssize_t stride = x.ndim() == 0 ? 0 : 1, other_stride = y.ndim() == 0 ? 0 : 1;
    double* const out = result.mutable_data();
    const py::ssize_t count = larger.size();
    unlocked([&] {
        for (py::ssize_t i = 0; i < count; ++i) {
            out[i] = f(in[i * stride], other[i * other_stride]);
            if (i % 64 == 0) rbdyn::Interruption::point();
        }
    });
    return py::reinterpret_borrow<Values>(result);
}

py::array_t<double> rows_of(const std::vector<Vector3>& vectors) {
    py::array_t<double> result({static_cast<py::ssize_t>(vectors.size()), py::ssize_t{3}});
    double* const out = result.mutable_data();
    unlocked([&] {
        for (std::size_t k = 0; k < vectors.size(); ++k) {
            if (k % 1024 == 0) rbdyn::Interruption::point();
            std::copy_n(vectors[k].data(), 3, out + 3 * k);
        }
    });
    return result;
}

std::string list_text(const Vector3& v) {
    return "[" + rbdyn::text(v[0]) + ", " + rbdyn::text(v[1]) + ", " + rbdyn::text(v[2]) + "]";
}

}  // namespace binding
