// Taylor series that give way to BDF where the motion is stiff, and take over again where it is not any more.
//
// Stiffness is looked for every so many steps, and only while so many more are ahead that a change may pay: a motion of
// some hundred steps never pays for it, others a few Jacobians. BDF is then tried for some steps of which nothing is
// handed out, and takes over if they are so much longer that their price is less: what is no case for it keeps every
// bit. All that is decided by counts and lengths, not by clocks: the same run has the same bits.
//
// docs/decisions/19-stiff-motion.md has what was measured.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/engine/stiffness.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/engine/work.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

class StiffTaylorEngine : public TaylorEngine {
public:
    using TaylorEngine::TaylorEngine;

    /// The least local tolerance at which BDF is tried: below it, of order 5, it loses more to rounding than it is
    /// asked for.
    static constexpr double least_tolerance = 1e-12;

    void start(const Equations& equations, std::span<const double> parameters, Instant t,
               std::span<const double> x) override;
    std::optional<StepStatus> begin_step(double limit) override;
    std::optional<StepStatus> end_step() override;

    void state(double tau, std::span<double> x) const override;
    void rest(double tau, std::span<const double> x, std::span<double> low) const override;
    void standing(std::span<double> x, std::span<double> low) const override;
    /// While BDF steps, the scales of the motion alone.
    std::vector<double> memory() const override;
    void recall(std::span<const double> memory) override;

    double natural_length() const override;
    bool refines() const override;
    const double* guard(int index) override;
    int guard_order() const override;
    void guard_sizes(int index, double* sizes) override;
    bool is_rough(int guard) const override;
    bool fits_guards() const override;

    std::vector<EngineChange> changes() const override { return changes_; }

private:
    /// Which steps there are.
    enum class Phase { series, changing, implicit };

    bool is_implicit() const { return phase_ == Phase::implicit; }
    /// Whether the step just made was kept short by stability, and BDF is worth a trial.
    bool is_stiff(double limit);
    void begin_series(int first_look);
    /// Whether BDF was quicker in this mode before.
    bool is_known() const;
    /// BDF goes on from here if it is quicker. Returns whether.
    bool give_way(double limit);
    void begin_implicit();
    /// A trial, of which nothing is handed out: whether BDF gets on so well from here.
    bool succeeds(double limit);
    /// How many times quicker than a series at the limit of its stability BDF is at a state with steps of a length [s].
    double quickness(Instant t, std::span<const double> x, double pace);
    /// The series go on from here; they are looked at after so many steps.
    void take_over(int first_look);
    StepStatus implicit_step(double limit);
    void begin_count();
    /// Now and then: whether BDF is quicker than the series, which else take over.
    bool is_worth_it();
    /// How many steps of the series take as long as one of BDF.
    double price();
    Stiffness& stiffness_of(const Equations& equations);
    /// What BDF has done since this was asked last.
    void take_work();

    Phase phase_ = Phase::series;
    const Equations* mode_ = nullptr;
    std::unique_ptr<Engine> implicit_;
    std::vector<std::pair<const Equations*, std::unique_ptr<Stiffness>>> known_;
    std::vector<const Equations*> stiff_;  // those in which BDF was quicker
    std::vector<EngineChange> changes_;
    Work taken_;                   // of BDF, which work_ has
    int steps_ = 0, looks_ = 0;    // of the series, since they began
    int looks_at_ = 0;             // steps of theirs before the next look
    int trial_ = 0;                // steps of BDF in a trial
    double reach_ = 0.0;           // h |lambda| of the series at the limit of their stability
    std::int64_t counted_ = 0;     // steps of BDF
    Instant counted_from_;         // where it was then
    std::vector<double> reached_;  // its state
    bool has_stepped_ = false;     // since it began in this mode
    bool goes_on_ = false;         // it begins a mode after another of its own
};

}  // namespace rbdyn::inline RBDYN_FORM
