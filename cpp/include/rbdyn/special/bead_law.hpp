// The law of a bead: a particle on a rail, smooth or rough, which it may leave.
//
// Notation: r(u) the rail's curve, u its parameter, w = du/dt, r' = dr/du; F the active force, Phi the rail's
// reaction; m a = F + Phi (eq. 7.7). Along r' and across it, in the curve's own parameter:
//     m (|r'|^2 w' + r'.r'' w^2) = r'.F + |r'| Phi_t                        (eq. 7.12)
//     |r'| |Phi_perp| = |c|,   c = m w^2 r' x r'' - r' x F                  (eqs. 7.13, 7.14, 7.24)
// slipping: Phi_t = -mu_d sign(slip) |Phi_perp| (eq. 7.23, 7.25);  sticking: |Phi_t| <= mu_s |Phi_perp|.
// slip = |r'| w - V, V(t) the speed of the rail's surface along itself. Since |c| needs no normal vector, straight
// stretches and points of inflection are nothing special.
//
// On a rail that moves F stands for F - m A in the rail's axes, A the acceleration its motion gives (bead_state.hpp).
// One that only pushes, along n = b x t, holds as long as Phi.n = b.c / |r'| has its sign.
//
// Coordinates: u; of one that may leave its rail u, x, y, z, those not in use at rest.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/one_side.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/time_function.hpp"
#include "rbdyn/model/rail_landing.hpp"
#include "rbdyn/model/rail_singular.hpp"
#include "rbdyn/scene/joints.hpp"
#include "rbdyn/scene/rigid_motion.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/bead_state.hpp"
#include "rbdyn/special/point_law.hpp"
#include "rbdyn/special/single_law.hpp"
#include "rbdyn/special/single_laws.hpp"
#include "rbdyn/special/view.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What sticking asks of a rail.
struct Holding {
    double tangential;  // |r'| Phi_t
    double across;      // |r'| |Phi_perp|
    double rounding;    // |r'| times what rounding may make of either: of the forces one by one, and of the motion
};

class BeadLaw : public PointLaw {
public:
    BeadLaw(const Scene::Body& b, int place, const SceneView& view);
    std::unique_ptr<SingleLaw> copy() const override;

    void take_start(const Scene::Body& b) override;
    void take_loads(const Scene& scene, const std::vector<int>& own) override;
    void take_map(const StateMap& map) override;

    int positions() const override { return may_fly_ ? 4 : 1; }
    int freedom() const override { return 1; }
    bool on_rail() const override { return true; }
    bool takes_numbers(const StateMap& map) const override;
    std::vector<VariableGroup> groups(bool of_positions) const override;
    void start(double t, DoubleDouble* q, DoubleDouble* v) const override;
    void keep_in(std::vector<bool>& stays) const override;

    void add_state(SingleStates<double>& states, double t, const double* q, const double* v,
                   signed char phase) const override;
    void add_state(SingleStates<S>& states, const S& t, const S* q, const S* v, signed char phase) const override;
    signed char kind(signed char phase) const override;
    signed char freest() const override { return may_fly_ ? flies : 1; }
    bool is_held(signed char phase) const override { return sticks_in(phase) && drive_.is_zero(); }

    void lay_down(RecordedBody& present, const CouplingForces<S>& couplings, S* q_rate, S* v_rate) const override;
    void guard(EquationsWriter& write, const RecordedBody& present, const S& t) const override;
    S observed(const RecordedBody& present, const Observable& o) const override;
    PointReport report(const LawsNow& now) const override;
    void report(const LawsNow& now, Asked asked, BodyReport& r) const override;
    void slope(const LawsNow& now, std::span<double> dq, std::span<double> dv) const override;
    void observe(const LawsNow& now, std::vector<Observed>& out) const override;
    Matrix3 rail_turn(double t) const override;
    using PointLaw::observed;

    bool holds_what_touches() const override;
    std::optional<double> change(const StateChange& c, const LawsNow& now, const std::string& user,
                                 std::span<double> x) const override;
    std::unique_ptr<const BodyForm> closed_form(const Scene& scene, const Vector3Of<DoubleDouble>& a) const override;
    std::string why_not_linear() const override;

    std::string coordinates(const StateMap& map) const override;
    const char* mover() const override { return "a force along its rail or a speed"; }
    void leave_out(const StateMap& map, std::vector<Omission>& omissions) const override;
    std::string not_finite(const LawsNow& now) const override;

    // --- what modes are made of (bead_modes.ipp) ---

    const Curve& curve() const { return curve_; }
    bool rough() const { return rough_; }
    bool may_fly() const { return may_fly_; }
    bool only_pushes() const { return side_ != RailSide::both; }
    double mu_static() const { return mu_static_; }
    double mu_dynamic() const { return mu_dynamic_; }
    const TimeFunction& drive() const { return drive_; }
    double start_speed() const { return start_speed_; }
    /// The binormal of a rail that only pushes, in the view, and what it pushes along where the bead starts, world
    /// axes.
    const Vector3& binormal() const { return binormal_; }
    Vector3 pushes_along() const { return one_side_->normal(); }
    /// Where it sticks, and where it slips, as far as equations go.
    bool sticks_in(signed char phase) const { return rough_ && phase == sticks; }
    bool slips_in(signed char phase) const { return rough_ && phase != sticks && phase != flies; }
    /// The first of the variables of a place in space, and of a velocity in it.
    int first_of_space() const { return first + 1; }
    int first_of_velocity() const { return first_rate + 1; }
    CurvePoint<double> curve_point(double u) const { return curve_.at<double>(u, view_); }
    /// Finds where it comes back to its rail; none if the rail holds on both sides.
    const std::shared_ptr<const RailLanding>& landing() const { return landing_; }
    /// What finds the place that a guard is for.
    std::shared_ptr<const Locator> locator(EventKind kind) const;

    /// The reaction that it needs to stay without slip.
    Holding holding(const SingleLaws& laws, double t, std::span<const double> x,
                    std::span<const signed char> slip) const;
    /// |r'| Phi_t that rest needs.
    S pull(const RecordedBody& present) const;

private:
    /// Active forces; what is exactly along the rail is kept apart.
    template <class T>
    struct Resultant {
        Vector3Of<T> force;
        T along;  // r' . (forces along the rail)
    };

    template <class T>
    BeadState<T> moving(const T& t, const T* q, const T* v, bool is_flying) const;

    /// What acts besides couplings. `length_of_w` gives |w| with the sign of the mode.
    template <class T, class Length>
    Resultant<T> applied(const T& t, const BeadState<T>& p, bool is_flying, Length&& length_of_w) const;

    /// What drives and presses it on its rail, in the rail's axes: F - m A.
    template <class T>
    Resultant<T> guided(const BeadState<T>& p, const Resultant<T>& f) const;
    /// c = m w^2 r' x r'' - r' x F, |r'| times what the rail must exert across itself.
    template <class T>
    Vector3Of<T> friction_vector(const BeadState<T>& p, const Resultant<T>& f) const;
    /// w' of one that slides (sign: of its slip), or of one on a smooth rail.
    template <class T>
    T sliding_rate(const BeadState<T>& p, const Resultant<T>& f, const T& sign, const T& across) const;
    /// w' of one that sticks: |r'| w = V(t).
    template <class T>
    T carried_rate(const T& t, const BeadState<T>& p) const;
    /// |r'| Phi_t of one that moves with w'.
    template <class T>
    T tangential(const BeadState<T>& p, const Resultant<T>& f, const T& rate) const;

    bool sets_view(const Scene& scene) const override;
    /// Whether what presses it on its rail is a constant that rounding of its terms alone has made.
    static bool is_rounding(const S& pressing, const BeadState<S>& p, const Resultant<S>& f);
    /// Of one on its rail, as its equations are recorded.
    static Resultant<S> acting(const RecordedBody& present) { return {present.force, present.along}; }
    static Vector3Of<S> force(const RecordedBody& present);

    Curve curve_;
    bool rough_ = false, may_fly_ = false;
    double mu_static_ = 0.0, mu_dynamic_ = 0.0;
    TimeFunction drive_;
    RigidMotion motion_;
    RailSide side_ = RailSide::both;
    RailEnds ends_ = RailEnds::stop;
    std::optional<curves::OneSide> one_side_ = std::nullopt;  // of a rail that only pushes, along its normal
    Vector3 binormal_ = Vector3::Zero();                      // its binormal in the view
    DoubleDouble start_u_ = 0.0;
    double start_speed_ = 0.0;
    DoubleDouble start_rate_ = 0.0;  // of the parameter
    std::shared_ptr<const RailLanding> landing_;
    std::shared_ptr<const RailSingularity> singularity_;       // none if it has none, or the bead stays
    std::shared_ptr<const SingularLanding> singular_landing_;  // of a rail that only pushes
};

}  // namespace rbdyn::inline RBDYN_FORM
