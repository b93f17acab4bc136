// Definitions of rbdyn/event/abreast.hpp.
#pragma once

#include "rbdyn/event/abreast.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/event/driver.hpp"
#include "rbdyn/expression/parameter.hpp"
#include "rbdyn/expression/series_abreast.hpp"
#include "rbdyn/series/abreast.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Whether eight doubles are computed at once, and not four twice, as processors by AMD do up to Zen 4 at least.
inline bool has_registers_of_eight() {
#if defined(RBDYN_HAS_LANES) && defined(__x86_64__)
    return __builtin_cpu_is("intel") != 0;
#else
    return false;
#endif
}

RBDYN_INLINE AbreastShape::AbreastShape(const Program& program, int order) {
    using Processor = SeriesAbreast::Processor;
    few = std::make_unique<SeriesAbreast>(program, order, std::min(SeriesAbreast::widest(), Processor::four));
    if (SeriesAbreast::widest() != Processor::eight) return;
    many = std::make_unique<SeriesAbreast>(program, order, Processor::eight);
    // four that are kept near the processor are quicker than eight that are not where eight are done in two halves
    constexpr std::size_t near = 32 * 1024;
    if (!has_registers_of_eight() && few->bytes() <= near && many->bytes() > near) many.reset();
}

RBDYN_INLINE RunAbreast::RunAbreast(std::unique_ptr<TaylorEngine> engine, std::unique_ptr<Driver> driver, double until,
                                    const BoundParameters::Values& numbers)
    : engine_(std::move(engine)), driver_(std::move(driver)), until_(until), numbers_(numbers) {}

template <class Part>
void RunAbreast::go(const Part& part) {
    try {
        const BoundParameters own(numbers_);
        for (bool wants_step = part(); wants_step;) {
            const std::optional<StepStatus> made = engine_->begin_step(until_);
            if (!made) return;
            wants_step = driver_->go_on_after(record, *made, until_);
        }
    } catch (...) {
        is_broken_ = true;
    }
    is_over_ = true;
}

RBDYN_INLINE void RunAbreast::begin(double start, std::vector<double> x) {
    const auto before = std::chrono::steady_clock::now();
    go([&] { return driver_->set_out(record, start, std::move(x), until_); });
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
}

RBDYN_INLINE void RunAbreast::go_on() {
    std::optional<StepStatus> made;
    try {
        made = engine_->end_step();
    } catch (...) {
        is_broken_ = is_over_ = true;
    }
    // a step whose series are to be expanded anew waits for them
    if (made) go([&] { return driver_->go_on_after(record, *made, until_); });
}

RBDYN_INLINE std::size_t Abreast::room() {
    switch (SeriesAbreast::widest()) {
        case SeriesAbreast::Processor::any: return 0;
        case SeriesAbreast::Processor::four: return 8;
        case SeriesAbreast::Processor::eight: return 16;
    }
    return 0;
}

RBDYN_INLINE const AbreastShape* Abreast::shape_of(const TaylorEngine& engine) {
    const Program& program = engine.program();
    if (!SeriesAbreast::takes(program)) return nullptr;
    // order after order all of what is larger than the second cache comes from beyond it, which takes longer than each
    // by itself
    constexpr std::size_t large = 1U << 20, lanes = 8;
    if (sizeof(double) * lanes * static_cast<std::size_t>(program.slots()) *
            static_cast<std::size_t>(engine.order() + 1) >
        large)
        return nullptr;
    for (const auto& known : shapes_)
        if (known->few->fits(program, engine.order())) return known.get();
    return shapes_.emplace_back(std::make_unique<AbreastShape>(program, engine.order())).get();
}

RBDYN_INLINE void Abreast::choose(const std::vector<RunAbreast*>& runs) {
    const auto shape_of_run = [&](RunAbreast& run) {
        if (run.program_ != &run.engine_->program()) {
            run.program_ = &run.engine_->program();
            run.shape_ = shape_of(*run.engine_);
        }
        return run.shape_;
    };
    const AbreastShape* chosen = nullptr;
    std::ptrdiff_t most = 0;
    for (RunAbreast* run : runs) {
        if (run->is_over()) continue;
        const AbreastShape* shape = shape_of_run(*run);
        if (most > 0 && shape == chosen) continue;
        const auto count = std::count_if(runs.begin(), runs.end(), [&](RunAbreast* other) {
            return !other->is_over() && shape_of_run(*other) == shape;
        });
        if (count > most) {
            most = count;
            chosen = shape;
        }
    }
    const std::size_t width =
        chosen == nullptr ? 1 : static_cast<std::size_t>((chosen->many ? chosen->many : chosen->few)->width());
    chosen_.clear();
    for (RunAbreast* run : runs)
        if (!run->is_over() && run->shape_ == chosen && chosen_.size() < width) chosen_.push_back(run);
}

RBDYN_INLINE void Abreast::turn(const std::vector<RunAbreast*>& runs) {
    const auto before = std::chrono::steady_clock::now();
    choose(runs);
    if (chosen_.empty()) return;
    // of two, one after the other is as quick
    constexpr std::size_t few = 2;
    if (chosen_.size() <= few) {
        for (RunAbreast* run : chosen_) run->engine_->expand();
    } else {
        const AbreastShape& shape = *chosen_.front()->shape_;
        const bool is_few = !shape.many || chosen_.size() <= static_cast<std::size_t>(shape.few->width());
        SeriesAbreast& series = is_few ? *shape.few : *shape.many;
        motions_.clear();
        bool whole = false;
        for (const RunAbreast* run : chosen_) {
            motions_.push_back(run->engine_->motion());
            whole = whole || run->engine_->has_guards();
        }
        series.expand(motions_, whole);
        engines_.clear();
        for (RunAbreast* run : chosen_) engines_.push_back(run->engine_.get());
        TaylorEngine::take(series, engines_);
    }
    for (RunAbreast* run : chosen_) run->go_on();
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    for (RunAbreast* run : chosen_) run->seconds += took / static_cast<double>(chosen_.size());
}

}  // namespace rbdyn::inline RBDYN_FORM
