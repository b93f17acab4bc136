// A number as it is given to a scene: itself, or by reference (Parameter).
#pragma once

#include <optional>
#include <type_traits>
#include <utility>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/parameter.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A number, or one of the user's that may be changed between runs: a run takes it as it is when it starts.
///
/// It is a double wherever one is wanted. Where that happens while a scene is planned, the plan holds for this value
/// only; what takes it by in() holds for others, too (numbers.hpp).
class Given {
public:
    Given(double value = 0.0) : value_(value) {}
    Given(Parameter cell) : cell_(std::move(cell)) {}

    /// What they make of it is a plain number.
    Given& operator+=(double x) { return *this = Given(*this + x); }
    Given& operator-=(double x) { return *this = Given(*this - x); }
    Given& operator*=(double x) { return *this = Given(*this * x); }
    Given& operator/=(double x) { return *this = Given(*this / x); }

    /// Whether it is one of the user's.
    bool varies() const { return cell_.has_value(); }
    const Parameter& parameter() const { return *cell_; }
    /// What it is now, or was when it was frozen.
    double now() const { return cell_ && !is_frozen_ ? cell_->value() : value_; }
    operator double() const;
    /// In numbers of type S; in equations that are recorded, by reference.
    template <class S>
    S in() const {
        if constexpr (std::is_same_v<S, Expression>)
            if (Numbers* const numbers = Numbers::active(); cell_ && numbers != nullptr)
                return numbers->number(*cell_, now());
        return S(now());
    }
    /// Whether it is none; one of the user's counts as some until it is frozen.
    bool is_zero() const { return (!cell_ || is_frozen_) && value_ == 0.0; }

    /// With its number as it is now.
    Given frozen() const;
    /// Adds it to the numbers of the user's that something depends on.
    void give(GivenNumbers& numbers) const;

    bool operator==(const Given& other) const;
    bool operator==(double other) const { return static_cast<double>(*this) == other; }

private:
    double value_ = 0.0;
    bool is_frozen_ = false;
    std::optional<Parameter> cell_;
};

}  // namespace rbdyn::inline RBDYN_FORM
