// SUNDIALS CVODE as an engine: variable-order Adams, and BDF with the exact Jacobian for stiff motion.
//
// Source: Hindmarsh and others, "SUNDIALS: suite of nonlinear and differential/algebraic equation solvers", ACM
// Transactions on Mathematical Software 31 (2005) 363-396. Both methods carry a polynomial of their order q that
// passes through both ends of a step (Byrne and Hindmarsh, ACM TOMS 1 (1975) 71-96): a step is a piece, and pieces
// join to rounding.
//
// Conventions: CVODE's clock is zero where smooth motion starts, so that short steps late in a run keep their digits.
// Error weights follow the scales of the motion itself (extent of positions, largest velocities); nothing here has a
// unit, and the same motion in units that differ by powers of two takes the same steps to the last bit.
// CVODE's root finder is not used: guards are series on the pieces, as for every engine. What begins at a zero of its
// guards (a bead that leaves its rail leaves it with the third power of time) tells them apart by more orders than
// CVODE's first steps have: the first piece after an event is a step of a Taylor series, of dop853 where functions are
// called back, and CVODE goes on from its end.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/cvode_integrator.hpp"
#include "rbdyn/engine/cvode_vector.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/motion_scales.hpp"
#include "rbdyn/engine/piece_guards.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// CVODE, one internal step a piece. Adams for smooth motion, BDF for stiff motion.
class CvodeEngine : public Engine {
public:
    enum class Method { adams, bdf };

    /// Local error per step relative to the motion's scales. `rounding`: of constants.
    CvodeEngine(Method method, double rtol, Program::Rounding rounding = Program::Rounding::nearest)
        : method_(method), rtol_(rtol), rounding_(rounding), context_(cvode::make_context()) {}
    CvodeEngine(const CvodeEngine&) = delete;
    CvodeEngine& operator=(const CvodeEngine&) = delete;

    std::string name() const override;

    void start(const Equations& equations, std::span<const double> parameters, Instant t,
               std::span<const double> x) override;

    /// The scales of the motion before it.
    void recall(std::span<const double> memory) override;

    StepStatus step(double limit) override;

    void state(double tau, std::span<double> x) const override;

    double natural_length() const override;
    bool refines() const override;

    const double* guard(int index) override;
    int guard_order() const override;
    bool fits_guards() const override;
    bool is_rough(int guard) const override;
    bool is_far(int guard) const override;
    void guard_sizes(int index, double* sizes) override;
    void rest(double tau, std::span<const double> x, std::span<double> low) const override;

private:
    /// The first piece of a mode, by the engine for that. Returns whether there is one.
    bool set_off(double limit);

    /// Guards with a singularity near the motion, 1 / (1.1 + sin u) on a pendulum through sin u = -1, are then cut off
    /// below the error of the method for tolerances from 1e-6 on, smooth ones at rounding.
    int series_order() const { return rtol_ > 1e-8 ? 18 : 14; }

    static constexpr int start_order = 12;  // of the Taylor series that tells scales and the first step
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static std::size_t at(int index) { return static_cast<std::size_t>(index); }

    cvode::Integrator& integrator_for(const Equations& equations);

    /// Sets CVODE off from the present state; false if the derivative there is not finite.
    bool begin(double limit);

    /// Taylor coefficients of the motion from here, in `unit`; how many orders of them are finite.
    int expand(double span, double& unit);

    /// Estimates how far each group is about to move; returns a first step, in units, for a method of order one.
    double measure(int orders, double span);

    /// About when a guard may be zero first, in units: what happens then is not judged by how far the motion goes on.
    double first_passage(int orders, double span) const;

    /// What the errors of a group are measured against.
    double scale(std::size_t g) const;

    /// Of what constraints tie together the largest scale. They hold in accelerations alone, so that a bar that they
    /// keep at rest moves by the errors of the others: no digits of its own are asked for.
    void tie();

    /// Error allowed in the variables of a group. Never less than rounding of the numbers themselves can give.
    double absolute_tolerance(std::size_t g) const;

    void weigh();

    /// Takes the present state into the scales of the motion.
    void widen();

    /// True if a group that had no scale has moved: nothing watched over its error, so the step is taken again.
    bool found_scale();

    bool slope_is_finite();

    void count_rejected();

    /// CVODE's polynomial about the end of its step, in steps; false if it is not finite.
    bool take_polynomial();

    /// x + x' h, with the slope that was evaluated last.
    void straight_line(double h);

    /// Cuts the piece where the coefficients of its guards hold no longer: CVODE's steps know nothing of guards, and a
    /// bead that is carried at a constant speed takes very long ones.
    void shorten(bool is_rest) { piece_.length = integrator_->guards.begin(piece_, is_rest); }

    /// The next part of a step that was cut; it counts for max_steps, for its guards cost as much.
    StepStatus next_part();

    /// The piece from t_, x_ to the end: the same polynomial about its start.
    void fill_piece(Instant end);

    Method method_;
    double rtol_;
    Program::Rounding rounding_;
    Piece whole_;           // the whole step, where guards cut it
    bool pending_ = false;  // parts of it may be left
    double offset_ = 0.0;   // where the piece begins on it
    std::vector<double> part_;
    cvode::Owned<SUNContext> context_;
    std::vector<std::pair<const Equations*, std::unique_ptr<cvode::Integrator>>> integrators_;
    const Equations* equations_ = nullptr;
    cvode::Integrator* integrator_ = nullptr;

    Instant t_;             // where the motion has come to
    double clock_ = 0.0;    // the same on CVODE's clock
    bool running_ = false;  // CVODE goes on from there
    bool is_first_ = true;  // no step since start()
    bool has_started_ = false, is_restart_ = false;
    std::unique_ptr<Engine> by_series_, by_values_;
    std::vector<double> guard_row_;
    Engine* starter_ = nullptr;  // made the piece; none: CVODE did
    int order_ = 0;
    long steps_ = 0, rejected_ = 0;  // CVODE's counts since it was set off
    std::vector<double> x_, from_end_, coefficients_, parameters_;
    MotionScales scales_;
    std::vector<double> estimates_;  // per group, where the past tells less
    std::array<double, 6> tied_{};   // by what is tied, positions and velocities
};

}  // namespace rbdyn::inline RBDYN_FORM
