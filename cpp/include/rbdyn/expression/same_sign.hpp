// Functions that are simpler than a given one, and have its sign in their product.
//
// Where a watched function passes zero its sign alone matters. A cube root has the sign of what is under it, a power
// with an odd exponent that of its base, one with an even exponent that of the square; sinh, tanh, their
// inverses and arctan have the sign of their argument, the root of what is not negative that of what is under it; what
// is positive can be left out of a product. And the sign of a product is that of its factors, each watched alone:
// cbrt((x - a)^5 (x - b)^5) is x - a and x - b, with no root of infinite slope, none of an order that rounding hides,
// none beside another; and |f| is f^2, a distinction less.
//
// A quotient stays what it is unless what is below is never zero: with what is above it a pole may be a jump or a root.
//
// What is never negative passes nothing, and is 1.
//
// Invariant: the function and the product are negative, zero and positive at the same places, but for single instants
// at which the function is not finite. What may cease to be finite for longer (a logarithm, a root of what may be
// negative) stays in.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/node.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Functions whose product has the sign of another one, with the inputs and the numbers of the user's of that.
struct SignFactors {
    Function factors;  // a result each
    bool is_itself;    // there is one, and it is the function
};

/// Of a function with one result.
SignFactors sign_factors(const Function& function);

namespace same_sign {

/// A power in a product.
struct Factor {
    Expression base;
    int count = 1;
    bool never_negative = false, never_zero = false;
};

/// A sign times powers.
struct Product {
    int sign = 1;
    std::vector<Factor> factors = {};
    bool is_simpler = false;  // than what it has the sign of
    bool is_number = true;    // wherever its inputs are
    bool has_poles = false;   // it may be infinite at single places
    double low = -std::numeric_limits<double>::infinity(),
           high = std::numeric_limits<double>::infinity();  // its values

    bool never_negative() const;
    bool never_zero() const;
    bool is_positive() const { return sign > 0 && never_negative() && never_zero(); }
    bool is_finite() const { return is_number && !has_poles; }
    void multiply(const Product& other);
    /// Whether each power in another one has its base in this one.
    bool has_bases_of(const Product& other) const;
    /// Powers of one and two have the signs of all.
    void reduce();
    Expression expression() const;
    /// What it is the product of.
    std::vector<Expression> apart() const;
};

/// Writes a function anew, node by node.
class Writer {
public:
    /// `x`: the inputs of the new function.
    Writer(const Function& function, std::span<const Expression> x);

    const Product& product(std::int32_t n) const { return products_[at(n)]; }
    /// A node of the function, or what has its sign and is simpler.
    Expression result(std::int32_t n) const;
    /// Whether anything in a node is.
    bool is_simpler(std::int32_t n) const { return product(n).is_simpler || conditions_[at(n)] != 0; }

private:
    static std::size_t at(std::int32_t n) { return static_cast<std::size_t>(n); }

    /// The node itself, its operands written anew.
    Expression copied(std::int32_t n, std::span<const Expression> x) const;
    Product found(std::int32_t n) const;
    /// Its values lie between these, by those of its operands.
    std::array<double, 2> bounds(std::int32_t n) const;
    Product of_base(std::int32_t n, bool never_negative = false, bool never_zero = false) const;
    Product of_multiply(std::int32_t n) const;
    Product of_quotient(std::int32_t n) const;
    Product of_sum(std::int32_t n) const;
    Product of_norm(const Node& node) const;
    Product of_logarithm(std::int32_t n) const;
    Product of_power(std::int32_t n) const;
    Product of_select(std::int32_t n) const;
    /// The square of what is not negative, without a sign that is squared with it; none if that is not plain.
    std::optional<Expression> square(std::int32_t n) const;
    /// b where a node is positive, else c.
    Expression chosen(std::int32_t condition, const Expression& b, const Expression& c, std::int32_t name,
                      int depth = 0) const;
    /// Of a choice between what it compares: the larger (1) or the smaller (-1) of two; else 0.
    int extreme(std::int32_t n) const;

    const Function& function_;
    std::vector<Expression> copies_;
    std::vector<Product> products_;
    std::vector<char> conditions_;  // whether those of a copy are simpler
};

}  // namespace same_sign

}  // namespace rbdyn::inline RBDYN_FORM
