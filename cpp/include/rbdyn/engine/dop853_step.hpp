// One step of Dormand and Prince's method (dop853.hpp): its stages, its error estimates and its interpolant.
//
// Variables lie side by side, with zeros up to a multiple of four, and sums of slopes are computed two or four
// variables at a time: of each in one fixed order, so that the bits do not depend on how many (series/lanes.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/dop853_coefficients.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/series/lanes.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Dop853Step {
public:
    static constexpr int order = 7;  // of the interpolant
    // the interpolant's error is steepest near here
    static constexpr double defect_place = 0.65625;

    /// Where it begins: time, state, what rounding left out of it, and slope; of padded() variables.
    struct Start {
        Instant t;
        const double *x, *low, *slope;
    };

    static std::size_t padded(std::size_t variables) { return ValueCode::padded(variables); }
    /// The equations, of so many variables.
    void follow(Evaluator<double>& equations, bool calls_back, int variables);

    /// All stages and the error estimates of a step of length h; false if a slope is not finite.
    bool attempt(const Start& from, double h) { return run_(*this, Part::step, from, h); }
    /// After it: the state at the end, and h^-1 times the differences from the embedded methods of order 5 and 3.
    const double* end() const { return y_.data(); }
    double fifth(int variable) const { return fifth_[static_cast<std::size_t>(variable)]; }
    double third(int variable) const { return third_[static_cast<std::size_t>(variable)]; }

    /// After attempt(): the polynomial through the step, and how far it misses the equations at one place.
    bool interpolate(const Start& from, double h) { return run_(*this, Part::interpolant, from, h); }
    /// Rows of order + 1.
    std::vector<double>& coefficients() { return coefficients_; }
    double defect(int variable) const { return defect_[static_cast<std::size_t>(variable)]; }

    /// After attempt(): state, what rounding leaves out of it, and slope at its end.
    void finish(const Start& from, double h, double* x, double* low, double* slope) {
        next_ = {x, low, slope};
        run_(*this, Part::finish, from, h);
    }

    /// The state at the end of a step of length h alone, in end(); false if a slope on the way is not finite.
    bool go(const Start& from, double h) { return run_(*this, Part::state, from, h); }

    /// Evaluations since it was asked last.
    std::int64_t evaluations() { return std::exchange(evaluations_, 0); }

private:
    enum class Part : std::uint8_t { step, interpolant, finish, state };
    using Run = bool (*)(Dop853Step&, Part, const Start&, double h);
    static Run widest();
    static bool plain(Dop853Step& step, Part part, const Start& from, double h);
    static bool wide(Dop853Step& step, Part part, const Start& from, double h);
    template <class Lanes>
    RBDYN_INLINE_LANES bool run(Part part, const Start& from, double h);

    /// Where the weights of a stage begin, that of stage 0 left out.
    static constexpr int first_of(int s) {
        int first = 1;
        while (first < s - 1 && dop853::a[s][first] == 0.0) ++first;
        return first;
    }
    /// sum_j w_j k_j with the weights of a row, j = lo .. hi - 1, in pairs of pairs: the same sum everywhere, and a
    /// short way through it.
    template <int row, int lo, int hi, class Lanes>
    RBDYN_INLINE_LANES void weighted(std::ptrdiff_t i, Lanes& sum) const;
    /// h^-1 times the change up to stage s.
    template <int s, class Lanes>
    RBDYN_INLINE_LANES void advance(const double* slope, std::ptrdiff_t i, Lanes& sum) const;
    /// The state there.
    template <int s, class Lanes>
    RBDYN_INLINE_LANES void state(const Start& from, double h);
    /// The slope there less that at the start; false if it is not finite, and that is looked at here.
    template <int s, class Lanes>
    RBDYN_INLINE_LANES bool stage(const Start& from, double h);
    template <class Lanes, int... s>
    RBDYN_INLINE_LANES bool stages(std::integer_sequence<int, s...>, const Start& from, double h);
    /// The slope at (t, y).
    bool evaluate(Instant t, double* slope);
    template <class Lanes>
    RBDYN_INLINE_LANES void estimate();
    template <class Lanes>
    RBDYN_INLINE_LANES void polynomial(const Start& from, double h);
    template <class Lanes>
    RBDYN_INLINE_LANES void close(const Start& from, double h);
    template <class Lanes>
    RBDYN_INLINE_LANES static bool is_finite(const double* a, std::ptrdiff_t count);

    double* difference(int s) { return differences_.data() + s * stride_; }
    const double* difference(int s) const { return differences_.data() + s * stride_; }

    Evaluator<double>* equations_ = nullptr;
    // what is called back is not to be asked about what is no number; of all else it is enough to look at the whole
    // step
    bool asks_each_ = false;
    int n_ = 0;                  // variables
    std::ptrdiff_t stride_ = 0;  // the same, padded
    Run run_ = widest();
    std::int64_t evaluations_ = 0;
    std::vector<double> y_, differences_;  // of the stage; slopes of the stages less that at the start
    std::vector<double> fifth_, third_, defect_, coefficients_;
    struct {
        double *x, *low, *slope;
    } next_{};
};

}  // namespace rbdyn::inline RBDYN_FORM
