// Definitions of rbdyn/expression/condition.hpp.
#pragma once

#include "rbdyn/expression/condition.hpp"

#include <functional>
#include <memory>
#include <string>

#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Condition Condition::positive(const Expression& margin) {
    if (margin.is_constant()) return margin.is_positive();
    Condition c(true);
    c.kind_ = Kind::positive;
    c.margin_ = margin;
    return c;
}

RBDYN_INLINE Recorder* Condition::recorder() const {
    if (kind_ == Kind::positive) return margin_.recorder();
    if (a_ == nullptr) return nullptr;
    Recorder* r = a_->recorder();
    return r != nullptr ? r : b_->recorder();
}

RBDYN_INLINE Expression Condition::choose_between(const std::function<Expression()>& b,
                                                  const std::function<Expression()>& c, const std::string& name) const {
    return choose<std::function<Expression()>, std::function<Expression()>>(b, c, name);
}

RBDYN_INLINE Condition Condition::joined(Kind kind, const Condition& a, const Condition& b) {
    Condition c(true);
    c.kind_ = kind;
    c.a_ = std::make_shared<const Condition>(a);
    c.b_ = std::make_shared<const Condition>(b);
    return c;
}

RBDYN_INLINE Expression where(const Condition& condition, const Expression& b, const Expression& c) {
    return condition.choose([&] { return b; }, [&] { return c; });
}

RBDYN_INLINE Expression max(const Expression& a, const Expression& b) {
    return (a > b).choose([&] { return a; }, [&] { return b; }, "maximum");
}

RBDYN_INLINE Expression min(const Expression& a, const Expression& b) {
    return (a < b).choose([&] { return a; }, [&] { return b; }, "minimum");
}

}  // namespace rbdyn::inline RBDYN_FORM
