// Watched functions: what is computed from a motion while it goes on, and what is done where it passes zero.
//
// A function of `now` asks for quantities of bodies and couplings at the present moment. Recorded, those become the
// inputs of a Function, and the zeros are found on its Taylor series like any event's; called back, they are numbers,
// and zeros are found on an interpolation.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/basics/direction.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/functor.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/rotation/attitude.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/handles.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What a watched function may ask for.
enum class Quantity {
    time,
    // of a body
    position,
    velocity,
    acceleration,
    force,
    reaction,
    parameter,
    speed,
    tangential_force,
    kinetic_energy,
    // of a rigid body
    center_of_mass,
    center_of_mass_velocity,
    center_of_mass_acceleration,
    quaternion,        // w, x, y, z
    rotation_matrix,   // row by row
    euler_angles,      // theta in [0, pi], psi and phi in [-pi, pi]
    angular_velocity,  // body axes, as the next
    angular_acceleration,
    angular_velocity_world,
    poisson_vector,  // the world's third axis in body axes (7.59)
    reaction_torque,
    angle,  // of a hinge, also one that slides, or in a plane
    displacement,
    rate,               // of the angle, or of the displacement of a slide
    displacement_rate,  // of a hinge that slides
    angles,             // of a universal joint, two, as the next
    rates,
    // of a coupling
    length,
    coupling_force
};

inline bool is_of_coupling(Quantity q) { return q == Quantity::length || q == Quantity::coupling_force; }

/// How many numbers a quantity is.
int components_of(Quantity q);

/// One number of a motion: a quantity of a body or coupling, and its component if it is a vector.
struct Observable {
    Quantity quantity = Quantity::time;
    int subject = -1;
    int component = 0;
    bool operator==(const Observable&) const = default;
};

/// Gives the present value of what is asked for.
using Observe = std::function<double(const Observable&)>;

/// The present moment of a motion, for functions that are being recorded.
class Now {
public:
    explicit Now(std::vector<Observable>& asked) : asked_(asked) {}

    Expression value(const Observable& what) const;
    Vector3Of<Expression> vector(Quantity quantity, int subject) const;

    /// A body at the present moment, world axes.
    class Body {
    public:
        Body(const Now& now, int index) : now_(now), index_(index) {}
        Vector3Of<Expression> position() const { return now_.vector(Quantity::position, index_); }
        Vector3Of<Expression> velocity() const { return now_.vector(Quantity::velocity, index_); }
        Vector3Of<Expression> acceleration() const { return now_.vector(Quantity::acceleration, index_); }
        Vector3Of<Expression> force() const { return now_.vector(Quantity::force, index_); }
        Vector3Of<Expression> reaction() const { return now_.vector(Quantity::reaction, index_); }
        Expression parameter() const { return now_.value({Quantity::parameter, index_}); }
        Expression speed() const { return now_.value({Quantity::speed, index_}); }
        Expression tangential_force() const { return now_.value({Quantity::tangential_force, index_}); }
        Expression kinetic_energy() const { return now_.value({Quantity::kinetic_energy, index_}); }
        Vector3Of<Expression> center_of_mass() const { return now_.vector(Quantity::center_of_mass, index_); }
        Vector3Of<Expression> center_of_mass_velocity() const;
        Vector3Of<Expression> center_of_mass_acceleration() const;
        QuaternionOf<Expression> quaternion() const;
        /// Row by row.
        std::array<Expression, 9> rotation_matrix() const;
        EulerAnglesOf<Expression> euler_angles() const;
        Vector3Of<Expression> angular_velocity() const { return now_.vector(Quantity::angular_velocity, index_); }
        Vector3Of<Expression> angular_acceleration() const;
        Vector3Of<Expression> angular_velocity_world() const;
        Vector3Of<Expression> poisson_vector() const { return now_.vector(Quantity::poisson_vector, index_); }
        Vector3Of<Expression> reaction_torque() const { return now_.vector(Quantity::reaction_torque, index_); }
        Expression angle() const { return now_.value({Quantity::angle, index_}); }
        Expression displacement() const { return now_.value({Quantity::displacement, index_}); }
        Expression rate() const { return now_.value({Quantity::rate, index_}); }
        Expression displacement_rate() const { return now_.value({Quantity::displacement_rate, index_}); }
        std::array<Expression, 2> angles() const;
        std::array<Expression, 2> rates() const;

    private:
        const Now& now_;
        int index_;
    };
    /// A coupling at the present moment.
    class Coupling {
    public:
        Coupling(const Now& now, int index) : now_(now), index_(index) {}
        Expression length() const { return now_.value({Quantity::length, index_}); }
        Vector3Of<Expression> force() const { return now_.vector(Quantity::coupling_force, index_); }

    private:
        const Now& now_;
        int index_;
    };

    Expression time() const { return value({Quantity::time}); }
    Body operator[](BodyHandle body) const { return {*this, body.index}; }
    Coupling operator[](CouplingHandle coupling) const { return {*this, coupling.index}; }

private:
    std::vector<Observable>& asked_;
};

/// A function of the present moment, recorded or called back.
class WatchFunction {
public:
    WatchFunction() = default;
    /// Any functor: [=](const Now& now) { return now[ball].position()[2] - 1.0; }
    template <class F>
    requires(Takes<F, Now> && !std::is_same_v<std::decay_t<F>, WatchFunction>) WatchFunction(F f) {
        function_ = Function::record_growing([&](Recorder&) {
            const Now now(arguments_);
            const Expression y = recording::number(f, now);
            return std::pair(std::vector<Expression>{y}, static_cast<int>(arguments_.size()));
        });
    }
    template <class F>
    requires(!Takes<F, Now> && MeantAsFunctor<F, WatchFunction>) WatchFunction(F) {
        static_assert(recording::fits<F>, "a watched function is called as f(now): take it as const rbdyn::Now&");
    }
    WatchFunction(Function function, std::vector<Observable> arguments);
    /// Called back with numbers. `reason`: why it is not recorded.
    static WatchFunction called_back(std::function<double(const Observe&)> callback, std::string reason,
                                     bool is_python = false);

    /// Whether there is one.
    explicit operator bool() const { return function_ || callback_; }
    bool is_recorded() const { return static_cast<bool>(function_); }
    const Function& function() const { return function_; }
    const std::vector<Observable>& arguments() const { return arguments_; }
    /// Counts the calls of one that is called back, and says why it is.
    const std::shared_ptr<const Callback>& counter() const { return counter_; }
    bool asks_for(Quantity quantity) const;
    WatchFunction frozen() const;

    /// Its value at a moment.
    double operator()(const Observe& observe) const;

    bool operator==(const WatchFunction& other) const;

private:
    Function function_;
    std::vector<Observable> arguments_;
    std::function<double(const Observe&)> callback_;
    std::shared_ptr<const Callback> counter_;
};

/// A new state of one body, in its joint's own words, as it would start with; what is not given stays as it is: of a
/// rigid body the origin's position and velocity, the attitude, and the angular velocity in body axes. Of a body on
/// another one all of it is relative to that, but of a free one, which is in the world.
struct StateChange {
    BodyHandle body;
    std::optional<Vector3> position = std::nullopt, velocity = std::nullopt;  // of a free body, world axes
    std::optional<double> parameter = std::nullopt, speed = std::nullopt;     // of a bead
    std::optional<Attitude> attitude = std::nullopt;                          // of a rigid body that turns freely
    std::optional<Vector3> angular_velocity = std::nullopt;                   // its own, body axes
    std::optional<Vector3> angular_velocity_world = std::nullopt;             // or in the world's
    std::optional<double> angle = std::nullopt, displacement = std::nullopt;  // of a hinge, of a slide
    std::optional<double> rate = std::nullopt;                                // of either
    std::optional<double> displacement_rate = std::nullopt;                   // of a cylindrical joint
    std::optional<std::array<double, 2>> angles = std::nullopt, rates = std::nullopt;  // of a universal joint
    // of a planar joint: position and velocity, along its x and y
    std::optional<std::array<double, 2>> position_in_plane = std::nullopt, velocity_in_plane = std::nullopt;

    /// The words it gives.
    std::vector<std::string> words() const;
    /// Throws InvalidInput if any of them is none of a joint's own. `user`: the watch; `name`: of the body.
    void require_words(const std::vector<std::string>& own, const std::string& user, const std::string& name) const;
};

/// What is done where a watched function passes zero: it is noted; the run ends; or states change.
struct WatchAction {
    enum class Kind { record, stop, change } kind = Kind::record;
    std::function<std::vector<StateChange>(const Observe&)> change = {};

    /// Throws InvalidInput if it changes states and has no function that does. `user`: the watch.
    void require_change(const std::string& user) const;
};

/// Options of a watched function.
struct WatchOptions {
    Direction direction = Direction::either;
    WatchAction action = {};
};

}  // namespace rbdyn::inline RBDYN_FORM
