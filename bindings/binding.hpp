// What the binding files share: arguments checked by the library's own rules, handles, values over arrays of times.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/typing.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <ostream>
#include <rbdyn/basics/error.hpp>
#include <rbdyn/basics/interruption.hpp>
#include <rbdyn/basics/vector.hpp>
#include <rbdyn/expression/callback.hpp>
#include <rbdyn/expression/given.hpp>
#include <rbdyn/expression/time_function.hpp>
#include <rbdyn/rotation/euler_angles.hpp>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

namespace rbdyn::inline RBDYN_FORM {
class Attitude;
class Curve;
}  // namespace rbdyn::inline RBDYN_FORM

namespace binding {

namespace py = pybind11;
using rbdyn::InvalidInput;
using rbdyn::Vector3;

// --- what Python's type checkers are told ---

inline bool any_object(PyObject*) { return true; }

/// A number of the user's, as Python has it (parameters.cpp).
py::object parameter_object(const rbdyn::Parameter& p);
/// The same if that is its value, else another one of its name.
py::object parameter_object(const rbdyn::Parameter& p, double value);
/// Throws InvalidInput: a number of the user's is given where a plain number is taken, in the user's line of source.
[[noreturn]] void refuse_parameter(py::handle value);

/// Anything NumPy makes an array of numbers from.
class ArrayLike : public py::object {
    PYBIND11_OBJECT_DEFAULT(ArrayLike, py::object, any_object)
};
/// A vector for one time, rows for several.
class Vectors : public py::object {
    PYBIND11_OBJECT_DEFAULT(Vectors, py::object, any_object)
};
/// A float for one time, an array for several.
class Values : public py::object {
    PYBIND11_OBJECT_DEFAULT(Values, py::object, any_object)
};
/// A vector, or a function that gives one.
class VectorOrFunction : public py::object {
    PYBIND11_OBJECT_DEFAULT(VectorOrFunction, py::object, any_object)
};
/// A number, or a function that gives one.
class NumberOrFunction : public py::object {
    PYBIND11_OBJECT_DEFAULT(NumberOrFunction, py::object, any_object)
};
/// A number, or one of the user's.
class NumberOrParameter : public py::object {
    PYBIND11_OBJECT_DEFAULT(NumberOrParameter, py::object, any_object)
};
/// A function that gives a rigid motion, or none.
class MotionOrNone : public py::object {
    PYBIND11_OBJECT_DEFAULT(MotionOrNone, py::object, any_object)
};
/// A quaternion, a matrix, EulerAngles, or a Rotation of scipy's.
class AttitudeLike : public py::object {
    PYBIND11_OBJECT_DEFAULT(AttitudeLike, py::object, any_object)
};
/// "com", "origin", or a point.
class PoleLike : public py::object {
    PYBIND11_OBJECT_DEFAULT(PoleLike, py::object, any_object)
};
/// A point or points, a function of time, a handle.
class MovingPole : public py::object {
    PYBIND11_OBJECT_DEFAULT(MovingPole, py::object, any_object)
};
/// A number, or a function of x, y, z.
class DensityLike : public py::object {
    PYBIND11_OBJECT_DEFAULT(DensityLike, py::object, any_object)
};
/// Three ranges, or functions that give them.
class BoundsLike : public py::object {
    PYBIND11_OBJECT_DEFAULT(BoundsLike, py::object, any_object)
};
/// "record", "stop", or a function.
class ActionName : public py::object {
    PYBIND11_OBJECT_DEFAULT(ActionName, py::object, any_object)
};
/// "after" or "before".
class SideName : public py::str {
    PYBIND11_OBJECT_DEFAULT(SideName, py::str, PyUnicode_Check)
};
/// Named tuples of python/rbdyn/frames.py.
class FrenetObject : public py::object {
    PYBIND11_OBJECT_DEFAULT(FrenetObject, py::object, any_object)
};
class PrincipalObject : public py::object {
    PYBIND11_OBJECT_DEFAULT(PrincipalObject, py::object, any_object)
};
class ImbalanceObject : public py::object {
    PYBIND11_OBJECT_DEFAULT(ImbalanceObject, py::object, any_object)
};
class AxisObject : public py::object {
    PYBIND11_OBJECT_DEFAULT(AxisObject, py::object, any_object)
};
class PointObject : public py::object {
    PYBIND11_OBJECT_DEFAULT(PointObject, py::object, any_object)
};
/// The class of python/rbdyn/sample.py.
class SampleObject : public py::object {
    PYBIND11_OBJECT_DEFAULT(SampleObject, py::object, any_object)
};
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

// --- arguments: what breaks a rule is an InvalidInput that names object, number, rule and fix ---

/// A string of Python's for messages: what UTF-8 cannot write, and zeros, as Python escapes them.
std::string plain(py::handle text);
/// repr(value), shortened.
std::string shown(py::handle value);
/// (3,), as Python writes it.
std::string shape_of(const py::array& array);
/// As an array of the flags and type given; none if it cannot be. Ctrl-C meanwhile, or a lack of memory, is no reason
/// for that, and goes on.
py::array numpy_array(py::handle value, PyObject* type = nullptr, int flags = 0);
/// Numbers of any shape.
Array doubles(py::handle value, const std::string& object, const std::string& what);
/// One number.
double number(py::handle value, const std::string& object, const std::string& what);
/// One number, or one of the user's by reference.
rbdyn::Given given(py::handle value, const std::string& object, const std::string& what);
/// What it was given as.
NumberOrParameter to_python(const rbdyn::Given& number);
std::string text(const rbdyn::Given& number);
/// Whether numbers of the user's are among those of a list or an array.
bool has_parameters(py::handle value);
/// The function of so many inputs that has numbers of the user's and others for its results, whatever the inputs.
rbdyn::Function function_of_numbers(py::handle value, int inputs, int results, const std::string& object,
                                    const std::string& what);
/// Three numbers that are finite.
Vector3 finite_vector3(py::handle value, const std::string& object, const std::string& what);
/// Three numbers.
Vector3 vector3(py::handle value, const std::string& object, const std::string& what);
/// A list of vectors, one a row; `rule` says of what.
std::vector<Vector3> rows(py::handle value, const std::string& object, const std::string& what,
                          const std::string& rule);
/// An attitude in any of its forms (attitude.cpp).
rbdyn::Attitude attitude(py::handle value, const std::string& object);
/// A list of numbers.
std::vector<double> list_of_doubles(py::handle value, const std::string& object, const std::string& what);
/// Two numbers.
std::array<double, 2> pair_of(py::handle value, const std::string& object, const std::string& what);

// --- functions of the user's: recorded, or called back (functions.cpp; recording.hpp for other kinds) ---

/// One of the two.
struct UserFunction {
    rbdyn::Function function;
    std::shared_ptr<const rbdyn::Callback> callback;
    std::string name;
};
// trace: none, recorded if it can be; true, recorded or InvalidInput says why not; false, called back

/// f(t, position, velocity), or f(t, x, y, z, vx, vy, vz) -> three components. 7 inputs, 3 results.
UserFunction user_force(const py::object& f, std::optional<bool> trace, const std::string& user);
/// f(t, rotation_matrix, angular_velocity) -> three components. 13 inputs, the matrix row by row; 3 results.
UserFunction user_torque(const py::object& f, std::optional<bool> trace, const std::string& user);
/// f(position), or f(x, y, z) -> a number. 3 inputs, 1 result.
UserFunction user_potential(const py::object& f, std::optional<bool> trace, const std::string& user);
/// f(distance) -> a number. 1 input, 1 result.
UserFunction user_central(const py::object& f, std::optional<bool> trace, const std::string& user);
/// f(t, r_a, r_b, v_a, v_b) -> three components. 13 inputs, 3 results.
UserFunction user_pair_force(const py::object& f, std::optional<bool> trace, const std::string& user);
/// f(t) -> three components. 1 input, 3 results.
UserFunction user_pole(const py::object& f, const std::string& user);
/// f(t) -> a number.
/// A load along a joint, of (t, q, rate).
UserFunction user_joint_load(const py::object& f, std::optional<bool> trace, const std::string& user);
UserFunction user_time_function(const py::object& f, std::optional<bool> trace, const std::string& user);
/// f(u) -> three components.
UserFunction user_curve(const py::object& f, std::optional<bool> trace, const std::string& user);
/// f(t) -> a displacement, a rotation matrix, both, or a homogeneous matrix. 1 input, 12 results: the matrix row by
/// row, then the displacement.
UserFunction user_motion(const py::object& f, std::optional<bool> trace, const std::string& user);
/// f(t, x) -> the rates of `variables` numbers. 1 + variables inputs, as many results as variables.
UserFunction user_rates(const py::object& f, int variables, std::optional<bool> trace, const std::string& user);

/// From f(t), recorded.
rbdyn::TimeFunction recorded_time_function(const py::object& f, const std::string& user);
/// From f(t, position, velocity) -> three components, recorded.
rbdyn::Function recorded_force(const py::object& f, const std::string& user);

/// A curve as an object of its own class.
py::object curve_object(const rbdyn::Curve& curve);

// --- words for the members of an enumeration ---

template <class E>
using Words = std::vector<std::pair<std::string, E>>;

/// The member a word stands for. Throws InvalidInput for any other word.
template <class E>
E one_of(const std::string& word, const Words<E>& words, const std::string& object, const std::string& what) {
    std::string list;
    for (const auto& [name, member] : words) {
        if (name == word) return member;
        list += (list.empty() ? "\"" : ", \"") + name + "\"";
    }
    throw InvalidInput(object + ": " + what + " is \"" + word + "\"; it is one of " + list);
}
template <class E>
std::string word_for(E member, const Words<E>& words) {
    for (const auto& [name, other] : words)
        if (other == member) return name;
    return {};
}

/// A member of an enumeration by its place, 0 to that of the last. Throws InvalidInput for any other number.
template <class E>
E member(int place, E last, const std::string& object, const std::string& what) {
    if (place < 0 || place > static_cast<int>(last))
        throw InvalidInput(object + ": in its data " + what + " is " + std::to_string(place) + "; it is from 0 to " +
                           std::to_string(static_cast<int>(last)));
    return static_cast<E>(place);
}

// --- results ---

/// The shape of one value.
template <class T>
inline const std::vector<py::ssize_t> shape_in_python = {};
template <>
inline const std::vector<py::ssize_t> shape_in_python<Vector3> = {3};
template <>
inline const std::vector<py::ssize_t> shape_in_python<std::array<double, 2>> = {2};
template <>
inline const std::vector<py::ssize_t> shape_in_python<rbdyn::EulerAngles> = {3};
template <>
inline const std::vector<py::ssize_t> shape_in_python<rbdyn::Quaternion> = {4};
template <>
inline const std::vector<py::ssize_t> shape_in_python<rbdyn::Matrix3> = {3, 3};

/// (3, 3)
py::array_t<double> to_array(const rbdyn::Matrix3& m);

inline void write(double*& out, double value) { *out++ = value; }
inline void write(double*& out, const Vector3& v) {
    for (int i = 0; i < 3; ++i) *out++ = v[i];
}
inline void write(double*& out, const std::array<double, 2>& pair) {
    for (const double x : pair) *out++ = x;
}
inline void write(double*& out, const rbdyn::EulerAngles& a) {
    for (const double x : {a.theta, a.psi, a.phi}) *out++ = x;
}
inline void write(double*& out, const rbdyn::Quaternion& q) {
    for (const double x : {q.w, q.x, q.y, q.z}) *out++ = x;
}
inline void write(double*& out, const rbdyn::Matrix3& m) {
    for (int i = 0; i < 9; ++i) *out++ = m(i / 3, i % 3);
}

inline py::object to_python(double value) { return py::float_(value); }
template <class T>
py::object to_python(const T& value) {
    py::array_t<double> result(shape_in_python<T>);
    double* out = result.mutable_data();
    write(out, value);
    return result;
}

/// As long as it lives its thread is without Python's lock, so that other threads run, unless it keeps that; and what
/// takes long asks now and then (rbdyn::Interruption) whether a signal has come: Ctrl-C ends it, with
/// KeyboardInterrupt.
class Unlocked {
public:
    explicit Unlocked(bool unlocks = true) : asked_(&ask) {
        if (unlocks) free_.emplace();
    }

private:
    static void ask() {
        const py::gil_scoped_acquire lock;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    }

    rbdyn::Interruption asked_;
    std::optional<py::gil_scoped_release> free_;
};

/// What f returns, computed so.
template <class F>
auto unlocked(F&& f) {
    const Unlocked here;
    return f();
}

/// A function that outlives the call it is handed to, without its type: what runs over arrays is compiled once for each
/// kind of result, and not for each function.
template <class Result, class... Arguments>
class FunctionRef {
public:
    template <class F>
    requires(!std::is_same_v<F, FunctionRef>) FunctionRef(const F& f)
        : f_(&f),
          call_([](const void* own, Arguments... x) -> Result { return (*static_cast<const F*>(own))(x...); }) {}
    Result operator()(Arguments... x) const { return call_(f_, x...); }

private:
    const void* f_;
    Result (*call_)(const void*, Arguments...);
};

/// Values at one argument, or at each of an array of them; the components of a vector or a matrix come last.
template <class Result>
auto values_over(const ArrayLike& argument, const char* object, const char* what, FunctionRef<Result, double> f) {
    using Returned = std::conditional_t<std::is_same_v<Result, double>, Values, Vectors>;
    const auto one = [&](double x) {
        return py::reinterpret_borrow<Returned>(to_python(unlocked([&] { return f(x); })));
    };
    if (PyFloat_Check(argument.ptr())) return one(PyFloat_AS_DOUBLE(argument.ptr()));
    const Array x = doubles(argument, object, what);
    if (x.ndim() == 0) return one(*x.data());
    std::vector<py::ssize_t> shape(x.shape(), x.shape() + x.ndim());
    shape.insert(shape.end(), shape_in_python<Result>.begin(), shape_in_python<Result>.end());
    py::array_t<double> result(shape);
    double* out = result.mutable_data();
    const double* in = x.data();
    const py::ssize_t count = x.size();
    unlocked([&] {
        for (py::ssize_t i = 0; i < count; ++i) {
            write(out, f(in[i]));
            if (i % 64 == 0) rbdyn::Interruption::point();
        }
    });
    return py::reinterpret_borrow<Returned>(result);
}

/// The same of any function.
template <class F>
auto over(const ArrayLike& argument, const char* object, const char* what, const F& f) {
    return values_over<std::decay_t<std::invoke_result_t<const F&, double>>>(argument, object, what, f);
}

/// Throws InvalidInput unless all numbers of a value are finite: what it is, and the rule, are asked for only then.
template <class T>
void require_finite(const T& value, const char* object, FunctionRef<std::string> what, FunctionRef<std::string> rule) {
    double numbers[9];
    double* end = numbers;
    write(end, value);
    for (const double* x = numbers; x != end; ++x)
        if (!std::isfinite(*x)) rbdyn::refuse(object, what(), *x, rule());
}

/// The same as over() of a quantity that is finite wherever its argument is, but where numbers leave doubles: what is
/// not finite is refused.
template <class F>
auto finite_over(const ArrayLike& argument, const char* object, const char* what, const char* quantity, const F& f,
                 FunctionRef<std::string> rule) {
    return over(argument, object, what, [&](double x) {
        rbdyn::require(std::isfinite(x), object, what, x, "it is finite");
        const auto value = f(x);
        require_finite(
            value, object, [&] { return quantity + std::string(" at ") + what + " " + rbdyn::text(x); }, rule);
        return value;
    });
}

/// f at two arguments, numbers or arrays that are broadcast.
Values over_both(const ArrayLike& first, const ArrayLike& second, const std::string& object, const char* a,
                 const char* b, FunctionRef<double, double, double> f);

/// What operator<< writes, without its last end of line.
template <class T>
std::string printed(const T& value) {
    std::ostringstream out;
    out << value;
    std::string text = out.str();
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return text;
}

/// [1, 2, 3]
std::string list_text(const Vector3& v);
/// Vectors, one a row.
py::array_t<double> rows_of(const std::vector<Vector3>& vectors);

// --- one function a file ---

void bind_attitude(py::module_& m);
void bind_poinsot(py::module_& m);
void bind_bodies(py::module_& m);
void bind_constraints(py::module_& m);
void bind_couplings(py::module_& m);
void bind_curves(py::module_& m);
void bind_expressions(py::module_& m);
void bind_functions(py::module_& m);
void bind_joints(py::module_& m);
void bind_loads(py::module_& m);
void bind_many(py::module_& m);
void bind_parameters(py::module_& m);
void bind_rails(py::module_& m);
void bind_scene(py::module_& m);
void bind_plan(py::module_& m);
void bind_statics(py::module_& m);
void bind_trajectory(py::module_& m);
void bind_system(py::module_& m);
void bind_tree_joints(py::module_& m);
void bind_euler_top(py::module_& m);
void bind_cost(py::module_& m);
void bind_verbs(py::module_& m);
void bind_files(py::module_& m);
void bind_watch(py::module_& m);

}  // namespace binding

namespace pybind11::detail {
/// As pybind11's own, but for bytes: what is a text, as a name, is given as one.
template <>
struct type_caster<std::string> : string_caster<std::string> {
    bool load(handle source, bool convert) {
        return source && PyUnicode_Check(source.ptr()) != 0 && string_caster<std::string>::load(source, convert);
    }
};
/// As pybind11's own, but for numbers of the user's: their value would be taken once, for good.
template <>
struct type_caster<double> {
    bool load(handle source, bool convert) {
        if (!source) return false;
        if (PyFloat_CheckExact(source.ptr())) {
            value = PyFloat_AS_DOUBLE(source.ptr());
            return true;
        }
        if (isinstance<rbdyn::Parameter>(source)) binding::refuse_parameter(source);
        if (!convert && !PyFloat_Check(source.ptr()) && !PyLong_Check(source.ptr())) return false;
        value = PyFloat_AsDouble(source.ptr());
        if (value != -1.0 || PyErr_Occurred() == nullptr) return true;
        PyErr_Clear();
        return false;
    }
    static handle cast(double number, return_value_policy, handle) { return PyFloat_FromDouble(number); }
    PYBIND11_TYPE_CASTER(double, io_name("typing.SupportsFloat | typing.SupportsIndex", "float"));
};
template <>
struct handle_type_name<binding::ArrayLike> {
    static constexpr auto name = const_name("numpy.typing.ArrayLike");
};
template <>
struct handle_type_name<binding::Vectors> {
    static constexpr auto name = const_name("numpy.typing.NDArray[numpy.float64]");
};
template <>
struct handle_type_name<binding::Values> {
    static constexpr auto name = const_name("float | numpy.typing.NDArray[numpy.float64]");
};
template <>
struct handle_type_name<binding::VectorOrFunction> {
    static constexpr auto name = const_name("numpy.typing.ArrayLike | collections.abc.Callable");
};
template <>
struct handle_type_name<binding::NumberOrFunction> {
    static constexpr auto name = const_name("float | collections.abc.Callable");
};
template <>
struct handle_type_name<binding::NumberOrParameter> {
    static constexpr auto name = const_name("float | rbdyn._core.Parameter");
};
template <>
struct handle_type_name<binding::MotionOrNone> {
    static constexpr auto name = const_name("collections.abc.Callable | None");
};
template <>
struct handle_type_name<binding::ActionName> {
    static constexpr auto name = const_name("str | collections.abc.Callable");
};
template <>
struct handle_type_name<binding::FrenetObject> {
    static constexpr auto name = const_name("rbdyn.frames.Frenet");
};
template <>
struct handle_type_name<binding::PointObject> {
    static constexpr auto name = const_name("rbdyn.frames.PointMotion");
};
template <>
struct handle_type_name<binding::AxisObject> {
    static constexpr auto name = const_name("rbdyn.frames.Axis");
};
template <>
struct handle_type_name<binding::SampleObject> {
    static constexpr auto name = const_name("rbdyn.sample.Sample");
};
template <>
struct handle_type_name<binding::SideName> {
    static constexpr auto name = const_name("typing.Literal['after', 'before']");
};
template <>
struct handle_type_name<binding::AttitudeLike> {
    static constexpr auto name =
        const_name("numpy.typing.ArrayLike | rbdyn._core.EulerAngles | scipy.spatial.transform.Rotation");
};
template <>
struct handle_type_name<binding::PoleLike> {
    static constexpr auto name = const_name("str | numpy.typing.ArrayLike");
};
template <>
struct handle_type_name<binding::MovingPole> {
    static constexpr auto name = const_name(
        "numpy.typing.ArrayLike | collections.abc.Callable | rbdyn._core.BodyHandle | rbdyn._core.BodyPoint");
};
template <>
struct handle_type_name<binding::DensityLike> {
    static constexpr auto name = const_name("float | collections.abc.Callable");
};
template <>
struct handle_type_name<binding::BoundsLike> {
    static constexpr auto name = const_name("collections.abc.Sequence");
};
template <>
struct handle_type_name<binding::PrincipalObject> {
    static constexpr auto name = const_name("rbdyn.frames.PrincipalAxes");
};
template <>
struct handle_type_name<binding::ImbalanceObject> {
    static constexpr auto name = const_name("rbdyn.frames.Imbalance");
};
}  // namespace pybind11::detail
