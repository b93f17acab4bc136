// Watched functions: the present moment of a motion as Python sees it, in expressions or in numbers.
#include "watch.hpp"

#include <algorithm>
#include <exception>
#include <memory>
#include <numeric>
#include <optional>
#include <rbdyn/rotation/attitude.hpp>

#include "recording.hpp"

namespace binding {

using rbdyn::Observable, rbdyn::Observe, rbdyn::Quantity, rbdyn::WatchFunction;

namespace {

/// Of a quantity in Python; none: a number.
using Shape = std::vector<py::ssize_t>;
using Ask = std::function<py::object(Quantity, int subject, const Shape& shape)>;

int count_of(const Shape& shape) {
    return static_cast<int>(std::accumulate(shape.begin(), shape.end(), py::ssize_t{1}, std::multiplies<>()));
}

/// What `now` is: gives what it is asked for, as long as the function it was made for runs.
struct Present {
    Ask ask;
    Handles handles;
    std::exception_ptr refused = nullptr;  // what it was asked for and no moment of the scene has
};

struct PresentThing {
    std::shared_ptr<const Present> now;
    int index;
    std::string name;
};
struct PresentBody : PresentThing {};
struct PresentCoupling : PresentThing {};

/// What it is asked for and does not have; Python's own error, so that hasattr() is answered.
[[noreturn]] void lacks(const py::object& self, const std::string& name) {
    std::string list;
    for (const py::handle known : py::module_::import("builtins").attr("dir")(py::type::of(self))) {
        const auto word = known.cast<std::string>();
        if (word.front() != '_') list += (list.empty() ? "" : ", ") + word;
    }
    const py::object type = py::reinterpret_borrow<py::object>(PyExc_AttributeError);
    const py::object error =
        type(py::type::of(self).attr("__name__").cast<std::string>() + " has no " + name + "; it has " + list);
    error.attr("name") = name;
    error.attr("obj") = self;
    PyErr_SetObject(PyExc_AttributeError, error.ptr());
    throw py::error_already_set();
}
/// Whether an error says that a present moment lacks what it was asked for.
bool is_lack(const py::object& error) {
    if (!error || !py::isinstance(error, py::reinterpret_borrow<py::object>(PyExc_AttributeError))) return false;
    const py::object asked = py::getattr(error, "obj", py::none());
    return py::isinstance<PresentBody>(asked) || py::isinstance<PresentCoupling>(asked) ||
           py::isinstance<Present>(asked);
}
/// Throws InvalidInput unless a function can be called with the present moment.
void require_of_now(const py::object& f, const std::string& user) {
    const auto why = py::module_::import("rbdyn.reasons").attr("why_not_called_with")(f, 1).cast<std::string>();
    if (!why.empty())
        throw InvalidInput(user + ": function " + name_of(f) + " " + why + "; it is called with one, now");
}

py::object ask(const Present& now, Quantity quantity, int subject, const Shape& shape) {
    if (!now.ask)
        throw InvalidInput("Now: the function it was made for has returned; ask for quantities while it runs");
    return now.ask(quantity, subject, shape);
}

/// Throws InvalidInput for a handle of another scene.
void require(Present& now, const Handle& handle) {
    try {
        now.handles.require(handle, "Now");
    } catch (const InvalidInput&) {
        now.refused = std::current_exception();
        throw;
    }
}

/// Calls f with a present moment that ends with the call.
template <class F>
auto with_present(Ask asked, const Handles& handles, F&& f) {
    const auto now = std::make_shared<Present>(Present{std::move(asked), handles});
    struct End {
        Present& now;
        ~End() { now.ask = nullptr; }
    } end{*now};
    return f(py::cast(now));
}

std::vector<rbdyn::StateChange> changes(const py::object& returned, const Handles& handles, const std::string& user) {
    std::vector<rbdyn::StateChange> result;
    if (returned.is_none()) return result;
    if (!py::isinstance<py::dict>(returned))
        throw InvalidInput(user + ": its action returns " + shown(returned) +
                           "; it returns None, or {handle: {\"velocity\": ...}} with what changes");
    for (const auto& [key, value] : returned.cast<py::dict>()) {
        if (!py::isinstance<Handle>(key) || !py::isinstance<py::dict>(value))
            throw InvalidInput(user + ": its action returns an item " + shown(key) + ": " + shown(value) +
                               "; each is a handle with a dict of what changes");
        rbdyn::StateChange change{handles.body(key.cast<const Handle&>(), user)};
        for (const auto& [word, what] : value.cast<py::dict>()) {
            const auto name = word.cast<std::string>();
            // along a plane both have two numbers
            const bool is_in_plane =
                (name == "position" || name == "velocity") && py::hasattr(what, "__len__") && py::len(what) == 2;
            if (is_in_plane)
                (name == "position" ? change.position_in_plane : change.velocity_in_plane) = pair_of(what, user, name);
            else if (name == "position")
                change.position = vector3(what, user, name);
            else if (name == "velocity")
                change.velocity = vector3(what, user, name);
            else if (name == "angles")
                change.angles = pair_of(what, user, name);
            else if (name == "rates")
                change.rates = pair_of(what, user, name);
            else if (name == "displacement_rate")
                change.displacement_rate = number(what, user, name);
            else if (name == "parameter")
                change.parameter = number(what, user, name);
            else if (name == "speed")
                change.speed = number(what, user, name);
            else if (name == "attitude")
                change.attitude = attitude(what, user);
            else if (name == "angular_velocity")
                change.angular_velocity = vector3(what, user, name);
            else if (name == "angular_velocity_world")
                change.angular_velocity_world = vector3(what, user, name);
            else if (name == "angle")
                change.angle = number(what, user, name);
            else if (name == "displacement")
                change.displacement = number(what, user, name);
            else if (name == "rate")
                change.rate = number(what, user, name);
            else
                throw InvalidInput(user + ": its action changes \"" + name +
                                   "\"; a free body has position and velocity, one on a rail parameter and speed, a "
                                   "rigid body the words of its joint");
        }
        result.push_back(change);
    }
    return result;
}

/// What a function that is called back needs; any thread may copy and drop it.
struct Called {
    py::object f;
    BoundScene scene;
    std::string user;
};
std::shared_ptr<const Called> called(const py::object& f, const BoundScene& scene, const std::string& user) {
    return {new Called{f, scene, user}, [](const Called* c) {
                if (Py_IsInitialized() == 0) return;
                const py::gil_scoped_acquire lock;
                delete c;
            }};
}

/// Calls it with a present moment in numbers, with the lock; `read` makes of what it returns what is wanted.
template <class Read>
auto call_with_numbers(const Called& c, const Observe& observe, Read&& read) {
    const py::gil_scoped_acquire lock;
    const CallingBack here;
    return with_present(
        [&](Quantity quantity, int subject, const Shape& shape) -> py::object {
            c.scene.scene.require_observable({quantity, subject, 0}, c.user);
            if (shape.empty()) return py::float_(observe({quantity, subject, 0}));
            py::array_t<double> result(shape);
            for (int i = 0; i < count_of(shape); ++i) result.mutable_data()[i] = observe({quantity, subject, i});
            return result;
        },
        c.scene.handles, [&](const py::object& now) { return read(c.f(now)); });
}

/// A function of the present moment that is recorded, and what it asks for: its inputs.
struct Asked {
    Asked(const BoundScene& of, std::string who) : scene(of), user(std::move(who)) {}

    const BoundScene& scene;
    std::string user;
    std::vector<Observable> all = {};

    /// Throws InvalidInput where it asks for what the scene does not have, which is no reason to call it back.
    Attempt record(const py::object& f, const std::function<std::vector<Expression>(const py::object&)>& results) {
        const auto now = std::make_shared<Present>(Present{nullptr, scene.handles});
        const auto ask_in = [&](Recording& recording, Quantity quantity, int subject,
                                const Shape& shape) -> py::object {
            try {
                scene.scene.require_observable({quantity, subject, 0}, user);
            } catch (const InvalidInput&) {
                now->refused = std::current_exception();
                throw;
            }
            const auto found = std::find(all.begin(), all.end(), Observable{quantity, subject, 0});
            const auto first = static_cast<int>(found - all.begin());
            if (found == all.end())
                for (int i = 0; i < count_of(shape); ++i) all.push_back({quantity, subject, i});
            return shape.empty() ? recording.input(first) : recording.inputs(first, shape);
        };
        struct End {
            Present& now;
            ~End() { now.ask = nullptr; }
        } end{*now};
        Attempt result = attempt(
            f,
            [&](Recording& recording) {
                now->ask = [&](Quantity quantity, int subject, const Shape& shape) {
                    return ask_in(recording, quantity, subject, shape);
                };
                return py::make_tuple(now);
            },
            results);
        if (!result.function && now->refused) std::rethrow_exception(now->refused);
        return result;
    }
};

/// What an action returns while it is recorded: the numbers of its words, in the order of these.
struct ChangedWords {
    const BoundScene& scene;
    const std::string& user;
    std::vector<rbdyn::RecordedAction::Word> all = {};

    std::vector<Expression> read(const py::object& returned) {
        std::vector<rbdyn::RecordedAction::Word> words;
        std::vector<Expression> numbers;
        if (!returned.is_none()) {
            if (!py::isinstance<py::dict>(returned))
                throw InvalidInput("it returns " + shown(returned) + ", which is no dict of what changes");
            for (const auto& [key, value] : returned.cast<py::dict>()) {
                if (!py::isinstance<Handle>(key) || !py::isinstance<py::dict>(value))
                    throw InvalidInput("it returns an item " + shown(key) + ", which is no handle with a dict");
                const int body = scene.handles.body(key.cast<const Handle&>(), user).index;
                for (const auto& [word, what] : value.cast<py::dict>())
                    add(body, word.cast<std::string>(), py::reinterpret_borrow<py::object>(what), words, numbers);
            }
        }
        if (!all.empty() && words != all) throw InvalidInput("it changes other words in other cases");
        all = words;
        return numbers;
    }

private:
    static void add(int body, std::string word, const py::object& what, std::vector<rbdyn::RecordedAction::Word>& words,
                    std::vector<Expression>& numbers) {
        const py::object array = py::module_::import("numpy").attr("asarray")(what, py::arg("dtype") = "object");
        const py::list items(array.attr("ravel")());
        const auto size = static_cast<int>(items.size());
        if ((word == "position" || word == "velocity") && size == 2) word += " (2)";
        if (rbdyn::RecordedAction::numbers(word) != size)
            throw InvalidInput("it gives " + word + " by " + std::to_string(size) +
                               " numbers, which is recorded of an attitude as a quaternion, and of other words as they "
                               "are");
        for (const py::handle item : items) {
            const auto x = operand(item);
            if (!x) throw InvalidInput("it gives " + word + " by " + shown(item));
            numbers.push_back(*x);
        }
        words.push_back({body, std::move(word)});
    }
};

/// An action of Python's, called with the present moment.
struct CalledAction {
    std::shared_ptr<const Called> c;

    std::vector<rbdyn::StateChange> operator()(const Observe& observe) const {
        return call_with_numbers(*c, observe,
                                 [&](const py::object& y) { return changes(y, c->scene.handles, c->user); });
    }
};

/// Asks a function that is to be called back for its value at a made-up moment. Throws InvalidInput if it asks for what
/// the moment does not have; whatever else goes wrong there need not in a motion.
void try_out(const Called& c) {
    double next = 0.5;
    const auto asked = [&](Quantity quantity, int, const Shape& shape) -> py::object {
        // numbers that differ, none of them zero; attitudes are attitudes
        if (shape.empty()) return py::float_(next += 0.0625);
        py::array_t<double> result(shape);
        for (int i = 0; i < count_of(shape); ++i) result.mutable_data()[i] = next += 0.0625;
        if (quantity == Quantity::quaternion || quantity == Quantity::rotation_matrix)
            for (int i = 0; i < count_of(shape); ++i) result.mutable_data()[i] = i % 4 == 0 ? 1.0 : 0.0;
        return result;
    };
    const CallingBack here;
    std::shared_ptr<Present> present;
    try {
        with_present(asked, c.scene.handles, [&](const py::object& now) {
            present = now.cast<std::shared_ptr<Present>>();
            return c.f(now);
        });
    } catch (py::error_already_set& error) {
        if (!error.matches(PyExc_Exception)) throw;
        if (present && present->refused) std::rethrow_exception(present->refused);
        if (is_lack(error.value())) throw InvalidInput(c.user + ": " + std::string(py::str(error.value())));
    }
}

}  // namespace

double one_number(const py::object& returned, const std::string& user) {
    const py::array array = numpy_array(returned);
    if (!array || array.size() != 1)
        throw InvalidInput(user + ": its function returns " + shown(returned) + "; it returns one number");
    return number(array.attr("reshape")(py::tuple()), user, "what its function returns");
}

Expression one_expression(const py::object& returned, const std::string& user) {
    py::object value = returned;
    if (py::isinstance<py::array>(value) && value.cast<py::array>().size() == 1)
        value = value.attr("reshape")(py::tuple()).attr("item")();
    const auto y = operand(value);
    if (!y) throw InvalidInput(user + ": its function returns " + shown(returned) + "; it returns one number");
    return *y;
}

WatchFunction watched_function(const py::object& f, const BoundScene& scene, std::optional<bool> trace,
                               const std::string& user) {
    if (PyCallable_Check(f.ptr()) == 0)
        throw InvalidInput(user + ": " + shown(f) + " is no function; give function(now)");
    require_of_now(f, user);
    std::string reason = "trace=False";
    if (trace.value_or(true)) {
        Asked asked(scene, user);
        const Attempt a = asked.record(
            f, [&](const py::object& returned) { return std::vector<Expression>{one_expression(returned, user)}; });
        if (a.function) return {with_inputs(a.function, static_cast<int>(asked.all.size())), asked.all};
        if (is_lack(a.cause)) throw InvalidInput(user + ": " + std::string(py::str(a.cause)));
        if (trace.value_or(false)) throw InvalidInput(user + ": its function cannot be recorded: " + a.reason);
        reason = a.reason;
    }
    const auto back = called(f, scene, user);
    try_out(*back);
    return WatchFunction::called_back(
        [c = back](const Observe& observe) {
            return call_with_numbers(*c, observe, [&](const py::object& y) { return one_number(y, c->user); });
        },
        reason, true);
}

rbdyn::WatchAction action_of(const py::object& action, const BoundScene& scene, const std::string& name) {
    using Kind = rbdyn::WatchAction::Kind;
    const std::string user = "watch \"" + name + "\"";
    if (py::isinstance<py::str>(action)) {
        static const std::vector<std::pair<std::string, Kind>> words = {{"record", Kind::record}, {"stop", Kind::stop}};
        return {one_of(plain(action), words, user, "action"), {}};
    }
    if (PyCallable_Check(action.ptr()) == 0)
        throw InvalidInput(user + ": action is " + shown(action) +
                           "; it is \"record\", \"stop\", or a function of now");
    require_of_now(action, user + ": action");
    return {Kind::change, CalledAction{called(action, scene, user)}};
}

std::optional<py::object> called_action(const rbdyn::WatchAction& action) {
    const auto* const found = action.change ? action.change.target<CalledAction>() : nullptr;
    if (found == nullptr) return std::nullopt;
    return found->c->f;
}

std::optional<rbdyn::RecordedAction> recorded_action(const py::object& action, const BoundScene& scene,
                                                     const std::string& name, std::string& reason) {
    const std::string user = "watch \"" + name + "\"";
    Asked asked(scene, user);
    ChangedWords words{scene, user};
    try {
        const Attempt a = asked.record(action, [&](const py::object& returned) { return words.read(returned); });
        reason = a.reason;
        if (a.function)
            return rbdyn::RecordedAction(with_inputs(a.function, static_cast<int>(asked.all.size())), asked.all,
                                         words.all);
    } catch (const InvalidInput& e) {
        reason = e.what();
    }
    return std::nullopt;
}

py::tuple watch_data(const WatchFunction& function, const std::string& user) {
    if (!function.is_recorded())
        throw py::type_error(user + ": its function is called back, and only what is traced can be pickled");
    py::list asked;
    for (const Observable& o : function.arguments())
        asked.append(py::make_tuple(static_cast<int>(o.quantity), o.subject, o.component));
    return py::make_tuple(function.function(), asked);
}

WatchFunction watch_from(const py::handle& data) {
    const auto d = data.cast<py::tuple>();
    std::vector<Observable> asked;
    for (const py::handle item : d[1]) {
        const auto o = item.cast<std::tuple<int, int, int>>();
        asked.push_back(
            {member(std::get<0>(o), Quantity::coupling_force, "watch", "a quantity"), std::get<1>(o), std::get<2>(o)});
    }
    return {d[0].cast<rbdyn::Function>(), asked};
}

void bind_watch(py::module_& m) {
    py::class_<PresentBody> body(m, "BodyNow", R"(A body at the present moment, for watched functions.

World axes, but where body axes are named.)");
    const Shape number = {}, vector = {3}, matrix = {3, 3};
    const auto define = [](auto& type, const char* name, Quantity quantity, const Shape& shape, const char* doc) {
        using Thing = typename std::decay_t<decltype(type)>::type;
        type.def_property_readonly(
            name, [quantity, shape](const Thing& b) { return ask(*b.now, quantity, b.index, shape); }, doc);
    };
    define(body, "position", Quantity::position, vector,
           "Of a particle, or of the origin of a rigid body's axes (3,) [m].");
    define(body, "velocity", Quantity::velocity, vector, "Of the same (3,) [m/s].");
    define(body, "acceleration", Quantity::acceleration, vector, "Of the same (3,) [m/s^2].");
    define(body, "force", Quantity::force, vector, "Resultant of the active forces (3,) [N].");
    define(body, "reaction", Quantity::reaction, vector, "Of its rail or joint (3,) [N].");
    define(body, "kinetic_energy", Quantity::kinetic_energy, number, "[J]");
    define(body, "parameter", Quantity::parameter, number, "The curve's parameter. On a rail.");
    define(body, "speed", Quantity::speed, number, "ds/dt along the curve [m/s]. On a rail.");
    define(body, "tangential_force", Quantity::tangential_force, number, "Q_s = F.t [N]. On a rail.");
    define(body, "center_of_mass", Quantity::center_of_mass, vector, "Of a rigid body (3,) [m].");
    define(body, "center_of_mass_velocity", Quantity::center_of_mass_velocity, vector, "Of a rigid body (3,) [m/s].");
    define(body, "center_of_mass_acceleration", Quantity::center_of_mass_acceleration, vector,
           "Of a rigid body (3,) [m/s^2].");
    define(body, "quaternion", Quantity::quaternion, {4},
           "(w, x, y, z), body axes to the world's (4,). Of a rigid body.");
    define(body, "rotation_matrix", Quantity::rotation_matrix, matrix,
           "Body axes to the world's (3, 3). Of a rigid body.");
    define(body, "euler_angles", Quantity::euler_angles, vector,
           "theta in [0, pi], psi and phi in [-pi, pi], with jumps there (3,) [rad]. Of a rigid body.");
    define(body, "angular_velocity", Quantity::angular_velocity, vector, "In body axes (3,) [rad/s]. Of a rigid body.");
    define(body, "angular_velocity_world", Quantity::angular_velocity_world, vector,
           "In world axes (3,) [rad/s]. Of a rigid body.");
    define(body, "angular_acceleration", Quantity::angular_acceleration, vector,
           "In body axes (3,) [rad/s^2]. Of a rigid body.");
    define(body, "poisson_vector", Quantity::poisson_vector, vector,
           "The world's third axis in body axes (3,) (7.59). Of a rigid body.");
    define(body, "reaction_torque", Quantity::reaction_torque, vector,
           "Of its joint, about the point it holds (3,) [N m]. Of a rigid body.");
    define(body, "angle", Quantity::angle, number, "Of a hinge, also one that slides, or in a plane [rad].");
    define(body, "displacement", Quantity::displacement, number, "Of a slide, also of a hinge that slides [m].");
    define(body, "rate", Quantity::rate, number, "Of the angle [rad/s], or of the displacement of a slide [m/s].");
    define(body, "displacement_rate", Quantity::displacement_rate, number, "Of a hinge that slides [m/s].");
    define(body, "angles", Quantity::angles, {2},
           "Of a universal joint, about its first axis and its second (2,) [rad].");
    define(body, "rates", Quantity::rates, {2}, "Of these angles (2,) [rad/s].");
    py::class_<PresentCoupling> coupling(m, "CouplingNow", "A coupling at the present moment, for watched functions.");
    define(coupling, "length", Quantity::length, number, "[m]");
    define(coupling, "force", Quantity::coupling_force, vector, "On its first end (3,) [N].");

    py::class_<Present, std::shared_ptr<Present>> present(
        m, "Now", "The present moment of a motion: what watched functions are called with.");
    const auto say_what_lacks = [](auto& type) {
        // no part of its signature: type checkers know what there is
        type.attr("__getattr__") = py::cpp_function(&lacks, py::is_method(type), py::name("__getattr__"));
    };
    say_what_lacks(body);
    say_what_lacks(coupling);
    say_what_lacks(present);
    present
        .def_property_readonly(
            "time", [](const Present& now) { return ask(now, Quantity::time, -1, {}); }, "[s]")
        .def(
            "__getitem__",
            [](const std::shared_ptr<Present>& now, const BodyHandle& handle) {
                require(*now, handle);
                return PresentBody{{now, handle.index, handle.name}};
            },
            py::arg("handle"))
        .def(
            "__getitem__",
            [](const std::shared_ptr<Present>& now, const CouplingHandle& handle) {
                require(*now, handle);
                return PresentCoupling{{now, handle.index, handle.name}};
            },
            py::arg("handle"));
}

}  // namespace binding
