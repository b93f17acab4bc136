// Scenes whose equations of motion are linear with constant coefficients: found in the recorded equations, whatever the
// scene is made of, and solved in closed form (closed_form/linear_system.hpp).
//
// Linear is a program whose rates are weighted sums of variables and constants, with nothing in its mode that changes
// the equations: no case distinction, no friction, no way off a rail. Ends of rails and watched functions that note or
// stop are none of it. What is a polynomial in time stays with Taylor series, one step of which is exact.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/closed_form/linear_block.hpp"
#include "rbdyn/closed_form/linear_system.hpp"
#include "rbdyn/closed_form/waves.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/door.hpp"
#include "rbdyn/special/special_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The motion of a linear scene.
class LinearMotion : public ClosedForm {
public:
    /// `forced`: what is solved, of one that is forced in time; else none.
    LinearMotion(std::optional<ForcedSystem> forced, LinearBlocks solution, std::vector<double> start,
                 std::vector<VariableGroup> groups);

    void state(Instant since, std::span<double> x) const override;

    /// Of the worst group of variables, relative to its scale until then: the extent of a place, the largest size of
    /// other things. What moves by rounding alone does not move.
    double error(double since, double wanted) const override;

    double pace() const override;

    /// Where a sum of its variables, each times a factor, is from the start on; unlimited where it is not known.
    LinearBlock::Range range(std::span<const double> factors) const;

    std::shared_ptr<const ClosedForm> begun(double time) const override;

    std::string name() const override;

private:
    std::optional<ForcedSystem> forced_;
    LinearBlocks solution_;
    std::size_t behind_ = 0;  // variables of what forces it
    std::vector<double> start_;
    std::vector<VariableGroup> groups_;
};

namespace planning {

/// What a slot of a program depends on.
enum class Dependence : char { other, linear, constant };

/// Which slots are weighted sums of variables and constants.
std::vector<Dependence> dependences(const Program& program);

/// How a slot depends on variables and on time: as a sum of variables with factors, and of a part without any.
struct Degree {
    int variables = 0;         // 0: not at all, 1: linearly, 2: otherwise
    bool part_varies = false;  // in time, the part without variables
    bool factors_vary = false;

    static Degree sum(const Degree& a, const Degree& b);
    static Degree product(const Degree& a, const Degree& b);
    static Degree of_any(const Degree& a) { return {a.variables > 0 ? 2 : 0, a.part_varies, false}; }
};

/// Why the rate in a slot is not linear with constant coefficients, in words that follow "the equations of ...".
[[gnu::cold]] std::string why_not_linear(const Program& program, int slot);

/// The rates of a scene as a program whose constants have 32 digits, numbers of the user's among them.
[[gnu::cold]] Program wide_rates(const SpecialModel& model, const std::vector<double>& start,
                                 const std::vector<signed char>& slip);

/// The motion of a scene by the modes of its equations.
[[gnu::cold]] FoundForm linear_motion(const Scene& scene, const SpecialModel& model);

}  // namespace planning

}  // namespace rbdyn::inline RBDYN_FORM
