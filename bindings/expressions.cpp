// The number type that Python functions are recorded with, and conditions on it.
//
// NumPy hands whole arrays of expressions to python/rbdyn/tracing.py, which applies the functions of `_functions`
// element by element. In arrays that a function makes itself (np.array([x, y])) NumPy asks each element for a method of
// the function's name instead: x.sin(), x.sqrt().
#include <cmath>
#include <functional>
#include <numbers>
#include <rbdyn/expression/condition.hpp>
#include <utility>

#include "recording.hpp"

namespace binding {

using rbdyn::Condition;
using rbdyn::Node;
using rbdyn::Operation;
using rbdyn::Recorder;

namespace {

/// The factors of a node, constants apart, which are multiplied into `weight`.
void factors(const Recorder& recorder, std::int32_t index, double& weight, std::map<std::int32_t, int>& found) {
    const Node& node = recorder.node(index);
    if (node.operation == Operation::constant) {
        weight *= node.value;
    } else if (node.operation == Operation::multiply && node.a != node.b) {
        factors(recorder, node.a, weight, found);
        factors(recorder, node.b, weight, found);
    } else {
        found[node.operation == Operation::multiply ? node.a : index] += node.operation == Operation::multiply ? 2 : 1;
    }
}

/// Whether a node is a sum of squares with positive weights; the roots of its terms go to `roots`.
bool is_sum_of_squares(Recorder& recorder, std::int32_t index, std::vector<Expression>& roots) {
    const Node node = recorder.node(index);
    if (node.operation == Operation::add)
        return is_sum_of_squares(recorder, node.a, roots) && is_sum_of_squares(recorder, node.b, roots);
    if (node.operation != Operation::multiply) return false;
    double weight = 1.0;
    std::map<std::int32_t, int> found;
    factors(recorder, index, weight, found);
    if (!(weight > 0.0)) return false;
    Expression root = std::sqrt(weight);
    for (const auto& [factor, times] : found) {
        if (times % 2 != 0) return false;
        for (int k = 0; k < times / 2; ++k) root = root * Expression(&recorder, factor);
    }
    roots.push_back(root);
    return true;
}

/// The length of any number of components.
Expression length_of(const std::vector<Expression>& parts) {
    const auto part = [&](std::size_t i) { return i < parts.size() ? parts[i] : Expression(0.0); };
    Expression sum = part(0);
    for (std::size_t i = 1; i == 1 || i < parts.size(); i += 2)
        sum = length(rbdyn::Vector3Of<Expression>{sum, part(i), part(i + 1)});
    return sum;
}

/// The square root; of a sum of squares a length, whose zero is a switching point.
Expression root(const Expression& x) {
    std::vector<Expression> parts;
    if (x.is_constant() || !is_sum_of_squares(*x.recorder(), x.node(), parts)) return sqrt(x);
    return length_of(parts);
}

Expression raised(const Expression& x, const Expression& n) {
    if (!n.is_constant() && x.is_constant() && !(x.value() > 0.0))
        throw InvalidInput("the base of a power is " + rbdyn::text(x.value()) +
                           "; with an exponent that varies it is positive");
    return pow(x, n);
}

Expression ceiling(const Expression& x) { return -floor(-x); }
Expression truncated(const Expression& x) {
    return select(
        x, [&] { return floor(x); }, [&] { return ceiling(x); }, {});
}
Expression quotient_below(const Expression& x, const Expression& y) { return floor(x / y); }
Expression remainder(const Expression& x, const Expression& y) { return x - y * floor(x / y); }
Expression natural_remainder(const Expression& x, const Expression& y) { return x - y * truncated(x / y); }
/// One of three by the sign of x: what stays at zero has the middle one.
Expression by_sign(const Expression& x, double below, double at_zero, double above, const std::string& name) {
    const auto constant = [](double value) { return [value] { return Expression(value); }; };
    return (x > 0.0).choose(
        constant(above), [&] { return (x < 0.0).choose(constant(below), constant(at_zero), name); }, name);
}
Expression sign(const Expression& x) { return by_sign(x, -1.0, 0.0, 1.0, "sign"); }
Expression heaviside(const Expression& x, const Expression& at_zero) {
    if (!at_zero.is_constant()) throw InvalidInput("the value of np.heaviside at zero is a number that is known");
    return by_sign(x, 0.0, at_zero.value(), 1.0, "heaviside");
}

using Unary = Expression (*)(const Expression&);
using Binary = Expression (*)(const Expression&, const Expression&);
using Comparison = Condition (*)(const Expression&, const Expression&);

constexpr double degree = std::numbers::pi / 180.0;

// by NumPy's names
const std::pair<const char*, Unary> unary_functions[] = {
    {"negative", [](const Expression& x) { return -x; }},
    {"positive", [](const Expression& x) { return x; }},
    {"conjugate", [](const Expression& x) { return x; }},
    {"absolute", [](const Expression& x) { return abs(x); }},
    {"fabs", [](const Expression& x) { return abs(x); }},
    {"sign", sign},
    {"square", [](const Expression& x) { return x * x; }},
    {"reciprocal", [](const Expression& x) { return 1.0 / x; }},
    {"sqrt", root},
    {"cbrt", [](const Expression& x) { return cbrt(x); }},
    {"sin", [](const Expression& x) { return sin(x); }},
    {"cos", [](const Expression& x) { return cos(x); }},
    {"tan", [](const Expression& x) { return tan(x); }},
    {"arcsin", [](const Expression& x) { return asin(x); }},
    {"arccos", [](const Expression& x) { return acos(x); }},
    {"arctan", [](const Expression& x) { return atan(x); }},
    {"sinh", [](const Expression& x) { return sinh(x); }},
    {"cosh", [](const Expression& x) { return cosh(x); }},
    {"tanh", [](const Expression& x) { return tanh(x); }},
    {"arcsinh", [](const Expression& x) { return asinh(x); }},
    {"arccosh", [](const Expression& x) { return acosh(x); }},
    {"arctanh", [](const Expression& x) { return atanh(x); }},
    {"exp", [](const Expression& x) { return exp(x); }},
    {"exp2", [](const Expression& x) { return pow(Expression(2.0), x); }},
    {"expm1", [](const Expression& x) { return expm1(x); }},
    {"log", [](const Expression& x) { return log(x); }},
    {"log2", [](const Expression& x) { return log(x) * std::numbers::log2e; }},
    {"log10", [](const Expression& x) { return log(x) * std::numbers::log10e; }},
    {"log1p", [](const Expression& x) { return log1p(x); }},
    {"deg2rad", [](const Expression& x) { return degree * x; }},
    {"radians", [](const Expression& x) { return degree * x; }},
    {"rad2deg", [](const Expression& x) { return x / degree; }},
    {"degrees", [](const Expression& x) { return x / degree; }},
    {"floor", [](const Expression& x) { return floor(x); }},
    {"ceil", ceiling},
    {"trunc", truncated},
    {"rint", [](const Expression& x) { return floor(x + 0.5); }},
};

const std::pair<const char*, Binary> binary_functions[] = {
    {"add", [](const Expression& x, const Expression& y) { return x + y; }},
    {"subtract", [](const Expression& x, const Expression& y) { return x - y; }},
    {"multiply", [](const Expression& x, const Expression& y) { return x * y; }},
    {"divide", [](const Expression& x, const Expression& y) { return x / y; }},
    {"power", raised},
    {"float_power", raised},
    {"floor_divide", quotient_below},
    {"remainder", remainder},
    {"fmod", natural_remainder},
    {"arctan2", [](const Expression& x, const Expression& y) { return atan2(x, y); }},
    {"hypot",
     [](const Expression& x, const Expression& y) {
         return length(rbdyn::Vector3Of<Expression>{x, y, 0.0});
     }},
    {"maximum", [](const Expression& x, const Expression& y) { return max(x, y); }},
    {"minimum", [](const Expression& x, const Expression& y) { return min(x, y); }},
    {"fmax", [](const Expression& x, const Expression& y) { return max(x, y); }},
    {"fmin", [](const Expression& x, const Expression& y) { return min(x, y); }},
    {"copysign", [](const Expression& x, const Expression& y) { return abs(x) * locked_sign(y, "copysign"); }},
    {"heaviside", heaviside},
};

const std::pair<const char*, Comparison> comparisons[] = {
    {"greater", [](const Expression& x, const Expression& y) { return x > y; }},
    {"less", [](const Expression& x, const Expression& y) { return x < y; }},
    {"greater_equal", [](const Expression& x, const Expression& y) { return x >= y; }},
    {"less_equal", [](const Expression& x, const Expression& y) { return x <= y; }},
};

py::object not_implemented() { return py::reinterpret_borrow<py::object>(Py_NotImplemented); }

Expression number_of(py::handle x) {
    const auto value = operand(x);
    if (!value) throw py::type_error(shown(x) + " is no number; functions of a recorded number take numbers beside it");
    return *value;
}

/// What a Python object says beside a condition; nothing if it is neither condition nor bool.
std::optional<Condition> statement(py::handle x) {
    if (py::isinstance<RecordedCondition>(x)) {
        const auto& c = x.cast<const RecordedCondition&>();
        live({0.0, c.recording});
        return c.value;
    }
    if (PyBool_Check(x.ptr())) return Condition(x.ptr() == Py_True);
    if (std::string(Py_TYPE(x.ptr())->tp_name).starts_with("numpy.bool"))
        return Condition(PyObject_IsTrue(x.ptr()) == 1);
    return std::nullopt;
}
Condition statement_of(py::handle x) {
    if (const auto c = statement(x)) return *c;
    throw py::type_error(shown(x) + " is no condition; compare numbers, as in x > 0");
}

/// f(x, y) for Python's operators, and f(y, x) where the expression stands on the right.
template <class F>
auto operation(F f) {
    return [f](const Recorded& x, const py::object& y) -> py::object {
        const auto other = operand(y, x.recording);
        if (!other) return not_implemented();
        return recorded_number(f(live(x), *other), x.recording);
    };
}
template <class F>
auto reversed(F f) {
    return operation([f](const Expression& x, const Expression& y) { return f(y, x); });
}
py::object condition(const Condition& value, const std::shared_ptr<Recording>& recording) {
    return py::cast(RecordedCondition{value, recording});
}
template <class F>
auto compared(F f) {
    return [f](const Recorded& x, const py::object& y) -> py::object {
        const auto other = operand(y, x.recording);
        if (!other) return not_implemented();
        return condition(f(live(x), *other), x.recording);
    };
}

/// x == y, where that is known.
py::object equal(const Recorded& x, const py::object& y, bool wanted) {
    const auto other = operand(y, x.recording);
    if (!other) return not_implemented();
    const Expression margin = live(x) - *other;
    const auto known = margin.is_constant() ? std::optional(margin.value() == 0.0) : x.recording->is_zero(margin);
    if (!known) x.recording->refuse("equality");
    return py::bool_(*known == wanted);
}

/// The condition as a number, 1 or 0.
Expression as_number(const RecordedCondition& c) { return where(c.value, 1.0, 0.0); }

std::shared_ptr<Recording> under_way() {
    Recording* r = Recording::current();
    if (r == nullptr) throw InvalidInput("Expression: no function is being recorded; it is used inside one");
    return r->shared_from_this();
}

/// NumPy's functions of numbers and conditions, by name.
py::dict table() {
    py::dict functions;
    for (const auto& [name, f] : unary_functions)
        functions[name] =
            py::cpp_function([f = f](py::handle x) { return recorded_number(f(number_of(x)), under_way()); });
    for (const auto& [name, f] : binary_functions)
        functions[name] = py::cpp_function([f = f](py::handle x, py::handle y) {
            return recorded_number(f(number_of(x), number_of(y)), under_way());
        });
    for (const auto& [name, f] : comparisons)
        functions[name] = py::cpp_function(
            [f = f](py::handle x, py::handle y) { return condition(f(number_of(x), number_of(y)), under_way()); });
    functions["equal"] = py::cpp_function([](py::handle x, py::handle y) {
        return equal({number_of(x), under_way()}, py::reinterpret_borrow<py::object>(y), true);
    });
    functions["not_equal"] = py::cpp_function([](py::handle x, py::handle y) {
        return equal({number_of(x), under_way()}, py::reinterpret_borrow<py::object>(y), false);
    });
    const auto both = [](py::handle a, py::handle b) {
        return condition(statement_of(a) & statement_of(b), under_way());
    };
    const auto either = [](py::handle a, py::handle b) {
        return condition(statement_of(a) | statement_of(b), under_way());
    };
    const auto one = [](py::handle a, py::handle b) {
        return condition(statement_of(a) ^ statement_of(b), under_way());
    };
    const auto opposite = [](py::handle a) { return condition(!statement_of(a), under_way()); };
    for (const char* kind : {"logical_", "bitwise_"}) {
        functions[(kind + std::string("and")).c_str()] = py::cpp_function(both);
        functions[(kind + std::string("or")).c_str()] = py::cpp_function(either);
        functions[(kind + std::string("xor")).c_str()] = py::cpp_function(one);
    }
    for (const char* name : {"logical_not", "invert"}) functions[name] = py::cpp_function(opposite);
    // numbers are finite while a motion is
    functions["isfinite"] = py::cpp_function([](py::handle) { return true; });
    for (const char* name : {"isnan", "isinf"}) functions[name] = py::cpp_function([](py::handle) { return false; });
    functions["signbit"] = py::cpp_function([](py::handle x) { return condition(number_of(x) < 0.0, under_way()); });
    return functions;
}

py::object numpy_hook(const char* name, const py::args& args, const py::kwargs& kwargs) {
    return py::module_::import("rbdyn.tracing").attr(name)(*args, **kwargs);
}

}  // namespace

void bind_expressions(py::module_& m) {
    py::class_<RecordedCondition> conditions(m, "Condition",
                                             R"(A comparison of recorded numbers, or several joined by & | ~ ^.

where(condition, a, b) and np.where choose by it. An `if` on it records both sides: the function is called again for
the other one.)");
    py::class_<Recorded> expression(
        m, "Expression",
        R"(A number that is being recorded: what a function of the user's is called with instead of a float.

Arithmetic and NumPy's functions are recorded. A comparison gives a Condition. Changes of formula (an `if`, np.where,
abs, a length at zero, floor) become events that are located. Its value is not known: float(), == and the functions of
math raise InvalidInput.)");

    expression.def("__add__", operation(binary_functions[0].second))
        .def("__radd__", reversed(binary_functions[0].second))
        .def("__sub__", operation(binary_functions[1].second))
        .def("__rsub__", reversed(binary_functions[1].second))
        .def("__mul__", operation(binary_functions[2].second))
        .def("__rmul__", reversed(binary_functions[2].second))
        .def("__truediv__", operation(binary_functions[3].second))
        .def("__rtruediv__", reversed(binary_functions[3].second))
        .def("__pow__", operation(raised))
        .def("__rpow__", reversed(raised))
        .def("__mod__", operation(remainder))
        .def("__rmod__", reversed(remainder))
        .def("__floordiv__", operation(quotient_below))
        .def("__rfloordiv__", reversed(quotient_below));
    const auto whole_and_rest = [](const Recorded& r, const Expression& x, const Expression& y) {
        const Expression n = quotient_below(x, y);
        return py::make_tuple(recorded_number(n, r.recording), recorded_number(x - y * n, r.recording));
    };
    expression
        .def("__divmod__",
             [=](const Recorded& x, const py::object& y) -> py::object {
                 const auto other = operand(y, x.recording);
                 return other ? whole_and_rest(x, live(x), *other) : not_implemented();
             })
        .def("__rdivmod__", [=](const Recorded& x, const py::object& y) -> py::object {
            const auto other = operand(y, x.recording);
            return other ? whole_and_rest(x, *other, live(x)) : not_implemented();
        });

    for (const auto& [name, f] : unary_functions)
        expression.def(
            name,
            [f = f](const Recorded& x) {
                return Recorded{f(live(x)), x.recording};
            },
            ("numpy." + std::string(name) + " of it.").c_str());
    for (const auto& [name, f] : binary_functions)
        if (std::string(name) == "arctan2" || std::string(name) == "hypot" || std::string(name) == "fmod")
            expression.def(name, operation(f), ("numpy." + std::string(name) + " of it and another.").c_str());
    const std::pair<const char*, const char*> operators[] = {{"__neg__", "negative"}, {"__pos__", "positive"},
                                                             {"__abs__", "absolute"}, {"__floor__", "floor"},
                                                             {"__ceil__", "ceil"},    {"__trunc__", "trunc"}};
    for (const auto& [name, same] : operators)
        for (const auto& [known, f] : unary_functions)
            if (std::string(known) == same)
                expression.def(name, [f = f](const Recorded& x) { return Recorded{f(live(x)), x.recording}; });
    expression.def(
        "__round__",
        [](const Recorded& x, int digits) {
            const double unit = std::pow(10.0, digits);
            return Recorded{floor(live(x) * unit + 0.5) / unit, x.recording};
        },
        py::arg("digits") = 0);

    expression.def("__gt__", compared(comparisons[0].second))
        .def("__lt__", compared(comparisons[1].second))
        .def("__ge__", compared(comparisons[2].second))
        .def("__le__", compared(comparisons[3].second))
        .def("__eq__", [](const Recorded& x, const py::object& y) { return equal(x, y, true); })
        .def("__ne__", [](const Recorded& x, const py::object& y) { return equal(x, y, false); });
    expression.attr("__hash__") = py::none();

    // what asks for the value
    expression
        .def("__bool__",
             [](const Recorded& x) {
                 const auto zero =
                     live(x).is_constant() ? std::optional(x.value.is_zero()) : x.recording->is_zero(x.value);
                 if (!zero) x.recording->refuse("truth");
                 return !*zero;
             })
        .def("__float__",
             [](const Recorded& x) {
                 if (!live(x).is_constant()) x.recording->refuse("value");
                 return x.value.value();
             })
        .def("__int__", [](const Recorded& x) {
            if (!live(x).is_constant()) x.recording->refuse("whole");
            return static_cast<long>(x.value.value());
        });
    expression.def("__repr__", [](const Recorded& x) {
        return x.value.is_constant() ? "Expression(" + rbdyn::text(x.value.value()) + ")" : std::string("Expression");
    });

    // a condition: logic, a number where one is wanted, and the question itself
    const auto joined = [&](const char* name, const char* swapped, auto f) {
        const auto bound = [f](const RecordedCondition& a, const py::object& b) -> py::object {
            const auto other = statement(b);
            return other ? condition(f(a.value, *other), a.recording) : not_implemented();
        };
        conditions.def(name, bound).def(swapped, bound);
    };
    joined("__and__", "__rand__", [](const Condition& a, const Condition& b) { return a & b; });
    joined("__or__", "__ror__", [](const Condition& a, const Condition& b) { return a | b; });
    joined("__xor__", "__rxor__", [](const Condition& a, const Condition& b) { return a ^ b; });
    conditions.def("__invert__", [](const RecordedCondition& c) { return condition(!c.value, c.recording); })
        .def(
            "logical_not", [](const RecordedCondition& c) { return condition(!c.value, c.recording); },
            "Whether it does not hold.")
        .def("__bool__",
             [](const RecordedCondition& c) {
                 live({0.0, c.recording});
                 return c.value.holds([&](const Expression& margin) { return c.recording->is_positive(margin); });
             })
        .def("__repr__", [](const RecordedCondition&) { return "Condition"; });
    const auto counted = [&](const char* name, auto f) {
        conditions.def(name, [f](const RecordedCondition& c, const py::object& y) {
            return f(recorded_number(as_number(c), c.recording), y);
        });
    };
    counted("__add__", [](const py::object& c, const py::object& y) { return c + y; });
    counted("__radd__", [](const py::object& c, const py::object& y) { return y + c; });
    counted("__sub__", [](const py::object& c, const py::object& y) { return c - y; });
    counted("__rsub__", [](const py::object& c, const py::object& y) { return y - c; });
    counted("__mul__", [](const py::object& c, const py::object& y) { return c * y; });
    counted("__rmul__", [](const py::object& c, const py::object& y) { return y * c; });
    counted("__truediv__", [](const py::object& c, const py::object& y) { return c / y; });

    for (auto* c : {static_cast<py::object*>(&expression), static_cast<py::object*>(&conditions)}) {
        c->attr("__array_ufunc__") = py::cpp_function(
            [](const py::object&, const py::args& a, const py::kwargs& k) { return numpy_hook("array_ufunc", a, k); },
            py::is_method(*c), py::name("__array_ufunc__"));
        c->attr("__array_function__") =
            py::cpp_function([](const py::object&, const py::args& a,
                                const py::kwargs& k) { return numpy_hook("array_function", a, k); },
                             py::is_method(*c), py::name("__array_function__"));
    }

    m.attr("_functions") = table();
    m.def(
        "_where",
        [](py::handle c, py::handle a, py::handle b, const std::string& name) {
            const Expression x = number_of(a), y = number_of(b);
            return recorded_number(statement_of(c).choose([&] { return x; }, [&] { return y; }, name), under_way());
        },
        py::arg("condition"), py::arg("a"), py::arg("b"), py::arg("name") = "where");
    m.def(
        "_length",
        [](const std::vector<py::object>& parts) {
            std::vector<Expression> x;
            for (const py::object& part : parts) x.push_back(number_of(part));
            return recorded_number(length_of(x), under_way());
        },
        py::arg("parts"));
}

}  // namespace binding
