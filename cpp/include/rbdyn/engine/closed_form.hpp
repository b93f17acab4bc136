// A closed form as an engine: exact states at the ends of its steps, Taylor series between them, on which events are
// found.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/taylor.hpp"

namespace rbdyn::inline RBDYN_FORM {

class ClosedFormEngine : public TaylorEngine {
public:
    /// `start`: when the closed form begins; tolerance and order as of Taylor series.
    ClosedFormEngine(std::shared_ptr<const ClosedForm> form, Instant start, double tolerance, int order = 0);

    std::string name() const override;

    StepStatus step(double limit) override;

    void state(double tau, std::span<double> x) const override;
    /// The closed form is asked again.
    void rest(double tau, std::span<const double> x, std::span<double> low) const override;
    bool refines() const override;

private:
    std::shared_ptr<const ClosedForm> form_;
    Instant start_;
};

}  // namespace rbdyn::inline RBDYN_FORM
