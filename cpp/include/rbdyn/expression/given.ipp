// Definitions of rbdyn/expression/given.hpp.
#pragma once

#include "rbdyn/expression/given.hpp"

#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/parameter.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Given::operator double() const {
    if (!cell_) return value_;
    Numbers* const numbers = Numbers::active();
    return numbers != nullptr ? numbers->number(*cell_, now()).value() : now();
}

RBDYN_INLINE Given Given::frozen() const {
    Given result = *this;
    result.value_ = now();
    result.is_frozen_ = true;
    return result;
}

RBDYN_INLINE void Given::give(GivenNumbers& numbers) const {
    if (cell_) numbers.add(*cell_, now());
}

RBDYN_INLINE bool Given::operator==(const Given& other) const {
    if (varies() != other.varies()) return false;
    if (!cell_ || cell_->is(*other.cell_)) return now() == other.now();
    return now() == other.now() && cell_->name() == other.cell_->name();
}

}  // namespace rbdyn::inline RBDYN_FORM
