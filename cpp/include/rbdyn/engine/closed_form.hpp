// A closed form as an engine: exact states at the ends of its steps, Taylor series between them, on which events are
// found.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// A motion that has a closed form in each of its modes.
class FormsByMode : public ClosedForm {
public:
    /// That of a mode from the state x + low at a time on; none if it has none. The equations outlive its use.
    virtual std::shared_ptr<const ClosedForm> in_mode(const Equations& equations, std::span<const double> parameters,
                                                      Instant t, std::span<const double> x,
                                                      std::span<const double> low) const = 0;
};

/// Whether there is a form, and it is good for all of a motion.
inline bool is_one_form(const std::shared_ptr<const ClosedForm>& form) {
    return form != nullptr && dynamic_cast<const FormsByMode*>(form.get()) == nullptr;
}

class ClosedFormEngine : public TaylorEngine {
public:
    /// `start`: when the closed form begins; tolerance and order as of Taylor series.
    ClosedFormEngine(std::shared_ptr<const ClosedForm> form, Instant start, double tolerance, int order = 0);

    /// By the forms of the modes that it comes through, by series where one has none.
    ClosedFormEngine(std::shared_ptr<const FormsByMode> forms, double tolerance, int order);

    /// A form and when it begins.
    struct Begun {
        std::shared_ptr<const ClosedForm> form;
        Instant from;
    };
    /// Those that it came through, of modes.
    const std::vector<Begun>& forms_so_far() const { return so_far_; }

    std::string name() const override;

    void start(const Equations& equations, std::span<const double> parameters, Instant t,
               std::span<const double> x) override;

    StepStatus step(double limit) override;

    void state(double tau, std::span<double> x) const override;
    /// The closed form is asked again.
    void rest(double tau, std::span<const double> x, std::span<double> low) const override;
    bool refines() const override;

private:
    std::shared_ptr<const ClosedForm> form_;  // none: series alone
    Instant start_;
    std::shared_ptr<const FormsByMode> by_mode_;
    std::vector<Begun> so_far_;
    const Equations* mode_ = nullptr;  // whose form is to be found
};

}  // namespace rbdyn::inline RBDYN_FORM
