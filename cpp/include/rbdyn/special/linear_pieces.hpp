// Scenes whose equations are linear between the zeros of what their modes guard, as those of springs with rest lengths
// on a line are: a closed form for each mode.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/engine/closed_form.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/special/linear_motion.hpp"
#include "rbdyn/special/special_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// As a closed form it is that of the mode in which motion begins.
class LinearPieces : public FormsByMode {
public:
    explicit LinearPieces(std::shared_ptr<const ClosedForm> first);

    std::shared_ptr<const ClosedForm> in_mode(const Equations& equations, std::span<const double> parameters, Instant t,
                                              std::span<const double> x, std::span<const double> low) const override;

    void state(Instant since, std::span<double> x) const override;
    double error(double since, double wanted) const override;
    double pace() const override;
    std::string name() const override;

private:
    std::shared_ptr<const ClosedForm> first_;
};

namespace planning {

/// The closed form of a mode of linear equations that do not depend on time, from the state x + low at a time on; none
/// if they are something else, or a polynomial in time, which series have exactly.
[[gnu::cold]] std::shared_ptr<const LinearMotion> linear_in_mode(const Equations& equations,
                                                                 std::span<const double> parameters, Instant t,
                                                                 std::span<const double> x,
                                                                 std::span<const double> low);

/// Whether a motion stays in the mode it begins in for ever: no guard's zero is within what it can reach.
[[gnu::cold]] bool keeps_its_mode(const LinearMotion& motion, const Mode& mode);

/// The motion of such a scene, of one form if it keeps its mode; none if the mode it begins in has no closed form.
[[gnu::cold]] std::shared_ptr<const ClosedForm> linear_pieces(const SpecialModel& model);

}  // namespace planning

}  // namespace rbdyn::inline RBDYN_FORM
