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
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/dop853_coefficients.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/motion_scales.hpp"
#include "rbdyn/engine/piece_guards.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/hidden_terms.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
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
    bool fits_guards() const override;

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static constexpr int order = 7;  // of the interpolant
    static constexpr int series_order = 12;
    static constexpr double tiny = 0x1p-960;  // no motion: where doubles end they lose their digits
    // the interpolant's error is steepest near here, and its slope there two to four times its largest value
    static constexpr double defect_place = 0.65625;
    static constexpr double defect_weight = 0.25;
    static std::size_t at(int index) { return static_cast<std::size_t>(index); }

    /// What one set of equations needs.
    struct Workshop {
        Workshop(const Equations& equations, bool fits_guards, double tolerance);
        Evaluator<double> evaluator;
        std::unique_ptr<SeriesEvaluator> series;
        HiddenAhead ahead;
        PieceGuards guards;
        double step = 0.0;  // the length of the next one; 0: not known yet
    };

    Workshop& workshop_for(const Equations& equations);

    int n() const { return n_; }

    void resize(std::size_t variables);

    void set_parameters();

    /// x' at (t, x); false if it is not finite, or not asked for since x is not.
    bool evaluate(Instant t, std::span<const double> x, double* slope) const;

    /// sum_j w_j k[j stride] with the weights of a row, j = lo .. hi - 1, in pairs of pairs: the same sum everywhere,
    /// and a short way through it.
    template <int row, int lo, int hi>
    static double weighted(const double* k, std::ptrdiff_t stride) {
        if constexpr (hi - lo == 1) {
            constexpr double weight = dop853::weight(row, lo);
            return weight * k[lo * stride];
        } else {
            constexpr int middle = (lo + hi) / 2;
            return weighted<row, lo, middle>(k, stride) + weighted<row, middle, hi>(k, stride);
        }
    }
    /// Where the weights of a stage begin, that of stage 0 left out.
    static constexpr int first_of(int s) {
        int first = 1;
        while (first < s - 1 && dop853::a[s][first] == 0.0) ++first;
        return first;
    }

    /// h^-1 times the change of variable i up to stage s.
    template <int s>
    double advance(const double* slope, int i) const {
        if constexpr (s == 1)
            return dop853::c[1] * slope[i];
        else
            return dop853::c[s] * slope[i] +
                   weighted<s, first_of(s), s>(differences_.data() + i, static_cast<std::ptrdiff_t>(n()));
    }

    /// The slope at stage s of a step of length h from (t, x + low); false if it is not finite.
    template <int s>
    bool stage(Instant t, const double* x, const double* low, const double* slope, double h) const {
        for (int i = 0; i < n(); ++i) y_[at(i)] = x[i] + (low[i] + h * advance<s>(slope, i));
        double* k = differences_.data() + s * n();
        if (!evaluate(t + dop853::c[s] * h, y_, k)) return false;
        for (int i = 0; i < n(); ++i) k[i] -= slope[i];
        return true;
    }
    template <int... s>
    bool stages(std::integer_sequence<int, s...>, Instant t, const double* x, const double* low, const double* slope,
                double h) const {
        return (stage<s + 1>(t, x, low, slope, h) && ...);
    }

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
    void find_rounding(double h);

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

    Instant t_;                            // where the motion has come to
    std::vector<double> x_, low_, slope_;  // the state there, what rounding left out of it, and its slope
    Instant start_t_;                      // the same at the start of the last step
    std::vector<double> start_, start_low_, start_slope_;
    mutable std::vector<double> y_, differences_;  // of the stage; slopes of the stages less that at the start
    bool has_slope_ = false, is_first_ = true, is_cut_ = false;
    Piece whole_;                                     // the whole step, where guards cut it
    double offset_ = 0.0, natural_ = 1.0;             // where the piece begins on it
    std::vector<double> coefficients_, part_;         // of the whole step; of a part of it
    std::vector<double> next_coefficients_, defect_;  // of the step that is tried; of its polynomial
    std::vector<double> allowed_;                     // per group, error of the step that is tried
    std::vector<double> rounding_, spread_;     // per group, what rounding does to slopes, and more of it in unit time
    mutable double anchor_ = 0.0;               // a place on the whole step
    mutable std::vector<double> anchor_state_;  // and the state there
    MotionScales scales_;
    std::vector<double> estimates_, next_estimates_;  // per group, its scale where there has been no motion yet
};

}  // namespace rbdyn::inline RBDYN_FORM
