// Runs of several members side by side: each has a driver and an engine of its own and goes its own way, step by step;
// what is done together are the series of those that are about to expand the same program.
//
// So steps are of any length, events, modes and failures are a member's own, and its bits are those it has alone
// (expression/series_abreast.hpp). One that nobody has the program in common with is expanded by itself.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/event/driver.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/expression/parameter.hpp"
#include "rbdyn/expression/series_abreast.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What expands one program, for few and for many.
struct AbreastShape {
    AbreastShape(const Program& program, int order);
    std::unique_ptr<SeriesAbreast> few, many;  // no `many` where vectors are no wider
};

/// A run that is made in turns.
class RunAbreast {
public:
    /// `numbers`: of the member's own, bound whenever it goes on; they outlive it.
    RunAbreast(std::unique_ptr<TaylorEngine> engine, std::unique_ptr<Driver> driver, double until,
               const BoundParameters::Values& numbers);

    /// Begins it.
    void begin(double start, std::vector<double> x);
    bool is_over() const { return is_over_; }
    /// Whether an exception ended it: it is to be made alone, which says what it is.
    bool is_broken() const { return is_broken_; }

    Record record;
    double seconds = 0.0;  // of its turns

private:
    friend class Abreast;

    /// Goes on with the coefficients that its engine has now.
    void go_on();
    /// What returns whether it wants a step; then to where it waits for coefficients.
    template <class Part>
    void go(const Part& part);

    std::unique_ptr<TaylorEngine> engine_;
    std::unique_ptr<Driver> driver_;
    double until_;
    const BoundParameters::Values& numbers_;
    bool is_over_ = false, is_broken_ = false;
    const Program* program_ = nullptr;     // that its shape is known of
    const AbreastShape* shape_ = nullptr;  // none: it is expanded by itself
};

/// Gives runs their turns.
class Abreast {
public:
    /// How many runs keep it busy: twice as many as go abreast, for they may be in different modes; none where this
    /// processor has no vectors for them.
    static std::size_t room();

    /// Expands the series of some of the runs that are not over, those that have most in common, and lets them go on.
    void turn(const std::vector<RunAbreast*>& runs);

private:
    const AbreastShape* shape_of(const TaylorEngine& engine);
    /// Of the runs those with the shape that most have.
    void choose(const std::vector<RunAbreast*>& runs);

    std::vector<std::unique_ptr<AbreastShape>> shapes_;
    std::vector<RunAbreast*> chosen_;
    std::vector<SeriesAbreast::Motion> motions_;
    std::vector<TaylorEngine*> engines_;
};

}  // namespace rbdyn::inline RBDYN_FORM
