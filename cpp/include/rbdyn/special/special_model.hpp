// The hybrid model of single bodies: modes of friction and flight, and what follows an event.
//
// A mode: the sign of the slip of every rough bead, or that it sticks; which beads fly; the side of every case
// distinction; the numbers its equations take follow from them. A bead without slip sticks if the tangential reaction
// it needs is at most mu_static times the perpendicular one; on the edge of that cone it holds unless the next moment
// asks for more; else it starts the way it is pulled. A bead that lands loses its velocity across the rail.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/recorded_model.hpp"
#include "rbdyn/model/scene_model.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/model/system_report.hpp"
#include "rbdyn/model/within.hpp"
#include "rbdyn/rotation/euler_angles.hpp"
#include "rbdyn/rotation/euler_path.hpp"
#include "rbdyn/scene/loads.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/series/piece.hpp"
#include "rbdyn/special/bead_law.hpp"
#include "rbdyn/special/laws_now.hpp"
#include "rbdyn/special/single_laws.hpp"
#include "rbdyn/special/what_stays.hpp"

namespace rbdyn::inline RBDYN_FORM {

class SpecialModel : public SceneModel {
public:
    /// `leaves_out`: what stays as it starts is not simulated. `numbers`: of the user's, as they are in the scene.
    SpecialModel(const Scene& scene, const Placement& view, bool leaves_out = false, const GivenNumbers& numbers = {});
    /// The model of the same scene with other numbers of the user's, which leave out the same. `elsewhere`: laws that
    /// start there, and leave out the same; none: those of the model that was planned.
    SpecialModel(const SpecialModel& planned, const Scene& scene, const GivenNumbers& numbers,
                 std::shared_ptr<SingleLaws> elsewhere = nullptr);

    int variables() const override;
    bool holds_what_touches(int subject) const override;
    int bodies() const override { return laws_->size(); }
    bool on_rail(int body) const override { return laws_->body(body).on_rail(); }
    const SingleLaws& laws() const { return *laws_; }
    const std::string& name(int body) const override { return laws_->body(body).name; }
    const StateMap& map() const override { return laws_->map(); }
    bool turns(int body) const override { return laws_->body(body).turns(laws_->map()); }
    int freedom() const override;
    std::shared_ptr<const SceneModel> with_numbers(const Scene& scene, const GivenNumbers& numbers) const override;
    std::shared_ptr<const SceneModel> started_elsewhere(const Scene& scene, const GivenNumbers& numbers) const override;
    /// Why all variables are simulated, also what stays as it starts; empty if that is left out.
    const std::string& why_all() const override { return why_all_; }
    std::string coordinates(int body) const override;
    std::vector<Omission> left_out(int body) const override;
    std::vector<std::string> guards() const override;
    bool guards_depend_on_start() const override;

    /// The equations for what every body does at the state the scene starts in.
    const Equations& equations(const std::vector<signed char>& slip, double t = 0.0) const;

    /// The state the scene starts in.
    std::vector<double> start(double t = 0.0) const override;
    std::vector<double> start_rest() const override;

    /// What acts in a mode; none where the laws at the state say it.
    std::optional<Acting> acting(const Mode& mode, double t, std::span<const double> x) const;

    /// Motion and reaction of a body in a mode.
    PointReport report(const Mode& mode, int body, double t, std::span<const double> x) const override;
    RigidReport rigid_report(const Mode& mode, int body, double t, std::span<const double> x) const override;
    /// All bodies and couplings in a mode.
    SystemReport system_report(const Mode& mode, double t, std::span<const double> x, Asked asked) const override;
    JointReport joint(const Mode& mode, int body, double t, std::span<const double> x) const override;
    /// The force of a coupling on its first end in a mode, world axes.
    Vector3 coupling_force(const Mode& mode, int coupling, double t, std::span<const double> x) const override;
    /// Power of a load of the scene in a mode.
    double power(const Mode& mode, const Scene::AppliedLoad& load, int index, double t,
                 std::span<const double> x) const override;
    /// The value of a watched function in a mode.
    double watched(const Mode& mode, int watch, double t, std::span<const double> x) const override;

    /// Attitude and angular velocity of a rigid body.
    Turning turning(int body, double t, std::span<const double> x) const override;

    /// The Euler angles of every body that turns freely, three each.
    std::vector<double> winding(double, std::span<const double> x) const override;
    void wind(const Piece& piece, double length, std::vector<double>& all) const override;
    /// Where a body's angles are in what winding() gives, by three; -1: it does not turn freely.
    int place_of_angles(int body) const override;
    /// The angles of a body somewhere on a piece, from those before its start.
    EulerAngles wound(int body, const Piece& piece, const EulerAngles& before, double tau) const override;

    /// Where a particle or a body's centre of mass is in a mode, and where a body's origin is; no force is asked for.
    Vector3 center(const Mode& mode, int body, double t, std::span<const double> x) const override;
    Vector3 position(const Mode& mode, int body, double t, std::span<const double> x) const override;
    Matrix3 rail_turn(int body, double t, std::span<const double> x) const override;

    /// What watched functions may ask for, at a state.
    Observe observing(const Mode& mode, double t, std::span<const double> x) const override;

    Mode undecided() const override;

    Mode begin(double t, std::span<double> x) const override;

    Mode next(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
              std::vector<Happening>& happenings) const override;

    Slope slope(const Mode& mode, double t, std::span<const double> x, std::span<double> slope,
                std::span<double> bend) const override;

    /// Positions, velocities, and reactions of rails, body by body.
    void observe(const Mode& mode, double t, std::span<const double> x, std::vector<Observed>& out) const override;

    double guard_value(const Guard& guard, const Mode& mode, double t, std::span<const double> x) const override;

    std::string grown(const Mode& before, double t0, std::span<const double> x0, const Mode& mode, double t,
                      std::span<const double> x) const override;

    std::string not_finite(const Mode& mode, double t, std::span<const double> x) const override;

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    /// A state within its mode with what acts in it, which keep what `now` refers to.
    struct Moment {
        Moment(const SpecialModel& model, const Mode& mode, double t, std::span<const double> x,
               Asked asked = Asked::forces);
        Within state;
        std::optional<Acting> acts;
        LawsNow now;
    };

    /// What is left out of the state, and why nothing is, where nobody knows.
    Staying staying_in(const SingleLaws& laws) const;
    static constexpr const char* nothing_moves = "nothing moves, and what is watched for needs time to pass";
    /// Also of zeros.
    static bool same_bits(double a, double b) { return a == b && std::signbit(a) == std::signbit(b); }

    bool has_angles(int body) const { return laws_->body(body).first_of_attitude() >= 0; }

    /// A state with quaternions of unit length: between bodies what they are short of it would show as a moment.
    std::vector<double> with_unit_attitudes(std::span<const double> x) const;

    /// A variable that is simulated.
    double& variable(std::span<double> x, int index) const { return x[at(laws_->map().place(index))]; }

    // --- what beads do (bead_modes.ipp) ---

    /// The first bead on a rail that jumps, with its tangent or by itself, where a distinction changes; -1: none.
    int at_corner(const Mode& mode, std::span<const int> fired, std::span<const double> x) const;

    /// What a bead does at a speed along its rail.
    signed char slip_of(const Mode& mode, int i, double speed, double t, std::span<double> x) const;

    /// The speed of a rail's surface, and the size of what it is made of: its rounding is some epsilon times that.
    struct Drive {
        double speed, size;
    };
    /// In a mode: where it jumps, on the side that the mode is on.
    Drive drive_of(const Mode& mode, int i, double t, std::span<const double> x) const;

    /// What beads do whose rails' surfaces change their speed by a jump, which no friction follows. Returns whether any
    /// does anything else than before.
    bool follow_drives(const Mode& before, Mode& after, double t, std::span<double> x,
                       std::vector<Happening>& happenings) const;

    /// Sets w of a bead without slip exactly: the speed of its rail.
    void carry(const Mode& mode, int i, double t, std::span<double> x) const;

    /// What a bead without slip needs to stay so; a bit of rounding in the time may be all there is of it.
    Holding holding(const Mode& mode, int i, double t, std::span<const double> x) const;

    /// Which way a bead starts that a mode cannot hold: that of the load along its rail, or of its first change where
    /// it is zero.
    signed char escape(const Mode& stuck, int i, double t, std::span<const double> x, const Holding& h) const;

    /// What a bead without slip does: sticks (0), or starts to slip with the sign returned. Sets w exactly.
    signed char settle(const Mode& mode, int i, double t, std::span<double> x) const;

    /// A bead becomes free, with the place and velocity it has.
    void release(Mode& mode, int i, double t, std::span<double> x) const;

    /// A bead that flies comes to its rail, where it keeps its velocity along it. Returns the impulse on it.
    double land(Mode& mode, int i, double t, std::span<double> x) const;

    /// Releases a bead whose rail would have to pull it. Returns whether it did.
    bool let_go(Mode& mode, int i, double t, std::span<double> x) const;

    /// A bead that starts at an end of its rail and leaves it at once flies, if its rail lets it. Throws InvalidInput
    /// if not: such a run would end where it starts.
    void leave_end(Mode& mode, int i, double t, std::span<double> x) const;

    /// The value of a watched function, which may be called back.
    double called(const Scene::Watch& watch, const Mode& mode, double t, std::span<const double> x) const;
    /// What the user's own action makes of the state, of which nothing is left out.
    void change(Mode& mode, const Scene::Watch& watch, double t, std::span<double> x) const;

    // --- the equations (recorded_model.hpp) ---

    /// Beads on smooth rails slip, as far as equations go.
    std::vector<signed char> kind_of(const Mode& mode) const override;
    std::unique_ptr<Structure> record(const Mode& mode, const RecordedFor& state) const override;
    std::unique_ptr<Structure> adapted(const Structure& recorded) const override;
    void own_parameters(Mode& mode, std::span<const double> x) const override;

    std::shared_ptr<const SingleLaws> laws_;
    std::vector<Scene::Watch> watches_;
    std::shared_ptr<const Scene> asked_;  // where something is called back: what it asks for has to be there
    std::string why_all_;
};

}  // namespace rbdyn::inline RBDYN_FORM
