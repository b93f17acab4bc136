// The law of a rigid body, whichever way it hangs on the world: its axes and moments, what acts on it, what is asked.
//
// o is the centre of mass of a free body, or the point of it that its joint holds; the frame of its equations is fixed
// in the body, or follows the axis e3 of a symmetric one and does not turn about it (rigid_state.hpp). Of each joint
// its own law says how the body is placed, what of its velocities changes, and what the joint resists.
// Invariant: constants that derive from the user's doubles, and the start, are numbers of 32 digits; recorded equations
// take them as they are, doubles take them rounded once.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/rigid_body.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/model/body_report.hpp"
#include "rbdyn/model/rigid_state.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/euler_path.hpp"
#include "rbdyn/rotation/quaternion.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/laws_now.hpp"
#include "rbdyn/special/single_law.hpp"
#include "rbdyn/special/single_state.hpp"
#include "rbdyn/special/view.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A body at a state, seen from the world.
template <class S>
struct BodyState : SingleState<S> {
    RigidState<S> at;

    BodyState(const RigidState<S>& state, const Vector3Of<S>& center)
        : SingleState<S>(state.position(center), state.velocity(center)), at(state) {}
    std::pair<Vector3Of<S>, Vector3Of<S>> motion_of(const Vector3Of<DoubleDouble>& point) const override {
        const Vector3Of<S> c = exactly<S>(point);
        return {at.position(c), at.velocity(c)};
    }
};

/// A load on a rigid body at a point of it, in the frame.
struct RigidLoad {
    Load load;
    Vector3Of<DoubleDouble> point;
    int index = -1;  // among the loads of the scene
};

class RigidLaw : public SingleLaw {
public:
    /// What derives from the user's doubles, in 32 digits.
    struct Exact {
        DoubleDouble mass;
        Matrix3Of<DoubleDouble> frame;              // columns: the frame's axes in body axes (spin zero)
        QuaternionOf<DoubleDouble> frame_attitude;  // of the frame in the body
        Vector3Of<DoubleDouble> origin;             // o, in body axes
        Vector3Of<DoubleDouble> center;             // G from o, in the frame
        Vector3Of<DoubleDouble> moments;            // about o: on the principal axes; on a hinge [2] is I_33
        Vector3Of<DoubleDouble> weight;             // world
    };
    /// The angular acceleration in the frame, and the acceleration of o in the world.
    template <class T>
    using Accelerations = std::pair<Vector3Of<T>, Vector3Of<T>>;

    bool follows_axis = false;  // the frame does not turn about e3
    Exact exact;
    // rounded
    Matrix3 frame = Matrix3::Identity();
    Quaternion frame_attitude;
    Vector3 center = Vector3::Zero(), moments = Vector3::Ones();
    Matrix3 inertia = Matrix3::Zero();  // about G, in the frame

    void take_start(const Scene::Body& b) override;
    void take_loads(const Scene& scene, const std::vector<int>& own) override;
    Vector3Of<DoubleDouble> point(const std::optional<Vector3>& given) const override;
    void start(double t, DoubleDouble* q, DoubleDouble* v) const override;
    void keep_in(std::vector<bool>& stays) const override;

    void add_state(SingleStates<double>& states, double t, const double* q, const double* v,
                   signed char phase) const override;
    void add_state(SingleStates<S>& states, const S& t, const S* q, const S* v, signed char phase) const override;

    void lay_down(RecordedBody& present, const CouplingForces<S>& couplings, S* q_rate, S* v_rate) const override;
    void powers(const RecordedBody& present, const S& t, std::span<S> power) const override;
    bool is_function(const Scene::AppliedLoad& load, int of_scene) const override;

    S observed(const RecordedBody& present, const Observable& o) const override;
    double observed(const LawsNow& now, const Observable& o) const override;
    PointReport report(const LawsNow& now) const override;
    void report(const LawsNow& now, Asked asked, BodyReport& r) const override;
    RigidReport rigid_report(const LawsNow& now) const;
    void slope(const LawsNow& now, std::span<double> dq, std::span<double> dv) const override;
    double power(const Scene::AppliedLoad& load, double t, const SingleState<double>& state) const override;
    Vector3 origin(const SingleState<double>& state) const override;

    std::optional<double> change(const StateChange& c, const LawsNow& now, const std::string& user,
                                 std::span<double> x) const override;
    bool is_conservative() const override { return loads_.empty() && couplings.empty(); }
    std::optional<planning::LoneBody> alone() const override;
    std::string not_finite(const LawsNow& now) const override;

    // --- what each joint says, in numbers and as expressions ---

    /// Where its coordinates place it.
    virtual RigidState<double> placed(const double* q, const double* v) const = 0;
    virtual RigidState<S> placed(const S* q, const S* v) const = 0;
    /// The derivatives of the coordinates.
    virtual void rates(const RigidState<double>& s, const double* q, const Wrench<double>& w, double* q_rate,
                       double* v_rate) const = 0;
    virtual void rates(const RigidState<S>& s, const S* q, const Wrench<S>& w, S* q_rate, S* v_rate) const = 0;
    /// From the rates of the velocities.
    virtual Accelerations<double> accelerations(const RigidState<double>& s, const double* v_rate) const = 0;
    virtual Accelerations<S> accelerations(const RigidState<S>& s, const S* v_rate) const = 0;
    /// The quaternion of the body's axes, and these themselves in the world.
    virtual QuaternionOf<double> attitude(const RigidState<double>& s) const = 0;
    virtual QuaternionOf<S> attitude(const RigidState<S>& s) const = 0;
    virtual AxesOf<double> body_axes(const RigidState<double>& s) const = 0;
    virtual AxesOf<S> body_axes(const RigidState<S>& s) const = 0;

    // --- what each joint says else ---

    /// The coordinates of a start.
    virtual void start_in(const Scene::Body& b, DoubleDouble* q, DoubleDouble* v) const = 0;
    /// Whether it holds o, and about which axes of the frame it keeps the body from turning.
    virtual bool holds_point() const { return true; }
    virtual std::array<bool, 3> holds_turns() const { return {false, false, false}; }
    /// The words of an action of the user's, and the one coordinate among them, if it has one.
    virtual std::vector<std::string> words() const = 0;
    virtual std::optional<double> coordinate_of(const StateChange& /*c*/) const { return std::nullopt; }

    // --- the same formula for every joint ---

    /// A vector of the frame in body axes, and one of the body in the frame.
    template <class T>
    Vector3Of<T> to_body(const RigidState<T>& s, const Vector3Of<T>& a) const {
        return times<T>(exact.frame, follows_axis ? spun(a, T(-s.spin)) : a);
    }
    template <class T>
    Vector3Of<T> from_body(const RigidState<T>& s, const Vector3Of<T>& a) const {
        const Vector3Of<T> b = times<T>(exact.frame.transpose(), a);
        return follows_axis ? spun(b, s.spin) : b;
    }
    /// The origin of the body's axes from o, in the frame.
    template <class T>
    Vector3Of<T> origin_in_frame(const RigidState<T>& s) const {
        return from_body<T>(s, exactly<T>(Vector3Of<DoubleDouble>(-exact.origin)));
    }
    /// The acceleration of a point of the body, world axes.
    template <class T>
    static Vector3Of<T> acceleration(const RigidState<T>& s, const Accelerations<T>& rates, const Vector3Of<T>& point) {
        return rates.second +
               s.to_world(Vector3Of<T>(cross<T>(rates.first, point) + cross<T>(s.omega, cross<T>(s.omega, point))));
    }
    /// A point given in body axes, in the frame; with spin zero.
    Vector3Of<DoubleDouble> point_in_frame(const Vector3& p) const { return in_frame(widened(p) - exact.origin); }
    /// Attitude and angular velocity of the body's axes.
    Turning turning(const double* q, const double* v) const;
    const std::optional<EulerAngles>& start_angles() const { return start_angles_; }
    bool any_turn_held() const;

protected:
    /// About a point of it, given as it is known, that is held, or slides from, `at` in the world.
    RigidLaw(const Scene& scene, int place, const Vector3& at, const Vector3& origin,
             const Vector3Of<DoubleDouble>& exact_origin);

    static const RigidBody& body_of(const Scene& scene, int place);
    Vector3Of<DoubleDouble> to_center(const Scene& scene) const;
    /// What follows from the frame, which is chosen.
    void take_frame(const Scene& scene);

    /// v in components of the frame, without what is rounding in them: that of 32 digits, or of the doubles that put it
    /// on the axis that the frame follows.
    Vector3Of<DoubleDouble> in_frame(const Vector3Of<DoubleDouble>& v) const;
    /// e3 along an axis, G in the plane of e3 and e1.
    static Matrix3Of<DoubleDouble> axis_frame(const Vector3Of<DoubleDouble>& axis,
                                              const Vector3Of<DoubleDouble>& to_center);

    // what is judged of a body in motion: its centre of mass, its axes, what its joint exerts
    void observe_center(const RigidReport& r, const LawsNow& now, std::vector<Observed>& out) const;
    static void observe_axes(const RigidReport& r, std::vector<Observed>& out, double gyration = 0.0);
    static void observe_force(const RigidReport& r, std::vector<Observed>& out);
    static void observe_torque(const RigidReport& r, std::vector<Observed>& out);

    // how far from the axis, over the distance from o, doubles leave a point that is on it
    static constexpr double off_axis = 4.0 * std::numeric_limits<double>::epsilon();

    Vector3 at_ = Vector3::Zero();      // where o is held, or slides from, in the world
    Vector3 origin_ = Vector3::Zero();  // o, in body axes
    std::vector<RigidLoad> loads_;

private:
    template <class T>
    static bool is_exactly_zero(const T& x) {
        if constexpr (std::is_same_v<T, Expression>)
            return x.is_zero();
        else
            return x == T(0.0);
    }
    /// v turned about e3.
    template <class T>
    static Vector3Of<T> spun(const Vector3Of<T>& a, const T& angle) {
        using std::cos, std::sin;
        if (is_exactly_zero(a[0]) && is_exactly_zero(a[1])) return a;
        const T c = cos(angle), n = sin(angle);
        return Vector3Of<T>(c * a[0] - n * a[1], n * a[0] + c * a[1], a[2]);
    }
    static Vector3Of<DoubleDouble> unit(const Vector3Of<DoubleDouble>& v);
    /// The world axis most across a direction.
    static Vector3 least_along(const Vector3& direction);

    /// Adds what a load exerts.
    template <class T>
    void add_load(Wrench<T>& w, const RigidState<T>& s, const RigidLoad& load, const T& t) const;
    /// What acts besides couplings, and its moment; and with them.
    template <class T>
    Wrench<T> applied(const T& t, const RigidState<T>& s) const;
    template <class T>
    Wrench<T> wrench(const CouplingForces<T>& forces, const RigidState<T>& s) const;
    /// That in a state, by the equations of its mode where they say it, and the rates of the velocities.
    struct Acts {
        Wrench<double> wrench;
        double v_rate[6];
    };
    Acts acts(const LawsNow& now) const;

    /// How G moves, in the frame: (m a_G, I_G alpha + omega x I_G omega).
    template <class T>
    Accelerations<T> momentum_rates(const RigidState<T>& s, const Accelerations<T>& rates) const;
    /// The torque about o of the joint, in the frame: of 7.48 about o, what loads leave.
    template <class T>
    Vector3Of<T> torque_of_joint(const RigidState<T>& s, const Wrench<T>& w, const Accelerations<T>& rates) const;
    /// The sizes of what that is a difference of, component by component, for about a free axis terms may be large.
    double effort_of_torque(const RigidState<double>& s, const Wrench<double>& w,
                            const Accelerations<double>& rates) const;
    template <class T>
    T asked(const RigidState<T>& s, const Wrench<T>& w, const T* v_rate, const Observable& o) const;

    DoubleDouble start_positions_[8] = {}, start_velocities_[6] = {};
    std::optional<EulerAngles> start_angles_;  // that its attitude was given by
};

/// What a joint says in numbers of any type (`Own` has each as a template), for both.
template <class Own, class Base = RigidLaw>
class RigidLawOf : public Base {
public:
    using S = Expression;
    using Base::Base;

    std::unique_ptr<SingleLaw> copy() const override { return std::make_unique<Own>(own()); }
    RigidState<double> placed(const double* q, const double* v) const override { return own().place(q, v); }
    RigidState<S> placed(const S* q, const S* v) const override { return own().place(q, v); }
    void rates(const RigidState<double>& s, const double* q, const Wrench<double>& w, double* q_rate,
               double* v_rate) const override {
        own().change_by(s, q, w, q_rate, v_rate);
    }
    void rates(const RigidState<S>& s, const S* q, const Wrench<S>& w, S* q_rate, S* v_rate) const override {
        own().change_by(s, q, w, q_rate, v_rate);
    }
    RigidLaw::Accelerations<double> accelerations(const RigidState<double>& s, const double* v_rate) const override {
        return own().accelerated(s, v_rate);
    }
    RigidLaw::Accelerations<S> accelerations(const RigidState<S>& s, const S* v_rate) const override {
        return own().accelerated(s, v_rate);
    }
    QuaternionOf<double> attitude(const RigidState<double>& s) const override { return own().turn(s); }
    QuaternionOf<S> attitude(const RigidState<S>& s) const override { return own().turn(s); }
    AxesOf<double> body_axes(const RigidState<double>& s) const override { return own().axes_of(s); }
    AxesOf<S> body_axes(const RigidState<S>& s) const override { return own().axes_of(s); }

    /// The body's own axes, where they turn with the frame or in it.
    template <class T>
    AxesOf<T> axes_of(const RigidState<T>& s) const {
        const auto axis = [&](int i) {
            return s.to_world(this->template from_body<T>(s, Vector3Of<T>(Vector3(Vector3::Unit(i)))));
        };
        return {axis(0), axis(1), axis(2)};
    }

private:
    const Own& own() const { return static_cast<const Own&>(*this); }
};

}  // namespace rbdyn::inline RBDYN_FORM
