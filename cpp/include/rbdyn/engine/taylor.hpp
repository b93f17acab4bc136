// Taylor series method of variable step and fixed order.
//
// Source: Jorba and Zou, Experimental Mathematics 14 (2005) 99-117: order from the tolerance, step from the last
// coefficients. Here the local error is measured against the scales of the motion itself (extent of positions,
// largest velocities), not against the numbers that happen to describe it.
// Sums are compensated and step lengths exact, so that rounding does not grow with the number of steps more than it
// must; what the motion conserves is held after every step, if the equations say how (Hairer, McLachlan, Razakarivony,
// "Achieving Brouwer's law with implicit Runge-Kutta methods", BIT 48, 2008).
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/motion_scales.hpp"
#include "rbdyn/engine/near_singular.hpp"
#include "rbdyn/expression/borrowed_series.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/hidden_terms.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_abreast.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/expression/wide_series.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

class TaylorEngine : public Engine {
public:
    static constexpr int min_order = 12, max_order = 24;

    /// Local error per step relative to the motion's scales; `order` 0: chosen from the tolerance.
    /// `rounding`: of the constants that the projection does not make up for.
    explicit TaylorEngine(double tolerance, int order = 0, Program::Rounding rounding = Program::Rounding::nearest);

    std::string name() const override;

    /// Measured on a hoop, a free and a heavy body: the cost of a run is flat within 10 percent for orders 3 away.
    static int order_for(double tolerance);

    void start(const Equations& equations, std::span<const double> parameters, Instant t,
               std::span<const double> x) override;

    void carry(std::span<const double> rest) override;

    StepStatus step(double limit) override;

    // A step in parts, for one who expands several engines side by side (taylor_abreast.hpp): it begins, the series are
    // expanded as often as it asks for, and it ends.

    /// What came of it if it is over already, made without series.
    virtual std::optional<StepStatus> begin_step(double limit);
    /// What came of it; none if the series are to be expanded anew.
    virtual std::optional<StepStatus> end_step();
    /// Coefficients 0 .. order of the state, and of the guards where there are any.
    void expand();
    /// The same, as they were computed side by side.
    SeriesAbreast::Motion motion() const { return {t_.hi, unit_, x_, series_->weights()}; }
    /// What was computed side by side, each motion's by its engine. Until their next steps begin these are asked for
    /// more.
    static void take(const SeriesAbreast& abreast, std::span<TaylorEngine* const> engines);
    const Program& program() const { return equations_->program; }
    int order() const { return order_; }
    /// Whether there are guards, of which one more coefficient is known than of rates.
    bool has_guards() const { return !equations_->guards.empty(); }

    void rest(double tau, std::span<const double> x, std::span<double> low) const override;

    void standing(std::span<double> x, std::span<double> low) const override;
    std::vector<double> largest() const override { return scales_.largest(); }
    std::vector<double> memory() const override;
    void recall(std::span<const double> memory) override;

    const double* guard(int index) override;
    int guard_order() const override;
    void guard_sizes(int index, double* sizes) override;
    double natural_length() const override;
    bool is_rough(int guard) const override;

protected:
    /// The state to go on from, for one who knows it better.
    std::span<double> replace_state();
    /// Moves the state to where its first integrals are what they were, a time after it was last.
    void hold(double time);
    /// What the state is short of, and was where the last step began.
    std::span<double> low() { return low_; }
    std::span<const double> low_before() const { return start_low_; }
    std::span<const double> parameters() const { return parameters_; }
    Program::Rounding rounding() const { return rounding_; }
    bool is_wide() const { return is_wide_; }
    double tolerance() const { return std::exp2(log_tolerance_); }
    /// Of the step that is begun.
    double limit() const { return limit_; }
    Instant t_;
    MotionScales scales_;

private:
    static std::size_t at(int index) { return static_cast<std::size_t>(index); }

    /// What is made for equations, and kept.
    struct Workshop {
        Workshop(const Equations& equations, int order);
        BorrowedSeries series;
        HiddenTerms hidden;
        NearSingular singular;
        std::unique_ptr<WideSeries> wide = nullptr;  // made where it is needed
        std::vector<int> looked_at;                  // slots, beside the state's and the rates'
    };

    void set_parameters();

    /// 2^round(log2 x)
    static double power_of_two(double x);

    Workshop& workshop_for(const Equations& equations);

    void take(const SeriesAbreast& abreast, int motion);
    /// Takes the rest of coefficients that were computed side by side.
    void complete();

    /// The length of a step near a place where constraints lose rank, expanded anew where doubles lose digits there.
    double near_singular_length(double length, double span);
    /// Expands a step with 32 digits, from a state that satisfies the constraints to as many.
    void expand_widely();
    void expand_widely(const std::vector<DoubleDouble>& x);
    /// Anew where a series runs into a place at which the rounding of what constraints are made of matters; false where
    /// it does not.
    bool expand_beside(const std::vector<std::complex<double>>& places, double length);

    /// The longest step, in units, whose estimated local error is the tolerance times the scale of the motion.
    double step_length(double span);

    /// Whether a guard is a polynomial, exact at any length: of a high degree that is no rounding (a power of a
    /// distance would else be cut shorter and shorter towards its zero).
    bool is_polynomial(const double* c, const Guard& guard);

    /// How much of a step that nothing limits the equations themselves bear out, at 64 places: a series knows them
    /// where it begins, and sees neither a pulse far away nor that a root has passed its zero.
    double borne_out(double length) const;
    /// Whether that is to be seen from their operations: those of polynomials hide nothing.
    static bool may_hide(const Program& program);
    /// A length that the equations bear out at the end of a step at least, halved until they do: where the argument of
    /// a root, a power or a logarithm has passed its zero, a series that happens to be a polynomial goes on.
    double borne_out_at_end(double length);
    /// A length of a step that only an end limits, at whose end what is held is where it is held: rounded forces leave
    /// accelerations there, and what they add up to grows like the square of the time. Takes it from the series.
    double held_at_end(double length);
    /// What held_at_end() asks at a place of the expansion: how far it is off; where that is, and its digits, are left
    /// in end_ and end_low_.
    Projection::Off off_at(double tau);
    /// Takes from the series what the projection takes from a state at a place of the expansion, off_at()'s: of
    /// positions from the coefficients of the square of time, of others from those of time. Returns what these were.
    std::vector<double> straighten(double tau);
    /// Where a step ends that nothing but its series limits: the place in time is exact.
    double probable_end() const;
    /// The state at a place of the expansion, as what is nearest to it and what that is short of it.
    void add_up(double tau, std::span<double> x, std::span<double> low) const;
    static bool has_roots(const Program& program);
    /// Whether a guard is on another side at a place than where the step begins, or may be: the step ends before.
    /// `is_silent`: of those alone where a formula goes over to another one without an event.
    bool passes_guard(double tau, bool is_silent = false) const;
    /// Whether the rates that equations give at a place of the expansion are those of the expansion. `values`: of them;
    /// `duration`: that of the step [s].
    bool bears_out(Evaluator<double>& values, double tau, double duration, std::vector<double>& x,
                   std::vector<double>& slope) const;

    /// Makes steps a little uneven where rounding is the error: steps that come at the same phases of every period
    /// would round alike, and their errors add up.
    double unevenness() const;

    static constexpr double rounding_counts = -46.0;  // log2 of a tolerance
    static constexpr double longest = 0x1p40;         // in units; to the power of max_order it is in range
    // of a step, on the way to a singularity of a guard: what is nearer to it than this cannot be told from it
    static constexpr double most_halvings = 40.0;
    using Sizes = std::array<double, max_order + 1>;

    double log_tolerance_;
    int order_;
    Program::Rounding rounding_;
    const Equations* equations_ = nullptr;
    SeriesEvaluator* series_ = nullptr;
    const HiddenTerms* hidden_ = nullptr;
    Workshop* workshop_ = nullptr;
    bool is_wide_ = false;  // the step has been expanded with 32 digits
    const std::vector<int>* looked_at_ = nullptr;
    const SeriesAbreast* abreast_ = nullptr;  // has the rest of its coefficients; null: there is none
    int lane_ = 0;
    double probable_ = 0.0;         // place of its end, at which the sums are there, too; 0: at none
    std::optional<double> length_;  // of the step by its series, where that was computed with those side by side
    std::vector<std::pair<const Equations*, std::unique_ptr<Workshop>>> workshops_;
    double unit_ = 0.0, natural_ = 0.0;
    double limit_ = 0.0;      // of the step that is begun
    int attempts_ = 0;        // at it
    double overflows_ = 0.0;  // a unit of time in which coefficients of it do
    std::vector<double> x_, low_, start_low_, parameters_;
    std::vector<double> mode_x_, mode_low_;     // the state its mode began with
    double steps_before_ = 0.0;                 // of what it goes on with
    bool is_ready_ = false;                     // for the first step of a mode
    std::unique_ptr<Evaluator<double>> roots_;  // of equations that have roots; none for others
    std::vector<double> end_, end_slope_, end_low_;
    std::vector<signed char> rough_;  // by guard; empty: none is
    std::unique_ptr<const Projection> projection_;
};

}  // namespace rbdyn::inline RBDYN_FORM
