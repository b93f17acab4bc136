// A number type that records what is done with it.
//
// A model of motion is written once, as a function over any number type. Called with `Expression` it leaves behind
// the list of its operations, from which program.hpp makes one native program for doubles, Taylor coefficients,
// Jacobians and extended precision alike. Constants are folded and equal subexpressions shared while recording, so
// what a scene does not call for (a zero component, a coefficient of zero, an absent effect) is not in the program.
//
// A recorder serves one of two purposes. As a function it keeps everything, case distinctions included, so that the
// function can be applied again (function.hpp). As a model of one smooth mode it keeps one side of every distinction:
// signs become parameters of the program with the argument as guard (`Switch`), choices between formulas are made
// by the state the mode begins in, or by whoever knows better (`Branch`).
//
// Constants are doubles, or numbers of 32 digits where a model gives such; what is folded with one of these is one, and
// is rounded once, by the program that uses it. Models and derivatives have all digits of all constants (WideFolding);
// what a user's own function computes with numbers while it is recorded are doubles, the user's own.
//
// Conventions: an expression is a constant or a node of one Recorder. `parameter` nodes are numbers that are fixed
// during smooth motion and may change between pieces (the sign of a slip).
#pragma once

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace recording {

Recorder* common(const Expression& a, const Expression& b);

/// While one lives, this thread folds all constants with 32 digits.
class WideFolding {
public:
    WideFolding() : before_(is_on) { is_on = true; }
    ~WideFolding() { is_on = before_; }
    WideFolding(const WideFolding&) = delete;
    WideFolding& operator=(const WideFolding&) = delete;
    inline static thread_local bool is_on = false;

private:
    bool before_;
};

/// A constant as an expression; that it is a double is seen where it comes from doubles.
Expression as_expression(const Constant& c, bool from_doubles);

/// What an operation makes of two constants.
template <class F>
Expression folded(Operation operation, const Expression& a, const Expression& b, F&& f) {
    if (a.is_number() || b.is_number()) return Numbers::active()->record(operation, a, b);
    Constant x = a.constant(), y = b.constant();
    const bool from_doubles = !x.is_wide && !y.is_wide;
    x.is_wide = x.is_wide || WideFolding::is_on;
    return as_expression(folded(x, y, f), from_doubles);
}
/// What a function makes of a constant.
template <class F>
Expression folded(const Expression& a, F&& f) {
    Constant x = a.constant();
    const bool from_doubles = !x.is_wide;
    (void)a.value();
    x.is_wide = x.is_wide || WideFolding::is_on;
    return as_expression(folded(x, f), from_doubles);
}

/// The angle of the point (x, y), away from its cut.
Expression angle(const Expression& y, const Expression& x);

}  // namespace recording

Expression operator+(const Expression& a, const Expression& b);

Expression operator*(const Expression& a, const Expression& b);

inline Expression operator-(const Expression& a) { return Expression(-1.0) * a; }
inline Expression operator+(const Expression& a) { return a; }
Expression operator-(const Expression& a, const Expression& b);

Expression operator/(const Expression& a, const Expression& b);

// --- switching operations of a recorder ---

}  // namespace rbdyn::inline RBDYN_FORM
