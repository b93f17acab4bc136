// One step of Dormand and Prince's method (dop853.hpp): its stages, its error estimates and its interpolant.
//
// Variables lie side by side, with zeros up to a multiple of four, and sums of slopes are computed two or four
// variables at a time: of each in one fixed order, so that the bits do not depend on how many (series/lanes.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/dop853_coefficients.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/series/lanes.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Doubles that begin where a line of the cache does, so that no lanes of them lie in two.
template <class T>
class InLines {
public:
    using value_type = T;
    InLines() = default;
    template <class Other>
    InLines(const InLines<Other>&) {}
    T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), line)); }
    void deallocate(T* start, std::size_t) { ::operator delete(start, line); }
    bool operator==(const InLines&) const = default;

private:
    static constexpr std::align_val_t line{64};
};

class Dop853Step {
public:
    using Doubles = std::vector<double, InLines<double>>;
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
    Doubles& coefficients() { return coefficients_; }
    double defect(int variable) const { return defect_[static_cast<std::size_t>(variable)]; }

    /// After attempt(): state, what rounding leaves out of it, and slope at its end.
    void finish(const Start& from, double h, double* x, double* low, double* slope) {
        next_ = {x, low, slope};
        run_(*this, Part::finish, from, h);
    }

    /// The state at the end of a step of length h alone, in end(); false if a slope on the way is not finite.
    bool go(const Start& from, double h) { return run_(*this, Part::state, from, h); }

    /// From now on as on a processor without lanes of four: the same bits.
    void go_without_lanes_of_four() { run_ = &plain; }

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
    /// What is read and written all along, for the compiler to keep: through the step itself it would be looked up
    /// again after every store.
    struct Arrays {
        const double *x, *low, *slope;
        double *k, *y;  // differences of slopes, a row a stage
        std::ptrdiff_t stride;
        double h;
    };
    Arrays arrays(const Start& from, double h) {
        return {from.x, from.low, from.slope, differences_.data(), y_.data(), stride_, h};
    }
    /// sum_j w_j k_j with the weights of a row, j = lo .. hi - 1, in pairs of pairs: the same sum everywhere, and a
    /// short way through it. `newest`: k of the last one.
    template <int row, int lo, int hi, class Lanes>
    RBDYN_INLINE_LANES static void weighted(const double* k, std::ptrdiff_t stride, const Lanes& newest, Lanes& sum);
    /// The state at stage s of variables from i on, for the newest of the slopes before.
    template <int s, class Lanes>
    RBDYN_INLINE_LANES static void state(const Arrays& a, std::ptrdiff_t i, const Lanes& newest);
    /// Differences at stage s, of which there is the slope in their place; then the state at the next one, if there is.
    template <int s, int next, class Lanes>
    RBDYN_INLINE_LANES void go_on(const Arrays& a);
    /// The slope at stage s, and what follows from it; false if it is not finite, and that is looked at here.
    template <int s, int next, class Lanes>
    RBDYN_INLINE_LANES bool stage(const Start& from, const Arrays& a);
    template <class Lanes, int... s>
    RBDYN_INLINE_LANES bool stages(std::integer_sequence<int, s...>, const Start& from, const Arrays& a);
    /// The slope at (t, y).
    bool evaluate(double t, double* slope);
    /// The time of a stage, as Instant has it.
    RBDYN_INLINE_LANES static double time(Instant t, double h);
    template <class Lanes>
    RBDYN_INLINE_LANES void estimate(const Arrays& a);
    template <class Lanes>
    RBDYN_INLINE_LANES bool interpolant(const Start& from, const Arrays& a);
    template <class Lanes>
    RBDYN_INLINE_LANES void polynomial(const Arrays& a);
    /// The polynomial and its derivative there, from coefficient k down.
    template <int k, class Lanes>
    RBDYN_INLINE_LANES static void horner(const Lanes* c, Lanes& value, Lanes& change);
    /// Rows of coefficients from lanes of variables.
    template <int lane, class Lanes>
    RBDYN_INLINE_LANES static void rows(const double* lanes, double* out);
    template <class Lanes>
    RBDYN_INLINE_LANES void close(const Arrays& a);
    template <class Lanes>
    RBDYN_INLINE_LANES static bool is_finite(const double* a, std::ptrdiff_t count);

    double* difference(int s) { return differences_.data() + s * stride_; }

    Evaluator<double>* equations_ = nullptr;
    // what is called back is not to be asked about what is no number; of all else it is enough to look at the whole
    // step
    bool asks_each_ = false;
    int n_ = 0;                  // variables
    std::ptrdiff_t stride_ = 0;  // the same, padded
    Run run_ = widest();
    std::int64_t evaluations_ = 0;
    Doubles y_, differences_;  // of the stage; slopes of the stages less that at the start
    Doubles fifth_, third_, defect_, coefficients_;
    struct {
        double *x, *low, *slope;
    } next_{};
};

}  // namespace rbdyn::inline RBDYN_FORM
