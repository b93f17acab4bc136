// Dormand and Prince's explicit Runge-Kutta method of order 8, as an engine.
//
// Source: Hairer, Norsett and Wanner, "Solving Ordinary Differential Equations I", 2nd edition, Springer 1993: the
// method and its error estimate from embedded ones of order 5 and 3 (sec. II.5), step control (II.4), and the
// interpolant of order 7, a polynomial of degree 7 with the states and slopes of both ends (II.6).
//
// Conventions: errors are measured against the scales of the motion itself (extent of positions, largest velocities) or
// of the step where there is none yet; nothing here has a unit, and the same motion in units that differ by powers of
// two takes the same steps to the last bit. Slopes are kept as differences from the one at the start of the step, for
// the weights of the method are far larger than their sum. Sums are compensated and step lengths exact (see
// taylor.hpp). Invariant: a piece is the whole step or, where guards ask for shorter ones, a part of it; pieces join to
// rounding.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/dop853_step.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/motion_scales.hpp"
#include "rbdyn/engine/piece_guards.hpp"
#include "rbdyn/expression/borrowed_series.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/hidden_terms.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/rounding_sizes.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Dop853Engine : public Engine {
public:
    /// Local error per step relative to the motion's scales. `fits_guards`: through values even where series are known.
    /// `stride`: how much of the steps that the tolerance allows, and of a mode in its first one, is taken.
    /// `rounding`: of constants.
    explicit Dop853Engine(double tolerance, bool fits_guards = false, double stride = 1.0,
                          Program::Rounding rounding = Program::Rounding::nearest);

    std::string name() const override;

    void carry(std::span<const double> rest) override;

    void start(const Equations& equations, std::span<const double> parameters, Instant t,
               std::span<const double> x) override;

    StepStatus step(double limit) override;

    double natural_length() const override;

    /// A step of the method itself to where the state is asked for; from there on, within a thousandth of the piece,
    /// differences of the polynomial: whoever looks for a root asks for many states close to each other.
    void state(double tau, std::span<double> x) const override;

    bool refines() const override;

    const double* guard(int index) override;
    int guard_order() const override;
    void guard_sizes(int index, double* sizes) override;
    bool is_rough(int guard) const override;
    bool is_far(int guard) const override;
    bool fits_guards() const override;

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static constexpr int order = Dop853Step::order;
    static constexpr int series_order = 12;
    static constexpr double tiny = 0x1p-960;  // no motion: where doubles end they lose their digits
    // the interpolant's slope at the place of its defect is two to four times its error's largest value
    static constexpr double defect_weight = 0.25;
    static std::size_t at(int index) { return static_cast<std::size_t>(index); }

    /// What one set of equations needs.
    struct Workshop {
        Workshop(const Equations& equations, bool fits_guards, double tolerance);
        Evaluator<double> evaluator;
        std::unique_ptr<const BorrowedSeries> series;
        HiddenAhead ahead;
        PieceGuards guards;
        std::optional<RoundingSizes> sizes;  // once there are many rejections
        double step = 0.0;                   // the length of the next one; 0: not known yet
    };

    Workshop& workshop_for(const Equations& equations);

    int n() const { return n_; }

    void resize(std::size_t variables);

    void set_parameters();

    /// x' at (t, x); false if it is not finite, or not asked for since x is not.
    bool evaluate(Instant t, std::span<const double> x, double* slope) const;

    /// Where the next step begins.
    Dop853Step::Start here() const { return {t_, x_.data(), low_.data(), slope_.data()}; }
    /// The state there, without the zeros after it.
    std::span<const double> now() const { return {x_.data(), at(n())}; }

    /// The span, or as much of it that Euler's method over it, twice, does not make a slope sixteen times as large.
    ///
    /// The stages of a step that is much too long run away; functions of the user's are not to be asked about that.
    double first_step(double span);

    /// Tries a step of length h; returns its error over the one allowed.
    double attempt(double h);

    /// An error of a step over the one allowed, without what rounding makes of it where that counts.
    double blamed(double error, double h, std::size_t g) const;

    /// What rounding does to the slopes: that of time and state, for a motion far from their origin, that of the terms
    /// which slopes are made of, where forces in balance let go, and what this does to other slopes within a step, in
    /// proportion to its length. No shorter step has less of it; so it is taken off what a step is blamed for, for one
    /// that is only forgiven would never grow again.
    ///
    /// `by_sizes`: by the sizes of the terms of all that slopes are computed from, too, which takes longer: one other
    /// state may show nothing of what is lost where they are solved for.
    void find_rounding(double h, bool by_sizes);

    /// How much longer the next step may be; the error goes as its eighth power. Estimates of what swings pass through
    /// zero, so that at nine tenths, not three quarters, of the length that they promise a fourth of the steps is
    /// rejected.
    static double factor(double error);

    /// The polynomial through the step that was tried last; returns its error over the one allowed.
    double interpolate(double h);

    /// Takes the step that was tried last: its piece, and where it goes on from.
    void finish(double h, Instant end, double natural);

    /// Shortens the piece to where the coefficients of its guards hold.
    void cut(bool is_rest);

    /// The next part of a step that was cut; it counts for max_steps, for its guards cost as much.
    StepStatus next_part();

    /// The state at a place of the whole step by a step of its own; false if a slope on the way is not finite.
    bool anchor_at(double place) const;

    double tolerance_;
    bool fits_guards_;
    double stride_;
    Program::Rounding constants_;
    const Equations* equations_ = nullptr;
    Workshop* workshop_ = nullptr;
    int n_ = 0;  // variables
    std::vector<std::pair<const Equations*, std::unique_ptr<Workshop>>> workshops_;
    std::vector<double> parameters_;

    Instant t_;  // where the motion has come to
    // the state there, what rounding left out of it, and its slope; zeros after them (dop853_step.hpp)
    Dop853Step::Doubles x_, low_, slope_;
    Instant start_t_;  // the same at the start of the last step
    Dop853Step::Doubles start_, start_low_, start_slope_;
    mutable Dop853Step step_;
    std::vector<double> y_, defect_;  // another state; and slope
    bool has_slope_ = false, is_first_ = true, is_cut_ = false;
    Piece whole_;                          // the whole step, where guards cut it
    double offset_ = 0.0, natural_ = 1.0;  // where the piece begins on it
    Dop853Step::Doubles coefficients_;     // of the whole step
    std::vector<double> part_;             // of a part of it
    std::vector<double> allowed_;          // per group, error of the step that is tried
    static constexpr int many_rejections = 6;
    int rejections_ = 0;                        // of late: two more for each, one less for a step without
    std::vector<double> rounding_, spread_;     // per group, what rounding does to slopes, and more of it in unit time
    mutable double anchor_ = 0.0;               // a place on the whole step
    mutable std::vector<double> anchor_state_;  // and the state there
    MotionScales scales_;
    std::vector<double> estimates_, next_estimates_;  // per group, its scale where there has been no motion yet
};

}  // namespace rbdyn::inline RBDYN_FORM
