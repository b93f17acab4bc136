// Explores the cases that a function of the user's distinguishes, and joins what it returns in each.
#include "recording.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace binding {

using rbdyn::Node;
using rbdyn::Operation;

namespace {

// beyond these the function is called back instead: its formulas are too many, or it never ends
constexpr int most_paths = 64, most_decisions = 1000, most_questions = 20000;

std::vector<Recording*>& recordings() {
    static thread_local std::vector<Recording*> stack;
    return stack;
}

class UnderWay {
public:
    explicit UnderWay(Recording& r) : active_(r.recorder()), called_back_(std::exchange(CallingBack::depth(), 0)) {
        recordings().push_back(&r);
    }
    ~UnderWay() {
        recordings().pop_back();
        CallingBack::depth() = called_back_;
    }
    UnderWay(const UnderWay&) = delete;
    UnderWay& operator=(const UnderWay&) = delete;

private:
    rbdyn::recording::Active active_;
    int called_back_;  // a recording within a function that is called back is one all the same
};

py::module_ reasons() { return py::module_::import("rbdyn.reasons"); }

}  // namespace

Recording* Recording::current() { return recordings().empty() ? nullptr : recordings().back(); }

py::object Recording::input(int index) {
    // of very many: an interruption ends it, and other threads run meanwhile
    if (index % 1024 == 1023) {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        const py::gil_scoped_release others;
    }
    inputs_ = std::max(inputs_, index + 1);
    return recorded_number(recorder_.input(index), shared_from_this());
}

py::object Recording::inputs(int first, const std::vector<py::ssize_t>& shape) {
    const py::ssize_t size = std::accumulate(shape.begin(), shape.end(), py::ssize_t{1}, std::multiplies<>());
    py::list numbers;
    for (py::ssize_t i = 0; i < size; ++i) numbers.append(input(first + static_cast<int>(i)));
    return py::module_::import("rbdyn.tracing").attr("array")(numbers, py::cast(shape));
}

void Recording::refuse(const char* kind, const std::string& place) {
    // the first reason is the one that counts, should the function catch the error
    const std::string reason = py::str(reasons().attr("refusal")(kind, place, caller_));
    if (refusal_.empty()) refusal_ = reason;
    throw InvalidInput(reason);
}

Recording::Form Recording::form(std::int32_t margin) const {
    const auto negated = [&](std::int32_t i) {
        const Node& n = recorder_.node(i);
        if (n.operation != Operation::multiply) return -1;
        const auto is_minus_one = [&](std::int32_t k) {
            return recorder_.node(k).operation == Operation::constant && recorder_.node(k).value == -1.0;
        };
        return is_minus_one(n.a) ? n.b : is_minus_one(n.b) ? n.a : -1;
    };
    const auto alone = [&](std::int32_t i, double shift) -> Form {
        const std::int32_t other = negated(i);
        return other < 0 ? Form{{i, -1}, -shift, true} : Form{{other, -1}, shift, false};
    };
    const Node& n = recorder_.node(margin);
    if (n.operation != Operation::add) return alone(margin, 0.0);
    const Node &a = recorder_.node(n.a), &b = recorder_.node(n.b);
    if (a.operation == Operation::constant) return alone(n.b, a.value);
    if (b.operation == Operation::constant) return alone(n.a, b.value);
    for (const auto& [plus, minus] : {std::pair(n.a, negated(n.b)), std::pair(n.b, negated(n.a))})
        if (minus >= 0) return plus < minus ? Form{{plus, minus}, 0.0, true} : Form{{minus, plus}, 0.0, false};
    return alone(margin, 0.0);
}

std::optional<bool> Recording::known(const Form& f) const {
    const auto found = ranges_.find(f.nodes);
    if (found == ranges_.end()) return std::nullopt;
    const Range& r = found->second;
    if (f.is_above) {
        if (r.lower > f.constant || (r.lower == f.constant && r.lower_excluded)) return true;
        if (r.upper <= f.constant) return false;
    } else {
        if (r.upper < f.constant || (r.upper == f.constant && r.upper_excluded)) return true;
        if (r.lower >= f.constant) return false;
    }
    return std::nullopt;
}

void Recording::learn(const Form& f, bool is_positive) {
    Range& r = ranges_[f.nodes];
    // above the constant, or below it, itself excluded where the comparison holds
    if (f.is_above == is_positive) {
        if (f.constant > r.lower || (f.constant == r.lower && is_positive)) {
            r.lower = f.constant;
            r.lower_excluded = is_positive;
        }
    } else if (f.constant < r.upper || (f.constant == r.upper && is_positive)) {
        r.upper = f.constant;
        r.upper_excluded = is_positive;
    }
}

bool Recording::is_positive(const Expression& margin) {
    if (margin.is_constant()) return margin.value() > 0.0;
    if (++questions_ > most_questions) refuse("endless");
    const Form f = form(margin.node());
    if (const auto answer = known(f)) return *answer;
    if (position_ == path_.size()) {
        if (++decisions_ > most_decisions) refuse("decisions");
        path_.push_back({margin.node(), true, py::str(reasons().attr("place")(caller_))});
    } else if (path_[position_].margin != margin.node()) {
        refuse("inconsistent");
    }
    const bool answer = path_[position_++].is_positive;
    learn(f, answer);
    return answer;
}

std::optional<bool> Recording::is_zero(const Expression& margin) const {
    if (margin.is_constant()) return margin.value() == 0.0;
    const Form f = form(margin.node());
    const auto found = ranges_.find(f.nodes);
    if (found == ranges_.end()) return std::nullopt;
    const Range& r = found->second;
    if (f.constant < r.lower || (f.constant == r.lower && r.lower_excluded)) return false;
    if (f.constant > r.upper || (f.constant == r.upper && r.upper_excluded)) return false;
    if (r.lower == r.upper) return true;
    return std::nullopt;
}

rbdyn::Function Recording::explore(const std::function<std::vector<Expression>()>& once) {
    struct End {
        Recording& recording;
        ~End() {
            recording.live_ = false;
            recording.caller_ = py::none();
        }
    } end{*this};
    caller_ = py::reinterpret_borrow<py::object>(reinterpret_cast<PyObject*>(PyEval_GetFrame()));
    if (!caller_) caller_ = py::none();
    const UnderWay here(*this);
    std::vector<std::vector<Expression>> above;  // what is returned on the positive side, for each decision on the path
    while (true) {
        position_ = 0;
        questions_ = 0;
        ranges_.clear();
        if (++paths_ > most_paths) refuse("paths", path_.back().place);
        std::vector<Expression> outputs = once();
        if (position_ < path_.size()) refuse("inconsistent", path_[position_].place);
        // the other side of the last decision whose other side is not known; decisions with both sides are joined
        while (!path_.empty() && !path_.back().is_positive) {
            const Decision& d = path_.back();
            const std::vector<Expression>& other = above.back();
            if (other.size() != outputs.size()) refuse("sizes", d.place);
            for (std::size_t i = 0; i < outputs.size(); ++i)
                outputs[i] = select(
                    Expression(&recorder_, d.margin), [&] { return other[i]; }, [&] { return outputs[i]; },
                    "if, " + d.place);
            above.pop_back();
            path_.pop_back();
        }
        if (path_.empty()) return finished(outputs);
        path_.back().is_positive = false;
        above.push_back(std::move(outputs));
    }
}

rbdyn::Function Recording::finished(const std::vector<Expression>& outputs) const {
    // what is not needed stays behind
    const auto size = static_cast<std::size_t>(recorder_.size());
    std::vector<char> used(size, 0);
    std::vector<Node> nodes;
    for (const Expression& y : outputs)
        if (!y.is_constant()) used[static_cast<std::size_t>(y.node())] = 1;
    for (std::size_t n = size; n-- > 0;) {
        if (!used[n]) continue;
        for (const std::int32_t k : recorder_.node(static_cast<std::int32_t>(n)).operands())
            if (k >= 0) used[static_cast<std::size_t>(k)] = 1;
    }
    std::vector<std::int32_t> moved(size, -1), results;
    std::vector<std::string> names;
    std::vector<rbdyn::Parameter> parameters;
    for (std::size_t n = 0; n < size; ++n) {
        if (!used[n]) continue;
        Node node = recorder_.node(static_cast<std::int32_t>(n));
        const auto operands = node.operands();
        if (operands[0] >= 0) node.a = moved[static_cast<std::size_t>(operands[0])];
        if (operands[1] >= 0) node.b = moved[static_cast<std::size_t>(operands[1])];
        if (operands[2] >= 0) node.c = moved[static_cast<std::size_t>(operands[2])];
        if (node.operation == Operation::sign || node.operation == Operation::select ||
            node.operation == Operation::whole) {
            const std::string& name = recorder_.names()[static_cast<std::size_t>(node.d)];
            const auto found = std::find(names.begin(), names.end(), name);
            node.d = static_cast<std::int32_t>(found - names.begin());
            if (found == names.end()) names.push_back(name);
        }
        if (node.operation == Operation::cell) {
            parameters.push_back(recorder_.cells()[static_cast<std::size_t>(node.a)]);
            node.a = static_cast<std::int32_t>(parameters.size()) - 1;
        }
        moved[n] = static_cast<std::int32_t>(nodes.size());
        nodes.push_back(node);
    }
    for (const Expression& y : outputs) {
        if (y.is_constant()) {
            nodes.push_back({Operation::constant, -1, -1, -1, -1, y.value()});
            results.push_back(static_cast<std::int32_t>(nodes.size()) - 1);
        } else {
            results.push_back(moved[static_cast<std::size_t>(y.node())]);
        }
    }
    return rbdyn::Function::from_data(inputs_, nodes, results, names, parameters);
}

const Expression& live(const Recorded& x) {
    if (!x.recording->is_live())
        throw InvalidInput(
            "Expression: the function it was recorded in has returned; a function may use only what it is called with");
    if (x.recording.get() != Recording::current())
        throw InvalidInput(
            "Expression: it belongs to another function that is being recorded; a function may use only what it is "
            "called with");
    return x.value;
}

std::optional<Expression> operand(py::handle x, const std::shared_ptr<Recording>& recording) {
    if (PyFloat_CheckExact(x.ptr())) return Expression(PyFloat_AS_DOUBLE(x.ptr()));
    if (py::isinstance<Recorded>(x)) return live(x.cast<const Recorded&>());
    if (PyLong_CheckExact(x.ptr())) return Expression(x.cast<double>());
    if (py::isinstance<RecordedCondition>(x)) return where(x.cast<const RecordedCondition&>().value, 1.0, 0.0);
    if (py::isinstance<rbdyn::Parameter>(x)) {
        Recording* r = recording ? recording.get() : Recording::current();
        if (r == nullptr) return std::nullopt;
        return r->recorder().cell(x.cast<const rbdyn::Parameter&>());
    }
    const PyNumberMethods* numeric = Py_TYPE(x.ptr())->tp_as_number;
    const bool is_number = numeric != nullptr && (numeric->nb_float != nullptr || numeric->nb_index != nullptr);
    if (!is_number || py::hasattr(x, "__len__")) return std::nullopt;
    return Expression(x.cast<double>());
}

py::object recorded_number(const Expression& x, const std::shared_ptr<Recording>& recording) {
    return py::cast(Recorded{x, recording});
}

Attempt attempt(const py::object& f, const std::function<py::tuple(Recording&)>& arguments,
                const std::function<std::vector<Expression>(const py::object&)>& results) {
    const auto recording = std::make_shared<Recording>();
    Attempt result;
    try {
        result.function = recording->explore([&] {
            const py::object returned = f(*arguments(*recording));
            if (!recording->refusal().empty()) throw InvalidInput(recording->refusal());
            return results(returned);
        });
    } catch (py::error_already_set& error) {
        // what is no Exception (KeyboardInterrupt, SystemExit) is not a matter of recording
        if (!error.matches(PyExc_Exception)) throw;
        if (error.trace()) error.value().attr("__traceback__") = error.trace();
        result.reason = recording->refusal().empty() ? std::string(py::str(reasons().attr("raised")(error.value())))
                                                     : recording->refusal();
        result.cause = error.value();
    } catch (const rbdyn::Error& error) {
        // a rule is broken whatever the recording; on one path of several it may be one that is never taken
        if (recording->refusal().empty() && recording->is_one_path()) throw;
        result.reason = recording->refusal().empty() ? error.what() : recording->refusal();
    }
    return result;
}

}  // namespace binding
