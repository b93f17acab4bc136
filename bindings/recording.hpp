// The recording of a function of the user's: its expressions as Python holds them, and the cases it distinguishes.
//
// A recorded number has no value, so that an `if` on it cannot be answered while the function is recorded. It is
// answered one way; the function is called again for the other, and what the two calls return is joined by a choice
// on what was asked. All calls record into one Recorder, in which what they have in common is there once. A question
// whose answer follows from what was answered before on the same path is not asked twice.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <rbdyn/expression/condition.hpp>
#include <rbdyn/expression/function.hpp>
#include <string>
#include <utility>
#include <vector>

#include "binding.hpp"

namespace binding {

using rbdyn::Expression;

class Recording;

/// An expression as Python holds it. It may outlive its recording.
struct Recorded {
    Expression value;
    std::shared_ptr<Recording> recording;
};

/// A comparison of expressions, or several joined.
struct RecordedCondition {
    rbdyn::Condition value;
    std::shared_ptr<Recording> recording;
};

/// One function that is being recorded.
class Recording : public std::enable_shared_from_this<Recording> {
public:
    /// The innermost one under way in this thread, or nullptr.
    static Recording* current();

    rbdyn::Recorder& recorder() { return recorder_; }
    bool is_live() const { return live_; }

    /// Input `index` of the function, for Python; those below it are inputs too.
    py::object input(int index);
    /// Three inputs from `first` on, or more, as an array.
    py::object inputs(int first, const std::vector<py::ssize_t>& shape);

    /// Whether a margin is positive, on the path that is being recorded.
    bool is_positive(const Expression& margin);
    /// Whether a margin is zero, if that follows from what was asked before.
    std::optional<bool> is_zero(const Expression& margin) const;
    /// Ends the recording: `kind` is a word of python/rbdyn/reasons.py that says what was asked for.
    /// `place` in the function's source; empty: where it is now.
    [[noreturn]] void refuse(const char* kind, const std::string& place = {});

    /// Calls `once` for each side of every case; the function of what it returns.
    rbdyn::Function explore(const std::function<std::vector<Expression>()>& once);
    /// Whether there was one call.
    bool is_one_path() const { return paths_ == 1; }
    /// Why it cannot be recorded, if that was found out.
    const std::string& refusal() const { return refusal_; }

private:
    struct Decision {
        std::int32_t margin;
        bool is_positive;
        std::string place;
    };
    // what is known of a node, or of the difference of two
    struct Range {
        double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
        bool lower_excluded = true, upper_excluded = true;
    };
    // a margin as +-(node - other) > +- constant
    struct Form {
        std::pair<std::int32_t, std::int32_t> nodes;
        double constant;
        bool is_above;
    };
    Form form(std::int32_t margin) const;
    std::optional<bool> known(const Form& f) const;
    void learn(const Form& f, bool is_positive);
    rbdyn::Function finished(const std::vector<Expression>& outputs) const;

    rbdyn::Recorder recorder_{rbdyn::Recorder::Purpose::function};
    bool live_ = true;
    int inputs_ = 0;
    std::string refusal_;
    py::object caller_ = py::none();  // the frame that asks for the recording: the function's own are within it

    std::vector<Decision> path_;
    std::size_t position_ = 0;  // on the path
    std::map<std::pair<std::int32_t, std::int32_t>, Range> ranges_;
    int paths_ = 0, decisions_ = 0, questions_ = 0;
};

/// The expression, if its function is the one that is being recorded.
const Expression& live(const Recorded& x);
/// What a Python object means beside an expression; nothing if it is no number. In `recording` or the current one.
std::optional<Expression> operand(py::handle x, const std::shared_ptr<Recording>& recording = nullptr);
/// For Python.
py::object recorded_number(const Expression& x, const std::shared_ptr<Recording>& recording);

/// While this lives, parameters are numbers: a function of the user's is being called back.
class CallingBack {
public:
    CallingBack() { ++depth(); }
    ~CallingBack() { --depth(); }
    CallingBack(const CallingBack&) = delete;
    CallingBack& operator=(const CallingBack&) = delete;
    static int& depth() {
        static thread_local int value = 0;
        return value;
    }
};

/// What a function of the user's is called with and gives.
struct Signature {
    std::vector<int> arguments;  // numbers in each: 1 a number, 3 a vector, 9 a matrix
    int results;
    std::string rule;        // what it returns, for messages: "a force has three components, in N"
    bool is_motion = false;  // what is returned is a rigid motion in any of its forms
    bool is_state = false;   // the last argument, and what is returned, are arrays however many numbers they have
    int inputs() const;
    /// Of an argument; empty: a number.
    std::vector<py::ssize_t> shape(std::size_t argument) const;
    /// Whether numbers come as it wants them, in an array of a shape.
    bool fits(const py::array& array) const;
};

/// How many of the function's arguments it is called with: those of the signature, or each number by itself.
bool takes_numbers(const py::object& f, const Signature& signature, const std::string& user, const std::string& name);
/// What is returned, for messages: a single value, or the shape of an array.
std::string form_of(const py::object& returned, const py::array& array);
/// "f"
std::string name_of(const py::object& f);

/// f called back from Python, with numbers.
std::shared_ptr<const rbdyn::Callback> python_callback(const py::object& f, const Signature& signature, bool spread,
                                                       const std::string& user, const std::string& reason);
/// f called back by the address it has, if it has one.
std::shared_ptr<const rbdyn::Callback> native_callback(const py::object& f, const Signature& signature,
                                                       const std::string& user);

/// What came of an attempt to record: a function, or the reason why there is none.
struct Attempt {
    rbdyn::Function function;
    std::string reason;
    py::object cause = {};  // the Python exception behind it, if there is one
};
/// Records f called with `arguments` of the recording; `results` reads what it returns. Errors of f become reasons.
/// `results` throws InvalidInput where what is returned breaks a rule.
Attempt attempt(const py::object& f, const std::function<py::tuple(Recording&)>& arguments,
                const std::function<std::vector<Expression>(const py::object&)>& results);

/// The same function with more inputs, which it does not use.
rbdyn::Function with_inputs(const rbdyn::Function& f, int inputs);

/// Recorded if it can be and `trace` is not false, else called back; InvalidInput if `trace` asks for more.
UserFunction user_function(const py::object& f, std::optional<bool> trace, const std::string& user,
                           const Signature& signature);

}  // namespace binding
