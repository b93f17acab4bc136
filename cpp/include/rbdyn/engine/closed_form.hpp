// A closed form as an engine: exact states at the ends of its steps, Taylor series between them, on which events are
// found.
#pragma once

#include <memory>

#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/engine/taylor.hpp"

namespace rbdyn {

class ClosedFormEngine : public TaylorEngine {
public:
    /// `start`: when the closed form begins; tolerance and order as of Taylor series.
    ClosedFormEngine(std::shared_ptr<const ClosedForm> form, Instant start, double tolerance, int order = 0)
        : TaylorEngine(tolerance, order), form_(std::move(form)), start_(start) {}

    std::string name() const override { return "closed form"; }

    StepStatus step(double limit) override {
        const StepStatus status = TaylorEngine::step(limit);
        if (status == StepStatus::ok) form_->state(exact_difference(t_, start_), replace_state());
        return status;
    }

    void state(double tau, std::span<double> x) const override {
        form_->state(exact_difference(piece_.at(tau), start_), x);
    }
    /// The closed form is asked again.
    void rest(double tau, std::span<const double> x, std::span<double> low) const override {
        Engine::rest(tau, x, low);
    }
    bool refines() const override { return true; }

private:
    std::shared_ptr<const ClosedForm> form_;
    Instant start_;
};

}  // namespace rbdyn
