// Definitions of rbdyn/system/system_plan.hpp.
#pragma once

#include "rbdyn/system/system_plan.hpp"

#include <ostream>
#include <string>
#include <vector>

#include "rbdyn/event/event.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/system/system_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE SystemPlan make_plan(const System& system) {
    SystemPlan plan;
    for (int i = 0; i < system.variables(); ++i) plan.variables.push_back(system.name(i));
    const auto tell = [&](const std::string& what, const OwnFunction& f) {
        plan.functions.push_back(what + (f.callback() ? " called back: " + f.callback()->reason : " traced, native"));
    };
    tell("f", system.function());
    for (const System::Watch& w : system.watches()) tell("watch \"" + w.name + "\"", w.function);
    plan.engine = plan.judge = system.calls_back() ? "dop853" : "taylor";
    plan.reason = system.calls_back() ? "f is called back, and what is called back has no Taylor series"
                                      : "f is recorded, so that it has Taylor series";
    const SystemModel model(system.frozen());
    std::vector<double> x = system.start();
    const Mode mode = model.begin(0.0, x);
    plan.size = Size(mode);
    for (const Guard& guard : mode.equations->guards)
        plan.guards.push_back(std::string(name_of(guard.kind)) + (guard.name.empty() ? "" : ": " + guard.name));
    return plan;
}

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const SystemPlan& plan) {
    const auto list = [&](const char* head, const std::vector<std::string>& lines) {
        out << head;
        if (lines.empty()) out << "none\n";
        for (std::size_t i = 0; i < lines.size(); ++i) out << (i == 0 ? "" : "              ") << lines[i] << '\n';
    };
    std::string names;
    for (const std::string& name : plan.variables) names += (names.empty() ? "" : ", ") + name;
    out << "Plan\n  variables   " << names << '\n';
    list("  guards      ", plan.guards);
    out << "  size        " << plan.size << '\n';
    list("  functions   ", plan.functions);
    return out << "  engine      " << plan.engine << ": " << plan.reason << '\n';
}

}  // namespace rbdyn::inline RBDYN_FORM
