// Definitions of rbdyn/plan/plan.hpp.
#pragma once

#include "rbdyn/plan/plan.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/expression/callback.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/plan/kept_plan.hpp"
#include "rbdyn/scene/scene.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::int64_t Plan::python_calls() const {
    std::int64_t sum = 0;
    for (const auto& c : callbacks)
        if (c->is_python) sum += c->calls.load(std::memory_order_relaxed);
    return sum;
}

RBDYN_INLINE bool Plan::is_closed() const {
    if (parts.empty()) return closed != nullptr;
    return std::all_of(parts.begin(), parts.end(), [](const Plan& part) { return part.is_closed(); });
}

RBDYN_INLINE std::pair<int, int> Plan::variables() const {
    if (told) return told->variables;
    std::pair<int, int> sum{0, 0};
    for (const Plan& part : parts) {
        const auto [simulated, all] = part.variables();
        sum.first += simulated;
        sum.second += all;
    }
    return model ? std::pair(model->map().size(), model->map().variables()) : sum;
}

RBDYN_INLINE int Plan::freedom() const {
    if (told) return told->freedom;
    int sum = 0;
    for (const Plan& part : parts) sum += part.freedom();
    return model ? model->freedom() : sum;
}

RBDYN_INLINE Size Plan::size() const {
    if (told) return told->size;
    Size sum;
    for (const Plan& part : parts) sum += part.size();
    if (!model) return sum;
    std::vector<double> x = model->start(model->origin());
    return Size(model->begin(model->origin(), x));
}

RBDYN_INLINE bool Plan::has(const std::string& effect) const {
    return std::find(effects.begin(), effects.end(), effect) != effects.end();
}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Plan make_plan(const Scene& scene) { return planned(scene, scene.origin()).plan; }

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const Plan& plan) {
    const auto list = [&](const char* head, const std::vector<std::string>& lines, const char* none) {
        out << head;
        if (lines.empty()) out << none << '\n';
        for (std::size_t i = 0; i < lines.size(); ++i) out << (i == 0 ? "" : "              ") << lines[i] << '\n';
    };
    std::string effects;
    for (const std::string& e : plan.effects) effects += (effects.empty() ? "" : ", ") + e;
    out << "Plan\n";
    list("  coordinates ", plan.coordinates, "none");
    const auto [simulated, variables] = plan.variables();
    out << "  state       " << simulated << " of " << variables << " variables are simulated\n";
    out << "  effects     " << (effects.empty() ? "none" : effects) << '\n';
    list("  guards      ", plan.guards, "none");
    if (!plan.not_unique.empty()) list("  not unique  ", plan.not_unique, "");
    out << "  size        " << plan.size() << '\n';
    if (!plan.functions.empty()) list("  functions   ", plan.functions, "none");
    list("  conserved   ", plan.integrals, "nothing");
    out << "  engine      " << plan.engine << ": " << plan.reason << '\n';
    out << "  left out    ";
    if (plan.omissions.empty()) out << "nothing\n";
    for (std::size_t i = 0; i < plan.omissions.size(); ++i)
        out << (i == 0 ? "" : "              ") << plan.omissions[i].what << ": " << plan.omissions[i].why << '\n';
    return out;
}

}  // namespace rbdyn::inline RBDYN_FORM
