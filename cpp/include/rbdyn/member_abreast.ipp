// Definitions of rbdyn/member_abreast.hpp.
#pragma once

#include "rbdyn/member_abreast.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/event/abreast.hpp"
#include "rbdyn/event/driver.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/expression/parameter.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/options.hpp"
#include "rbdyn/passes.hpp"
#include "rbdyn/plan/kept_plan.hpp"
#include "rbdyn/simulate.hpp"
#include "rbdyn/solve.hpp"

namespace rbdyn::inline RBDYN_FORM::simulating {

RBDYN_INLINE MemberAbreast::MemberAbreast(const Scene& scene, const SimulateOptions& options,
                                          const BoundParameters::Values& numbers)
    : options_(options), numbers_(numbers) {
    const BoundParameters own(numbers_);
    const auto began = std::chrono::steady_clock::now();
    validate(options_);
    planned_ = planned(scene, options_.start);
    planning_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    options_.warn = once(options_.warn);
    if (is_foreseen()) begin(first_pass(*planned_.plan.model, options_, engine_));
}

RBDYN_INLINE bool MemberAbreast::is_foreseen() {
    const Plan& plan = planned_.plan;
    // events of one that is handed out as it runs have their names there
    if (!plan.parts.empty() || options_.events.each) return false;
    try {
        engine_ = engine_for(plan, options_.engine);
        if (engine_ != "taylor") return false;
        require_squares(planned_.scene);
        x_ = plan.model->start(options_.start);
        is_judge_ = plan.integrator == engine_ && !begun(plan.closed, options_.start);
    } catch (const InvalidInput&) {
        // attempt() says it
        return false;
    }
    return true;
}

RBDYN_INLINE void MemberAbreast::begin(Pass pass) {
    pass_ = std::move(pass);
    // none that is refined is foreseen
    auto engine = std::unique_ptr<TaylorEngine>(
        static_cast<TaylorEngine*>(make_engine(engine_, pass_.tolerance, pass_.manner).release()));
    auto driver = make_driver(*planned_.plan.model, *engine, options_, {options_.start}, pass_.tolerance, pass_.keep,
                              pass_.manner);
    run_ = std::make_unique<RunAbreast>(std::move(engine), std::move(driver), options_.until, numbers_);
    run_->begin(options_.start, x_);
}

RBDYN_INLINE void MemberAbreast::go_on() {
    const std::unique_ptr<RunAbreast> made = std::move(run_);
    if (made->is_broken()) return;
    const Record& record = made->record;
    const bool has_ended =
        !record.thrown && (record.status == Status::reached_end || record.status == Status::stopped_by_event);
    std::optional<Pass> next;
    if (is_first_ && is_judge_ && !options_.rtol && has_ended)
        next = judging_pass(options_, engine_, is_judge_, pass_, record, false);
    is_first_ = false;
    ahead_.add(std::move(pass_), {std::move(made->record), made->seconds});
    if (next) begin(*std::move(next));
}

RBDYN_INLINE Attempt MemberAbreast::attempt() {
    const BoundParameters own(numbers_);
    return attempted(std::move(planned_), options_, planning_, nullptr, &ahead_);
}

}  // namespace rbdyn::inline RBDYN_FORM::simulating
