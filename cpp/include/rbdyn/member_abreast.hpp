// A member of many whose integrations are made side by side with those of others (event/abreast.hpp), before its
// solution asks for them: the first one, and the one that it is held against. All else is done as for one alone, by the
// same functions; integrations that are not foreseen, too.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/abreast.hpp"
#include "rbdyn/expression/parameter.hpp"
#include "rbdyn/options.hpp"
#include "rbdyn/passes.hpp"
#include "rbdyn/plan/kept_plan.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/simulate.hpp"

namespace rbdyn::inline RBDYN_FORM::simulating {

class MemberAbreast {
public:
    /// Plans a scene, and begins what it is integrated with first, if that is a Taylor series. `numbers`: of its own;
    /// they outlive it. Throws what attempt() throws.
    MemberAbreast(const Scene& scene, const SimulateOptions& options, const BoundParameters::Values& numbers);

    /// What waits for its turn; null where nothing is to be made any more.
    RunAbreast* run() const { return run_.get(); }
    /// Once that is over: goes on to what is to be made next.
    void go_on();
    /// What attempt() makes of the scene; once, at the end.
    Attempt attempt();

private:
    /// Whether its first integration is made here.
    bool is_foreseen();
    void begin(Pass pass);

    SimulateOptions options_;
    const BoundParameters::Values& numbers_;
    PlannedScene planned_;
    double planning_ = 0.0;  // s
    std::string engine_;
    bool is_judge_ = false;  // by the same engine
    bool is_first_ = true;
    Pass pass_;
    std::vector<double> x_;
    Ahead ahead_;
    std::unique_ptr<RunAbreast> run_;
};

}  // namespace rbdyn::inline RBDYN_FORM::simulating
