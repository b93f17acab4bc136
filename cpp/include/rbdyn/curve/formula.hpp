// What the formula of a recorded curve says of it, for all parameters at once: samples would miss what lies between.
//
// Each component is a polynomial in functions of the parameter that are taken as they are (sin u, |u|, a choice between
// formulas): sum of c_k m_k, m_k products of these. The curve is straight if the vectors c_k of all products but the
// constant are parallel; then r(u) = a + f(u) b. What is straight by an identity (sin^2 + cos^2) is not seen to be so.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/function.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

/// Coefficients of products of nodes; the product of none is the constant.
using ProductSum = std::map<std::vector<std::int32_t>, double>;

// longer ones are taken as they are, so that the work is bounded
inline constexpr std::size_t most_terms = 64, most_factors = 32;

/// a b; none if it is too long.
ProductSum product(const ProductSum& a, const ProductSum& b);

/// Whether all three results of a function of one input lie on a line, one that some of them move along.
bool is_on_line(const Function& r);

/// Whether a function of one input depends on it by sines and cosines alone.
bool is_of_angles(const Function& f);

/// Whether a function consists of several formulas, or of one that may have a corner: a root, a length, an angle.
bool may_have_corners(const Function& f);

}  // namespace rbdyn::inline RBDYN_FORM::curves
