// A number as it is given to a scene: itself, or by reference (Parameter).
#pragma once

#include <cmath>
#include <optional>
#include <type_traits>
#include <utility>

#include "rbdyn/expression/function.hpp"

namespace rbdyn {

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
    operator double() const {
        if (!cell_) return value_;
        Numbers* const numbers = Numbers::active();
        return numbers != nullptr ? numbers->number(*cell_, now()).value() : now();
    }
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
    Given frozen() const {
        Given result = *this;
        result.value_ = now();
        result.is_frozen_ = true;
        return result;
    }
    /// Adds it to the numbers of the user's that something depends on.
    void give(GivenNumbers& numbers) const {
        if (cell_) numbers.add(*cell_, now());
    }

    bool operator==(const Given& other) const {
        if (varies() != other.varies()) return false;
        if (!cell_ || cell_->is(*other.cell_)) return now() == other.now();
        return now() == other.now() && cell_->name() == other.cell_->name();
    }
    bool operator==(double other) const { return static_cast<double>(*this) == other; }

private:
    double value_ = 0.0;
    bool is_frozen_ = false;
    std::optional<Parameter> cell_;
};

}  // namespace rbdyn
