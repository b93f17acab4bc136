// The weights of a program for given parameters, in any type of numbers.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/program.hpp"

namespace rbdyn::inline RBDYN_FORM {

template <class T>
void Program::set_parameters(std::span<const T> parameters, std::vector<T>& scalars, Rounding rounding) const {
    using std::asinh, std::atan2, std::atanh, std::cos, std::cosh, std::exp, std::expm1, std::log, std::log1p, std::pow,
        std::sin, std::sinh, std::sqrt, std::tanh;
    scalars.clear();
    scalars.reserve(constants_.size());
    const auto rounded = [rounding](T hi, T lo) {
        if constexpr (std::is_floating_point_v<T>) {
            const T nearest = hi + lo, rest = lo - (nearest - hi);
            if (rounding == Rounding::nearest || rest == T(0)) return nearest;
            const T beyond = std::numeric_limits<T>::infinity();
            return std::nextafter(nearest, rest > T(0) ? beyond : -beyond);
        } else {
            return hi + lo;  // all their digits
        }
    };
    for (const DoubleDouble& c : constants_) scalars.push_back(rounded(static_cast<T>(c.hi), static_cast<T>(c.lo)));
    const auto count = static_cast<std::size_t>(parameters_);
    for (const ScalarStep& s : scalar_steps_) {
        T& out = scalars[static_cast<std::size_t>(s.out)];
        if (s.operation == Operation::parameter) {
            const auto index = static_cast<std::size_t>(s.a);
            out = parameters.size() > count ? rounded(parameters[index], parameters[count + index]) : parameters[index];
            continue;
        }
        const T a = scalars[static_cast<std::size_t>(s.a)];
        const T b = s.b >= 0 ? scalars[static_cast<std::size_t>(s.b)] : T(0);
        switch (s.operation) {
            case Operation::add: out = a + b; break;
            case Operation::multiply: out = a * b; break;
            case Operation::divide: out = a / b; break;
            case Operation::square_root: out = sqrt(a); break;
            case Operation::norm: {
                const T c = scalars[static_cast<std::size_t>(s.c)];
                out = sqrt(a * a + b * b + c * c);
                break;
            }
            case Operation::sine: out = sin(a); break;
            case Operation::cosine: out = cos(a); break;
            case Operation::hyperbolic_sine: out = sinh(a); break;
            case Operation::hyperbolic_cosine: out = cosh(a); break;
            case Operation::hyperbolic_tangent: out = tanh(a); break;
            case Operation::angle: out = atan2(a, b); break;
            case Operation::exponential: out = exp(a); break;
            case Operation::logarithm: out = log(a); break;
            case Operation::expm1: out = expm1(a); break;
            case Operation::log1p: out = log1p(a); break;
            case Operation::arsinh: out = asinh(a); break;
            case Operation::artanh: out = atanh(a); break;
            case Operation::raise: out = pow(a, b); break;
            case Operation::power: out = pow(a, T(s.value)); break;
            default: break;
        }
    }
}

}  // namespace rbdyn::inline RBDYN_FORM
