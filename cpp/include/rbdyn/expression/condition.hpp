// Comparisons of expressions, and functions that distinguish cases.
//
// A recorded function has no value to compare while it is recorded: a comparison gives a Condition, and where() takes
// it. In a model each side of a condition is a formula of its own, the change from one to the other a located event.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A statement about expressions: a comparison, or several joined.
class Condition {
public:
    Condition(bool known) : kind_(known ? Kind::always : Kind::never) {}
    /// margin > 0
    static Condition positive(const Expression& margin);

    friend Condition operator!(const Condition& c) {
        if (c.kind_ == Kind::always) return false;
        if (c.kind_ == Kind::never) return true;
        return joined(Kind::negation, c, c);
    }
    friend Condition operator&(const Condition& a, const Condition& b) {
        if (a.kind_ == Kind::never || b.kind_ == Kind::always) return a;
        if (b.kind_ == Kind::never || a.kind_ == Kind::always) return b;
        return joined(Kind::both, a, b);
    }
    friend Condition operator|(const Condition& a, const Condition& b) { return !((!a) & (!b)); }
    /// That one of them holds and the other does not.
    friend Condition operator^(const Condition& a, const Condition& b) {
        if (a.kind_ == Kind::never) return b;
        if (b.kind_ == Kind::never) return a;
        if (a.kind_ == Kind::always) return !b;
        return b.kind_ == Kind::always ? !a : joined(Kind::differ, a, b);
    }
    friend Condition operator&&(const Condition& a, const Condition& b) { return a & b; }
    friend Condition operator||(const Condition& a, const Condition& b) { return a | b; }

    Condition(const Condition&) = default;
    Condition(Condition&&) = default;
    Condition& operator=(const Condition&) = default;
    Condition& operator=(Condition&&) = default;
    /// As many as are joined, one after the other: none is taken apart within another.
    ~Condition();

    /// The recorder of what is compared; none if it is known.
    Recorder* recorder() const;

    /// b() where it holds, else c().
    template <class B, class C>
    Expression choose(const B& b, const C& c, const std::string& name = "where") const {
        if (kind_ == Kind::always) return b();
        if (kind_ == Kind::never) return c();
        if (kind_ == Kind::positive) return select(margin_, b, c, name);
        return choose_joined(b, c, name);
    }

    /// Whether it holds, `positive` saying it of each comparison's margin that has to be known.
    bool holds(const std::function<bool(const Expression&)>& positive) const;

private:
    enum class Kind { always, never, positive, negation, both, differ };
    class Ways;

    // what is joined nests neither types nor calls, however much it is
    Expression choose_joined(const std::function<Expression()>& b, const std::function<Expression()>& c,
                             const std::string& name) const;
    static Condition joined(Kind kind, const Condition& a, const Condition& b);

    Kind kind_;
    Expression margin_;
    std::shared_ptr<Condition> a_, b_;
};

// where both sides are equal, each keeps its word: a > b does not hold, a >= b does
inline Condition operator>(const Expression& a, const Expression& b) { return Condition::positive(a - b); }
inline Condition operator<(const Expression& a, const Expression& b) { return Condition::positive(b - a); }
inline Condition operator>=(const Expression& a, const Expression& b) { return !(b > a); }
inline Condition operator<=(const Expression& a, const Expression& b) { return !(a > b); }

/// b where the condition holds, else c. In doubles as in expressions.
Expression where(const Condition& condition, const Expression& b, const Expression& c);
inline double where(bool condition, double b, double c) { return condition ? b : c; }

Expression max(const Expression& a, const Expression& b);
Expression min(const Expression& a, const Expression& b);

}  // namespace rbdyn::inline RBDYN_FORM
