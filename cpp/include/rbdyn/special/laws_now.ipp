// Definitions of rbdyn/special/laws_now.hpp.
#pragma once

#include "rbdyn/special/laws_now.hpp"

#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/acting.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/model/system_report.hpp"
#include "rbdyn/scene/couplings.hpp"
#include "rbdyn/scene/watch.hpp"
#include "rbdyn/special/single_law.hpp"
#include "rbdyn/special/single_laws.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE LawsNow::LawsNow(const SingleLaws& given, std::span<const signed char> does, double time,
                              std::span<const double> state, const Acting* acts)
    : laws(given),
      slip(does),
      t(time),
      x(state),
      acting(acts),
      states(given.states(time, state, does)),
      couplings(given, time, states) {}

RBDYN_INLINE Vector3 LawsNow::force_on(int body, int coupling) const {
    const bool is_first = laws.coupling(coupling).a.body == body;
    return is_first ? coupling_force(coupling) : Vector3(-coupling_force(coupling));
}

RBDYN_INLINE Vector3 LawsNow::coupling_force(int coupling) const {
    const bool is_present = laws.coupling(coupling).present();
    if (!is_present) return Vector3::Zero();
    return acting != nullptr ? acting->coupling_force(coupling) : couplings[coupling];
}

RBDYN_INLINE double LawsNow::rate_of(int variable) const {
    const int place = laws.map().place(variable);
    return place >= 0 ? acting->rate(place) : 0.0;
}

RBDYN_INLINE double LawsNow::observed(const Observable& o) const {
    switch (o.quantity) {
        case Quantity::time: return t;
        case Quantity::length: {
            const PairState<double> ends = laws.ends<double>(laws.coupling(o.subject), t, states);
            return (ends.ra - ends.rb).norm();
        }
        case Quantity::coupling_force: return (laws.view().axes * coupling_force(o.subject))[o.component];
        default: return laws.body(o.subject).observed(*this, o);
    }
}

RBDYN_INLINE std::string LawsNow::coupling_not_finite(const std::vector<int>& which) const {
    for (const int k : which)
        if (!is_finite(coupling_force(k))) return laws.title(k) + ", which is not finite";
    return {};
}

RBDYN_INLINE BodyReport LawsNow::body(int index, Asked asked) const {
    const SingleLaw& law = laws.body(index);
    const SingleState<double>& p = state(index);
    BodyReport result;
    result.mass = law.mass;
    result.position = result.origin = laws.view().origin + laws.view().axes * p.r;
    result.velocity = laws.view().axes * p.v;
    law.report(*this, asked, result);
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
