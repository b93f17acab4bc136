// The hybrid model of bodies joined to bodies: a tree on its joints, its loops closed by constraints.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/mechanics/constraint.hpp"
#include "rbdyn/mechanics/contact_state.hpp"
#include "rbdyn/mechanics/exert.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"
#include "rbdyn/mechanics/joint_friction.hpp"
#include "rbdyn/mechanics/loose_rail.hpp"
#include "rbdyn/mechanics/tree.hpp"
#include "rbdyn/mechanics/tree_state.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/body_report.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/scene_model.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

class EquationsWriter;  // model/equations_writer.hpp
namespace mechanics {
class TreeWriter;  // mechanics/tree_writer.hpp
}
namespace friction {
struct JointLaw;  // mechanics/touched.hpp
}

/// Whether a scene is one for a tree: bodies on bodies, constraints, joints and loads that the special laws have not.
bool needs_tree(const Scene& scene);

class TreeModel : public SceneModel {
public:
    [[gnu::cold]] explicit TreeModel(const Scene& scene, const GivenNumbers& numbers = {});

    int variables() const override { return tree_->variables(); }
    int bodies() const override { return tree_->size(); }
    bool on_rail(int body) const override;
    const StateMap& map() const override { return map_; }
    const std::string& why_all() const override { return why_all_; }
    const std::string& name(int body) const override { return tree_->node(body).name; }
    std::string coordinates(int body) const override { return tree_->coordinates(body); }
    std::vector<std::string> guards() const override;
    bool touches() const override;
    bool holds_what_touches(int subject) const override;
    bool turns(int body) const override { return !tree_->node(body).is_point; }
    int freedom() const override {
        return tree_->velocities() - static_cast<int>(rows_.size()) - 3 * static_cast<int>(loose_.size());
    }
    std::vector<std::string> not_unique() const override;
    double origin() const override { return scene_.origin(); }
    std::shared_ptr<const SceneModel> with_numbers(const Scene& scene, const GivenNumbers& numbers) const override;
    std::shared_ptr<const SceneModel> started_elsewhere(const Scene& scene, const GivenNumbers& numbers) const override;

    std::vector<double> start(double t = 0.0) const override;
    std::vector<double> start_rest() const override;

    PointReport report(const Mode& mode, int body, double t, std::span<const double> x) const override;
    SystemReport system_report(const Mode& mode, double t, std::span<const double> x, Asked asked) const override;
    RigidReport rigid_report(const Mode& mode, int body, double t, std::span<const double> x) const override;
    JointReport joint(const Mode& mode, int body, double t, std::span<const double> x) const override;
    ConstraintReport constraint(const Mode& mode, int index, double t, std::span<const double> x) const override;
    ContactReport contact(const Mode& mode, int index, double t, std::span<const double> x) const override;
    Vector3 coupling_force(const Mode& mode, int coupling, double t, std::span<const double> x) const override;
    double power(const Mode& mode, const Scene::AppliedLoad& load, int index, double t,
                 std::span<const double> x) const override;
    double watched(const Mode& mode, int watch, double t, std::span<const double> x) const override;
    Observe observing(const Mode& mode, double t, std::span<const double> x) const override;

    Turning turning(int body, double t, std::span<const double> x) const override;
    int place_of_angles(int body) const override;
    EulerAngles wound(int body, const Piece& piece, const EulerAngles& before, double tau) const override;
    std::vector<double> winding(double t, std::span<const double> x) const override;
    void wind(const Piece& piece, double length, std::vector<double>& winding) const override;
    Vector3 center(const Mode& mode, int body, double t, std::span<const double> x) const override;
    Vector3 position(const Mode& mode, int body, double t, std::span<const double> x) const override;
    Matrix3 rail_turn(int body, double t, std::span<const double> x) const override;

    Mode undecided() const override;
    Mode begin(double t, std::span<double> x) const override;
    Mode next(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
              std::vector<Happening>& happenings) const override;
    Mode next_with_rest(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
                        std::span<double> rest, std::span<const double> largest,
                        std::vector<Happening>& happenings) const override;
    void observe(const Mode& mode, double t, std::span<const double> x, std::vector<Observed>& observed) const override;
    double independence(const Mode& mode, double t, std::span<const double> x) const override;
    double guard_value(const Guard& guard, const Mode& mode, double t, std::span<const double> x) const override;
    std::string not_finite(const Mode& mode, double t, std::span<const double> x) const override;
    std::string impossible(const Mode& mode, double t, std::span<const double> x) const override;
    bool feel_each_other(int contact, int other, const Mode& mode, double t, std::span<const double> x) const override;
    bool follows_bounces(const Mode& /*mode*/) const override { return !conditions_->is_rough() || follows_gaps(); }
    bool bounces_among_bouncing(int contact) const override;

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    std::vector<signed char> kind_of(const Mode& mode) const override { return mode.slip; }

    // --- contacts (contact_state.hpp) ---

    static constexpr signed char pushes = mechanics::contact_state::pushes, rests = mechanics::contact_state::rests;
    int contacts() const { return static_cast<int>(conditions_->contacts().size()); }
    bool is_rough(int contact) const { return conditions_->contacts()[at(contact)].is_rough(); }
    /// Whether of several that bounce the last bounces may be left out: where something may slip, or resists rolling.
    bool leaves_out() const {
        return resistances() > 0 ||
               std::any_of(conditions_->contacts().begin(), conditions_->contacts().end(),
                           [](const mechanics::ContactLaw& c) {
                               return c.is_rough() && std::isfinite(static_cast<double>(c.mu_static));
                           });
    }
    /// The rows that are used in a mode: of constraints, of contacts that push, and of what friction holds.
    std::vector<int> rows_in(const Mode& mode) const;
    /// Of these those that the state is moved onto: joints have no gaps, and what a surface carries has a rate.
    std::vector<int> kept_rows(const Mode& mode) const;
    /// The gaps that are held at zero in a mode.
    std::vector<int> closed_in(const Mode& mode, const std::vector<mechanics::Moving<double>>& all) const;
    /// Whether friction and constraints leave nothing that could move.
    bool holds_all(const std::vector<int>& rows) const;
    /// How large what a contact joins is [m]: gaps far below that are none.
    double size_of(int contact, const std::vector<mechanics::Moving<double>>& all) const;
    /// The least of those of what touches; zero if nothing does, or none has one.
    double least_size(const Mode& mode, const std::vector<mechanics::Moving<double>>& all) const;
    /// How fast they move at most [m/s].
    double speed_of(int contact, const std::vector<mechanics::Moving<double>>& all) const;
    /// How fast what makes up its slip has moved at most, `largest` of the state so far: what rounding is a part of
    /// [m/s].
    double fastest_of(int contact, double t, std::span<const double> x, std::span<const double> largest,
                      const std::vector<mechanics::Moving<double>>& all) const;
    /// What has fired of contacts.
    struct Fired {
        std::vector<int> landing, doubtful, breaking, stopping, turning, singular;
        std::vector<int> resisted_breaking, resisted_stopping, resisted_turning;  // of resistances
        std::vector<int> resisted_ending;                   // those of the last that turn no more before they stop
        std::vector<int> stuck;                             // by an impact
        std::vector<int> rubbed_breaking, rubbed_stopping;  // joints
        std::span<const double> largest;                    // sizes of variables so far; empty: not known
        bool has(int contact) const;
        bool none() const;
    };
    /// Which of some contacts, none of which separates, push, slide, are held or open. May find that no motion
    /// satisfies the laws.
    void settle(const Mode& before, Mode& mode, double t, std::span<double> x, const std::vector<int>& candidates,
                const Fired& fired) const;
    /// Without friction: by the accelerations they would have if all were open. `doubtful`: those whose force is at
    /// zero, however rounding has it.
    void settle_smooth(Mode& mode, double t, std::span<double> x, const std::vector<int>& candidates,
                       const std::vector<int>& doubtful) const;
    /// Takes away what rounding has left of approach in what was struck and then let go, so that it does not strike
    /// again at once. `anyway`: also where doubles tell no approach.
    void part(const Mode& mode, double t, std::span<double> x, const std::vector<int>& struck,
              bool anyway = false) const;
    /// Whether the bodies of a contact are at rest and stay so, but for rounding.
    bool stands(const Mode& mode, int contact, double t, std::span<const double> x) const;
    /// What impacts with friction did.
    struct Strokes {
        std::vector<Vector3> pushed;  // the impulse on the first side of each contact [N s]
        double lowered = 1.0;         // the part of all restitution that is left, for more would gain energy
        std::vector<int> stuck;       // contacts that do not slip after it
        std::string impossible;       // why there are none
    };
    /// The velocities after what strikes at an instant; returns the normal impulse of each contact [N s].
    std::vector<double> strike(const Mode& before, double t, std::span<double> x, const std::vector<int>& struck,
                               Strokes& strokes) const;
    std::vector<double> strike_smooth(double t, std::span<double> x, const std::vector<int>& struck) const;
    /// The same of one smooth contact that strikes where nothing else is held, from the row of its gap: its impulse,
    /// and how much velocity that makes [N s, m/s].
    std::pair<double, double> strike_alone(double t, std::span<double> x, std::span<double> rest, int struck,
                                           const std::vector<mechanics::Moving<double>>& all,
                                           const mechanics::Row<double>& row) const;
    /// How fast a contact opens, by the digits of the state beyond doubles.
    double fine_rate(int contact, double t, std::span<const double> x, std::span<const double> rest) const;

    // --- friction at contacts (tree_friction.ipp) ---

    /// Some contacts at a state where they touch: each smooth one, and each that slides, with one unknown force, the
    /// others with three, and what these do to each other.
    struct Touched;
    /// `mode`: what resistances do; none: nothing, as in impacts.
    Touched touched(const Mode& before, double t, const std::vector<mechanics::Moving<double>>& all,
                    const std::vector<int>& contacts, const std::vector<int>& stopped, bool strikes,
                    const Mode* mode = nullptr) const;
    /// What a contact among the struck ones was given.
    void tell_stroke(const Touched& touched, std::size_t one, const mechanics::ConeForces& found,
                     const std::vector<mechanics::Moving<double>>& after, const std::vector<double>& noise,
                     Strokes& strokes, std::vector<double>& normal) const;
    /// The same where joints have friction.
    std::vector<double> strike_jointed(double t, std::span<double> x, const std::vector<int>& struck, Touched& touched,
                                       Strokes& strokes) const;
    /// settle() where there is friction.
    void settle_rough(const Mode& before, Mode& mode, double t, std::span<double> x, const std::vector<int>& candidates,
                      const Fired& fired) const;
    /// Puts slips that turn, and those that are too slow to have a direction, in the form that follows them.
    void turn(const Mode& before, Mode& mode, double t, std::span<const double> x, const Fired& fired) const;
    /// Settles contacts whose forces have come to zero: each goes on as it did, and opens if it would have to pull.
    /// Returns false where that is not all there is to it.
    bool settle_ending(const Mode& before, Mode& mode, double t, std::span<double> x,
                       const std::vector<int>& candidates, const Fired& fired) const;
    /// Of contacts those that press no more from here on in a mode in which loads are shared anew: none, unless one of
    /// the doubtful is among them.
    std::vector<int> press_no_more(const Mode& before, const Mode& mode, double t, std::span<const double> x,
                                   const std::vector<int>& of, const std::vector<int>& doubtful) const;
    /// Contacts whose forces have come to zero where they were held or slid; those of friction have, too.
    std::vector<int> ending(const Mode& before, double t, std::span<const double> x, const Fired& fired) const;
    /// Whether what is left of a slip is rounding of the speeds that made it up, or what it loses within the rounding
    /// of the time at which its end is located.
    bool is_at_end(const Mode& before, int contact, double t, std::span<const double> x) const;
    /// One turn of settling what is rough: with some held contacts that break.
    void settle_breaking(const Mode& before, Mode& mode, double t, std::span<double> x,
                         const std::vector<int>& candidates, const Fired& fired, std::vector<int> breaking) const;
    bool sticks_without_bound(const Mode& mode, int contact) const;
    bool let_go(const Mode& before, Mode& mode, double t, std::span<double> x, const std::vector<int>& candidates,
                const Fired& fired, const std::vector<int>& breaking) const;
    /// Which contacts begin to slide by forces found, and along which directions: of those of the same bodies that do
    /// so along one direction it is that of all of them.
    std::vector<bool> begin_to_slide(const Mode& mode, Touched& touched, const mechanics::ConeForces& found,
                                     const std::vector<double>& b, const std::vector<double>& noise,
                                     const std::vector<int>& breaking) const;
    /// The states of contacts from forces found. Returns whether they can be held so; `may_be_on_edges`: where all of
    /// them are on the edges of their cones, too.
    bool take(const Mode& before, Mode& mode, double t, Touched& touched, const mechanics::ConeForces& found,
              const std::vector<double>& b, const std::vector<double>& noise, const std::vector<int>& breaking,
              bool may_be_on_edges = false) const;
    /// Directions of slips that begin at the edges of their cones, as they turn (tree_slip_directions.ipp).
    void curve(const Mode& before, Mode& mode, double t, std::span<const double> x) const;
    /// Closes smooth contacts whose forces depend on each other, all of them pushing. Returns whether they can.
    bool share_load(const Mode& before, Mode& mode, double t, const std::vector<mechanics::Moving<double>>& all,
                    const std::vector<int>& candidates, const std::vector<double>& b,
                    const std::vector<double>& noise) const;
    /// Whether the normal forces of these depend on each other.
    bool depend(const std::vector<int>& of, const std::vector<mechanics::Moving<double>>& all) const;
    /// Beside what opens, those of smooth contacts whose forces depend on each other share the load: with what bears
    /// what touches, neither pushing nor opening as it is found, where all of it can, else as much of it as can between
    /// two bodies each. Returns those that do; `b`, `noise`: of the candidates.
    std::vector<int> share_beside(const Mode& before, Mode& mode, double t,
                                  const std::vector<mechanics::Moving<double>>& all, const std::vector<int>& candidates,
                                  const std::vector<int>& bearing, const std::vector<int>& touching,
                                  const std::vector<double>& b, const std::vector<double>& noise) const;
    /// Of smooth contacts whose force is at zero: which push, rest or open. `doubtful`: as of settle_smooth().
    void push_or_open(Mode& mode, double t, std::span<double> x, const std::vector<int>& uncertain,
                      const std::vector<int>& doubtful) const;
    /// Whether the force of a contact that slides, one of many, leaves the motion what it is, `chosen` rows acting too.
    bool makes_no_difference(const Mode& mode, const Touched& touched, std::size_t one,
                             const std::vector<int>& chosen) const;
    /// Why contacts have no forces, or impulses, in words.
    std::string no_forces(const std::string& what, const std::vector<int>& of) const;
    /// That the forces of these contacts are one choice of many, on which the motion depends.
    /// Of some contacts that one itself, whose row depends on those chosen, and those on which it does.
    std::vector<int> sharing_with(int contact, const std::vector<int>& of, const std::vector<int>& rows,
                                  const std::vector<mechanics::Moving<double>>& all) const;
    std::string not_unique(const std::vector<int>& of) const;
    std::string names_of(const std::vector<int>& of) const;
    /// That the motion depends on which of many impulses there are, in words: of contacts whose impulses `others`
    /// change.
    std::string impulses_not_unique(const std::vector<double>& others, const std::vector<int>& struck,
                                    const std::vector<mechanics::Cone>& cones) const;
    /// That the laws leave more than one velocity after an impact, in words.
    std::string several_velocities(const std::vector<int>& struck) const;
    /// Why a contact does not slide on, in words.
    std::string no_sliding(int contact) const;
    /// Whether what friction holds has forces that the motion does not determine.
    bool shares_load(const Mode& mode) const;
    /// The names of contacts that are closed as the scene starts and whose forces the motion does not determine.
    std::vector<std::string> sharing_contacts() const;
    /// The rows of what is held, and the forces along axes that have none. Returns whether there are such, inside all
    /// cones.
    bool hold_by_friction(const Mode& before, Mode& mode, double t, const Touched& touched,
                          const std::vector<double>& force, const std::vector<mechanics::Moving<double>>& all,
                          bool may_be_on_edges) const;
    /// forces_inside() beside joints that are held, which share the load: what they exert, and what presses them,
    /// follows from those forces. `loose`: contact and axis of each.
    std::vector<double> forces_with_joints(const Mode& mode, double t, std::vector<double> x,
                                           const std::vector<std::size_t>& sharing,
                                           const std::vector<std::pair<int, int>>& loose,
                                           const std::vector<double>& force, const mechanics::Square& directions,
                                           const std::vector<mechanics::Cone>& cones, double size) const;
    /// As strike(), with friction.
    std::vector<double> strike_rough(const Mode& before, double t, std::span<double> x, const std::vector<int>& struck,
                                     Strokes& strokes) const;
    /// The same contacts, those that slip faster by far than anything comes pushed along what slips, in its direction;
    /// whether there are any.
    bool slip_on(const Mode& before, double t, const std::vector<mechanics::Moving<double>>& all,
                 const std::vector<int>& struck, Touched& touched) const;
    /// What became of contacts that were closed and are.
    void tell_friction(const Mode& mode, const Mode& after, const Fired& fired,
                       const std::vector<mechanics::Moving<double>>& before,
                       const std::vector<mechanics::Moving<double>>& now, std::vector<Happening>& happenings) const;
    void own_parameters(Mode& mode, std::span<const double> x) const override;
    /// Whether a body slides straight on rough planes of the world and does not turn (tree_straight.ipp).
    bool keeps_straight(const Mode& mode, int body, std::span<const double> x) const;
    // --- what comes to rest (tree_rest.ipp) ---

    /// Whether a body that touches surfaces is at rest on all of them, and stays so, but for rounding.
    bool is_at_rest(const Mode& mode, int body, double t, const mechanics::TreeState& state) const;
    /// Where in a mode it is said that all bodies stand still (1) or not (0); of scenes with contacts.
    std::size_t place_of_standing() const { return at(first_loose()); }
    bool is_standing(const Mode& mode) const { return contacts() > 0 && mode.slip[place_of_standing()] != 0; }
    void leave_standing(Mode& mode) const;
    /// Whether contacts of two modes do the same, whether or not all bodies stand still.
    bool same_states(const Mode& a, const Mode& b) const;
    /// Makes of a mode one that has no rates, if nothing moves from here on, until a guard says otherwise.
    void come_to_stand(Mode& mode, double t, std::span<const double> x) const;
    /// Whether all bodies touch something and all are at rest, their forces in balance: those that hold each other
    /// leave accelerations of rounding, which what is at rest has not.
    bool is_balanced(const Mode& mode, double t, std::span<const double> x) const;
    /// Whether what loads change in time moves nothing, as long as all that is held is.
    bool is_held_in_time(const Mode& mode, double t, std::span<const double> x) const;
    /// Takes what rounding has left of velocities that the rows of a mode hold at zero.
    void quiet(const Mode& mode, double t, std::span<double> x, std::span<double> rest) const;
    /// Sets to zero the velocities that rows leave nothing that they could be.
    void set_to_rest(const std::vector<int>& rows, double t, std::span<double> x, std::span<double> rest) const;
    /// Whether joints, rails or their surfaces move as functions of time say.
    bool is_driven() const;
    /// Which bodies come to rest, from a mode and the state `was` in it.
    void tell_rest(const Mode& mode, std::span<const double> was, const Mode& after, double t,
                   std::span<const double> x, std::vector<Happening>& happenings) const;

    /// Why a motion ends whose disc lies flat, but for a `tilt` [rad]; nothing if none does.
    std::string lies_flat(const std::vector<int>& closed, const std::vector<mechanics::Moving<double>>& all,
                          double tilt = 1e-6) const;
    /// Below that no point of a rim is the lowest, for rounding.
    static constexpr double no_tilt = 1e-12;

    /// What contacts tell at one instant: by kind, then by name.
    void put_in_order(std::vector<Happening>& happenings) const;

    /// What is held, and the slip of what stops along a line, at an event: zero to rounding, not to the tolerance of
    /// the step to there, and a slip that begins then begins with nothing.
    void set_exactly(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
                     std::span<double> rest) const;

    /// Takes from the velocities what moves contacts, by impulses along their normals, less the friction of those that
    /// slide, and of joints. Returns those that do not slide any more.
    std::vector<int> stop(double t, std::span<double> x, const std::vector<int>& of, const std::vector<int>& stuck,
                          const friction::JointLaw* law = nullptr) const;
    // --- bounces that get ever shorter (tree_bounces.ipp) ---

    /// The bounces that are not followed.
    struct LeftOut {
        double time = 0.0;         // s: the sum of those to come
        double unsure = 0.0;       // s: by how much it may be another
        bool is_summed = false;    // to first order in their speed, from where that is the rounding of places
        bool slid = false;         // what touched slid until the last of them
        double pull = 0.0;         // m/s^2: how fast they are pressed together
        bool is_by_turns = false;  // of contacts that no force presses together
    };
    /// The contacts that strike by turns after an impact, ever slower and without end though no force presses them
    /// together, once rounding is about to take the speeds that are left for none. First those that are among
    /// `closed`.
    std::vector<int> ending_by_turns(const Mode& after, double t, std::span<const double> x,
                                     std::span<const double> rest, const std::vector<int>& closed, LeftOut& left) const;
    /// The contacts that bounce on after an impact, if doubles cannot tell any of these bounces from rest: they are as
    /// short as the rounding of the time. `came` [m/s]: the speed of the fastest that has struck.
    std::vector<int> accumulating(const Mode& after, double t, std::span<const double> x, std::span<const double> rest,
                                  const std::vector<int>& closed, double came, LeftOut& left) const;
    /// Attitudes that a step leaves with a norm that is 1 but for its error, as they are where contacts change: what is
    /// recorded of them has their length, what is computed here has not, and a rate that is less than the one beside
    /// the other would be another one.
    void make_attitudes_unit(std::span<double> x, std::span<double> rest) const;
    /// Whether a contact that came with a speed and strikes alone, after a flight, has bounces left that are longer
    /// than the rounding of the time.
    bool goes_on_bouncing(int contact, double t, double flight, double speed,
                          const std::vector<mechanics::Moving<double>>& all) const;
    /// The contacts that strike each other by turns, ever slower, in flights that take no time: as a smooth column of
    /// balls does. All of these impacts are taken at once, by the same law; none if they end otherwise. First those
    /// that are among `closed`.
    std::vector<int> collapsing(const Mode& before, const Mode& after, double t, std::span<double> x,
                                std::span<const double> rest, const std::vector<int>& closed, Strokes& strokes) const;
    /// Of closed contacts those that impulses at some of them reach, through the bodies they join.
    std::vector<int> reached(const std::vector<int>& closed, const std::vector<int>& landing) const;
    /// The gaps of contacts, of a state in 32 digits.
    std::vector<double> fine_gaps(double t, std::span<const double> x, std::span<const double> rest) const;
    /// Moves a state so that contacts touch, to 32 digits.
    void meet(double t, std::span<double> x, std::span<double> rest, const std::vector<int>& of) const;
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    /// Whether several contacts that bounce by turns, or together, are followed as far as one is: with friction only
    /// where nothing slides meanwhile, and each of them loses speed. What sticks is a point to turn about, held as by
    /// constraints.
    bool follows_together(const Mode& mode) const;
    /// Whether gaps are known beyond doubles in all modes.
    bool follows_gaps() const;
    // heights, in sizes, below which gaps are followed to 32 digits: from there to the rounding of doubles it is as far
    // as the square root of that
    static constexpr double low_bounce = 0x1p-14;
    static constexpr double lowest_bounce = 4096.0;  // in units of the rounding of the gap
    // flights, in roundings of the time, below which bounces of what slides meanwhile have no digits left
    static constexpr double mixed_bounce = 0x1p14;
    // of the speed along the surface, some times what impulses take for rounding
    static constexpr double slowest_bounce = 3e-14;
    static constexpr double slow_bounce = 1024.0;  // of that: where friction may hide by rounding what an impact loses
    // of their speed, some times what impulses take for rounding in what strikes by turns
    static constexpr double slow_turn = 1e-12;
    // flights this much longer than the rounding of the time are not the last ones
    static constexpr double many_roundings = 0x1p20;
    /// What a row has of acceleration at a state, and the size of what that is made of.
    static std::pair<double, double> acceleration_along(const mechanics::Row<double>& row,
                                                        const mechanics::TreeState& state);
    /// Of a slip, along both directions across its normal.
    static std::array<double, 2> slip_acceleration(const mechanics::Touching<double>& touching,
                                                   const mechanics::TreeState& state);
    /// Accelerations of the gaps of contacts in a mode where they are open, and the sizes of what these are made of.
    std::pair<std::vector<double>, std::vector<double>> opening(const Mode& mode, double t, std::span<const double> x,
                                                                const std::vector<int>& of) const;
    /// Of all rows those of the constraints that are used.
    std::vector<mechanics::Row<double>> constraints_of(const std::vector<mechanics::Row<double>>& every) const {
        std::vector<mechanics::Row<double>> used;
        for (const int r : rows_) used.push_back(every[at(r)]);
        return used;
    }
    /// The same, and of what friction in joints holds.
    std::vector<mechanics::Row<double>> constraints_of(const Mode& mode,
                                                       const std::vector<mechanics::Row<double>>& every) const;
    /// J M^-1 J^T of contacts, the constraints held.
    std::vector<std::vector<double>> coupling(const std::vector<mechanics::Moving<double>>& all,
                                              const std::vector<int>& of) const;
    /// The output that tells of the force of a contact that is closed in a mode; -1: it has none of its own.
    static int force_of(const Mode& mode, int contact);
    /// The sizes of all forces on what a contact joins [N].
    double forces_at(int contact, const mechanics::TreeState& state) const;
    /// Whether the force of a contact that has come to zero goes on below it, by more than rounding.
    bool ends(const Mode& mode, int contact, double t, std::span<const double> x) const;
    /// Whether a contact would have to pull, or friction to leave its cone, at a state.
    bool pulls(const Mode& mode, double t, std::span<const double> x) const;

    // --- what follows guards of contacts (tree_touch.ipp) ---

    struct Encounter;
    void touch(const Mode& mode, Mode& after, std::span<const int> fired, double t, std::span<double> x,
               std::span<double> rest, std::span<const double> largest, std::vector<Happening>& happenings) const;

    // --- what of the errors of forces is judged where slips end (tree_slip_parts.ipp) ---

    /// Of what is at a state, the parts of errors that count: of the force of a contact, and of what holds bodies.
    class SlipParts {
    public:
        SlipParts(const TreeModel& model, const Mode& mode, const mechanics::TreeState& state);
        double of_contact(int k) const;
        double on(int body) const;
        double between(int a, int b) const;

    private:
        struct Slip {
            int contact, group;
            double part;  // what it is of the speeds that make it up
        };
        static constexpr int none = -1;
        int group_of(const std::array<int, 2>& bodies) const;
        /// Of a group, the least; the one of `contact` counts in full until it is a thousandth.
        double part(int group, int contact) const;
        std::vector<Slip> slips_;
        std::vector<std::array<int, 2>> contacts_;
        std::vector<int> group_;
        std::vector<double> parts_;  // of bodies
    };

    // --- rolling and pivoting (tree_rolling.ipp) ---

    int resistances() const { return static_cast<int>(conditions_->resistances().size()); }
    signed char resisting(const Mode& mode, int resistance) const { return mode.slip[at(contacts() + resistance)]; }
    std::size_t place_of_resistance(int resistance) const {
        return mechanics::ContactMemory::place(contacts()) + at(mechanics::ResistanceMemory::numbers * resistance);
    }
    mechanics::ResistanceMemory resistance_memory(const Mode& mode, int resistance) const {
        return mechanics::ResistanceMemory::of(mode.memory.data() + place_of_resistance(resistance));
    }
    /// settle_rough() where contacts resist rolling or pivoting.
    void settle_resisted(const Mode& before, Mode& mode, double t, std::span<double> x,
                         const std::vector<int>& candidates, const Fired& fired) const;
    /// What each resistance does: of contacts that open, nothing; of those that break, they begin to turn.
    void decide_resistances(const Mode& before, Mode& mode, double t, std::span<double> x,
                            const std::vector<int>& closed, const Fired& fired,
                            const std::vector<std::pair<int, std::array<double, 2>>>& breaking) const;
    /// How a contact turns, along the directions of a resistance.
    std::array<double, 2> rate_of(int resistance, const std::vector<mechanics::Moving<double>>& all) const;
    /// The torque of a unit of normal force on the first side of a contact that turns.
    Vector3 twisting(const Mode& mode, int contact, const std::vector<mechanics::Moving<double>>& all) const;
    /// What became of resistances of contacts that were closed and are.
    void tell_rolling(const Mode& mode, const Mode& after, std::vector<Happening>& happenings) const;
    /// The rows of constraints that are used, and of resistances and joints that are held.
    std::vector<int> rows_without_contacts(const Mode& mode) const;

    // --- friction in joints (tree_joints.ipp) ---

    std::size_t place_of_joint(int joint) const {
        return place_of_resistance(resistances()) + at(mechanics::JointMemory::numbers * joint);
    }
    int first_joint() const { return contacts() + resistances(); }
    mechanics::JointMemory joint_memory(const Mode& mode, int joint) const;
    /// The state after a short time, by the rates of its variables.
    template <class Rate>
    static std::vector<double> moved_on(std::span<const double> x, double time, const Rate& rate) {
        std::vector<double> there(x.begin(), x.end());
        for (std::size_t i = 0; i < there.size(); ++i) there[i] += time * rate(i);
        return there;
    }
    /// Which rough joints at rest are held and which slide. May find that no motion satisfies the laws. `breaking`:
    /// those that are at their static limit and leave it.
    void settle_joints(const Mode& before, Mode& mode, double t, std::span<double> x, std::vector<int> breaking) const;
    void decide_joints(const Mode& before, Mode& mode, double t, std::span<double> x,
                       const std::vector<int>& breaking) const;
    /// The state of a joint that slides, and what a mode remembers of it: its rate, what the rounding of the time may
    /// make of it, the larger of its accelerations with and without friction, what presses it, and the size of what
    /// that is made of.
    signed char sliding_state(Mode& mode, int joint, double t, std::span<const double> x, int sign, bool begins,
                              double rate, double late_rate, double acceleration, double length,
                              const std::array<double, 2>& load, double load_size) const;
    /// V of a rail's surface in a mode, which knows the side of a jump [m/s].
    double surface_speed(const Mode& mode, int joint, double t, std::span<const double> x) const;
    /// The rate that a joint slides with in a mode that comes from another one; zero where it is that but for rounding.
    double slip_of(const Mode& before, const Mode& mode, int joint, double t, std::span<const double> x) const;
    /// Has a joint at rest, a bead as fast as what it lies on.
    void carry(const Mode& mode, int joint, double t, std::span<double> x) const;
    /// Whether the speed of a rail's surface jumps from one mode to the next.
    bool surfaces_jump(const Mode& mode, const Mode& after, double t, std::span<const double> x) const;
    /// Whether what is held has come beyond its limit at a state, by what jumped.
    bool joints_slip(const Mode& mode, double t, std::span<const double> x) const;
    /// What guards of joints say of their states, and which of them stop with what stops there, joints or contacts: all
    /// that has one freedom does, and what is left of its rates is rounding. Returns whether more than their form
    /// changes.
    bool heed_joints(const Mode& mode, Mode& after, std::span<const int> fired, double t, std::span<double> x,
                     Fired& events, std::vector<Happening>& happenings) const;
    // --- friction in joints beside contacts (tree_joint_contacts.ipp) ---

    /// What joints that slide in a mode do against what presses them.
    std::optional<friction::JointLaw> joint_law(const Mode& mode, double t) const;
    /// settle_rough() or settle_resisted(): what contacts do while joints do what they do in a mode.
    void settle_contacts(const Mode& before, Mode& mode, double t, std::span<double> x,
                         const std::vector<int>& candidates, const Fired& fired) const;
    /// Adds the contacts that stop with joints that do.
    void stop_with_joints(const Mode& mode, double t, std::span<const double> x, Fired& fired) const;
    /// Those of some contacts that were pressed, or have fired: without those whose forces have come to zero.
    std::vector<int> still_pressed(const Mode& before, double t, std::span<const double> x,
                                   const std::vector<int>& candidates, const Fired& fired) const;
    /// The same, and what joints do.
    void settle_all(const Mode& before, Mode& mode, double t, std::span<double> x, const std::vector<int>& candidates,
                    const Fired& fired) const;
    struct Rubbed;
    /// What joints that go on in some way, and contacts, exert: from directions in which the joints are pressed at
    /// first.
    Rubbed pressed(const Mode& before, const Mode& mode, double t, std::span<double> x,
                   const std::vector<int>& candidates, const Fired& fired, const std::vector<int>& sign,
                   std::vector<std::array<double, 2>> along) const;
    /// One way that joints may go on, in place of those that a mode has: what contacts do then, and how far joints are
    /// from their laws.
    Rubbed tried(const Mode& before, const Mode& mode, double t, std::span<double> x,
                 const std::vector<int>& candidates, const Fired& fired, const std::vector<int>& sign) const;
    /// A contact that is closed at rest where held joints alone keep its gap, at this place if not at others: the sign
    /// that the gap takes without its force, and the joints but for which it could change.
    struct Gap {
        int contact, sign;
        std::vector<int> joints;
    };
    std::vector<Gap> gaps_beside_held(const Mode& mode, double t, std::span<double> x,
                                      const std::vector<int>& candidates) const;
    /// The friction in joints and what presses them, by a mode's equations: 5 numbers of each.
    std::vector<double> said_of_joints(const Mode& mode, double t, std::span<const double> x) const;
    /// Impulses of contacts and of joints, from velocities before and those that contacts are thrown back with.
    struct Jolt;
    Jolt jolted(const Touched& touched, const std::vector<double>& u, const std::vector<double>& back,
                const std::vector<double>& noise, const std::vector<double>& slip, double t) const;
    /// What follows guards of joints.
    void rub(const Mode& mode, Mode& after, std::span<const int> fired, double t, std::span<double> x,
             std::vector<Happening>& happenings) const;

    /// What became of them.
    void tell_joints(const Mode& mode, const Mode& after, std::vector<Happening>& happenings) const;

    // --- loops and driven joints (tree_loops.ipp) ---

    /// Chooses the rows that are used. Refuses what the others would lose when the scene moves.
    void choose_rows();

    // --- rows that are chosen anew (tree_rows.ipp) ---

    /// Where in a mode it is said which rows of constraints are used, and behind them when others are looked for and
    /// how often that was in vain; of scenes in which rows may be chosen.
    std::size_t place_of_rows() const { return at(first_loose()); }
    /// The rows of constraints that are used in a mode.
    std::vector<int> used_rows(const Mode& mode) const;
    /// Those that are most independent where bodies are.
    std::vector<int> rows_at(const std::vector<mechanics::Moving<double>>& all) const;
    /// log10 of det(J M^-1 J^T) of some over the product of their units.
    double independence_of(const std::vector<int>& rows, const std::vector<mechanics::Moving<double>>& all) const;
    /// Takes others where those of a mode have come near to depending on each other, if others have not, and decides
    /// where that is looked at again.
    void renew_rows(Mode& mode, double t, std::span<const double> x) const;
    /// Moves a state onto the rows of a mode where engines that do not have left it beside them.
    void close_rows(const Mode& mode, double t, std::span<double> x) const;
    /// What is left of each of the rows of a mode beside those before it.
    std::vector<double> pivots_of(const Mode& mode, double t, std::span<const double> x) const;
    /// Variables that share a scale. What constraints hold in all places has rounding of its own, and is measured by
    /// the rest.
    std::vector<VariableGroup> groups_in(const mechanics::Tree& tree, bool is_constrained) const;
    /// Tells where other rows are looked for.
    void guard_rows(EquationsWriter& write, const mechanics::TreeWriter& tree, const Mode& mode) const;
    /// How far the bodies and the ends of constraints are from each other [m].
    double size_of(const std::vector<mechanics::Moving<double>>& all) const;
    /// Guards what the used rows alone do not hold, and their independence.
    /// What acts where constraints all but lose rank: of the nearest state that satisfies them to 32 digits, for forces
    /// there are known to the rounding of the state over the square of the distance. None elsewhere.
    std::optional<Acting> acting_near_singular(const Mode& mode, double t, std::span<const double> x) const;
    void guard_loops(EquationsWriter& write, const mechanics::TreeWriter& tree, const Mode& mode,
                     const RecordedFor& state) const;
    /// Why no motion goes on where a constraint opens.
    std::string opened(double t, std::span<const double> x) const;
    /// Why no motion goes on where the coordinate of a driven joint, or its rate, jumps from one mode to the next;
    /// empty if none does.
    std::string jump_of_drives(const Mode& before, const Mode& after, double t, std::span<const double> x) const;
    void require_finite_drives(double t) const;
    /// Throws InvalidInput for what starts at an end of its curve and moves off it.
    void require_no_end(const Mode& mode, double t, std::span<const double> x) const;
    /// The constraints of which some rows depend on others, but for a small part; empty if none do.
    std::string locked(double t, std::span<const double> x) const;

    /// Moves a state onto the rows of a mode. `rest`: what it is short of.
    void hold(const Mode& mode, double t, std::span<double> x, std::span<double> rest) const;
    std::unique_ptr<Structure> record(const Mode& mode, const RecordedFor& state) const override;

    // --- actions that change the state (tree_change.ipp) ---

    /// What a motion begins with: which contacts are closed, struck, slide, which joints are held. Of one that comes
    /// from another mode, which has equations, tells what becomes of them.
    /// `was`: the state there; empty at a start.
    Mode decided_anew(const Mode& before, std::span<const double> was, double t, std::span<double> x,
                      std::vector<Happening>& happenings) const;
    /// Of closed contacts those whose sides go on to move against each other as they did, but for rounding: along the
    /// normal, and of held ones altogether.
    struct Kept {
        std::vector<int> along, held;
    };
    Kept kept_closed(const Mode& mode, double t, std::span<const double> was, std::span<const double> x) const;
    /// The value of a watched function, which may be called back.
    double called(const Scene::Watch& watch, const Mode& mode, double t, std::span<const double> x) const;
    /// Changes the state as the action of a watched function says. Returns whether it does. Throws InvalidInput for
    /// words that are not a joint's own, for driven joints, and for what leaves constraints open or contacts inside
    /// each other.
    bool change(const Mode& mode, const Scene::Watch& watch, double t, std::span<double> x) const;
    /// How near, of its size, a contact of a mode is taken to touch.
    double nearest_touch(const Mode& mode, int contact) const;
    /// How far time as drives are written with it is ahead of the time [s]: who places something where such a drive is
    /// knows that to the rounding of both.
    double ahead() const;
    /// What the rounding of the time, as drives are written, makes of the rates of the gaps of contacts, and of what
    /// slips there.
    struct PhaseRounding {
        std::vector<double> normal, slip;
    };
    PhaseRounding phase_rounding(double t, std::span<const double> x) const;
    /// That what no friction lets slide does not as a scene starts.
    void require_no_slip(int contact, double slip, bool is_stuck) const;
    void tell_anew(const Mode& mode, const Mode& after, const std::vector<double>& impulses, const Strokes& strokes,
                   const std::vector<mechanics::Moving<double>>& before,
                   const std::vector<mechanics::Moving<double>>& now, std::vector<Happening>& happenings) const;

    std::vector<mechanics::Moving<double>> moving(double t, std::span<const double> x) const;

    // --- beads that may leave their rails (tree_rails.ipp) ---

    int first_loose() const { return first_joint() + static_cast<int>(joints_.size()); }
    void take_loose_rails();
    /// Where beads fly they hang on nothing.
    const std::shared_ptr<const mechanics::Tree>& tree_in(const Mode& mode) const;
    std::vector<mechanics::Moving<double>> moving(const Mode& mode, double t, std::span<const double> x) const;
    bool is_flying(const Mode& mode, int body) const;
    void guard_loose(EquationsWriter& write, const mechanics::TreeWriter& tree, const Mode& mode) const;
    /// Whether a guard is one of a bead that leaves its rail or comes back.
    static bool loosens(const Guard& guard) {
        return guard.contact < 0 && guard.joint < 0 &&
               (guard.kind == EventKind::detach || guard.kind == EventKind::land ||
                (guard.kind == EventKind::rail_end && guard.role == GuardRole::mode));
    }
    void release(Mode& mode, std::size_t loose, double t, std::span<double> x) const;
    /// Puts a bead on its rail again; returns the impulse of that [N s].
    double land(Mode& mode, std::size_t loose, double t, std::span<double> x) const;
    /// What joints do against an impulse that has put a bead on its rail, from motions before it.
    void rub_landing(const Mode& mode, double t, std::span<double> x,
                     const std::vector<mechanics::Moving<double>>& before) const;
    /// Whether a bead comes past its curve beside the plane of it.
    bool misses(const Mode& mode, std::size_t loose, double t, std::span<const double> x) const;
    /// Lets a bead go that its rail would have to pull, or that moves off its end. Returns whether there is one.
    bool let_go(Mode& mode, double t, std::span<double> x, std::vector<Happening>* happenings) const;
    /// What joints do then, and which beads leave at once.
    void settle_loose(const Mode& before, Mode& mode, double t, std::span<double> x,
                      std::vector<Happening>* happenings) const;
    void leave_or_land(const Mode& mode, Mode& after, std::span<const int> fired, double t, std::span<double> x,
                       std::vector<Happening>& happenings) const;
    /// All that is known at a state of a mode.
    mechanics::TreeState look(const Mode& mode, double t, std::span<const double> x) const;
    bool has_angles(int body) const { return !tree_->node(body).is_point; }
    /// All variables as the scene starts, on its constraints.
    std::vector<DoubleDouble> exact_start(double t) const;
    /// All variables moved onto the constraints from where they nearly are. `what` put them there, in words.
    std::vector<DoubleDouble> onto_constraints(double t, std::vector<DoubleDouble> x, const std::string& what) const;

    Scene scene_;
    std::shared_ptr<const mechanics::Tree> tree_;
    std::shared_ptr<const mechanics::Conditions> conditions_;
    std::shared_ptr<const mechanics::Exerted> exerted_;
    std::vector<mechanics::RoughJoint> joints_;
    std::vector<mechanics::LooseRail> loose_;
    std::vector<std::shared_ptr<const mechanics::Tree>> trees_;  // by which of the loose beads fly
    std::vector<int> rows_;                                      // of the constraints, those that are used
    bool has_choice_ = false;                                    // others could be used in their place
    bool is_uneven_ = false;                                     // J M^-1 J^T has lost digits where it starts
    std::vector<double> units_;                                  // of all rows, what they could be where it starts
    std::vector<bool> held_;                                     // what they leave no motion: see held_still()
    double size_ = 0.0;                                          // of the scene as it starts, if it has constraints [m]
    std::vector<DoubleDouble> start_;                            // on them, at t = 0
    std::vector<double> first_pivots_;                           // of these, where the scene starts
    double loosest_ = 0.0;  // the gap that constraints with other rows may have [m]
    StateMap map_;
    std::string why_all_;
};

}  // namespace rbdyn::inline RBDYN_FORM
