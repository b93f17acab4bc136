// Definitions of rbdyn/engine/cvode_factory.hpp: the one place that asks whether a build has SUNDIALS.
#pragma once

#include "rbdyn/engine/cvode_factory.hpp"

#include <memory>
#include <string>
#include <vector>

#ifdef RBDYN_WITH_SUNDIALS
#include "rbdyn/engine/cvode.hpp"
#endif

namespace rbdyn::inline RBDYN_FORM::cvode {

#ifdef RBDYN_WITH_SUNDIALS

RBDYN_INLINE std::vector<std::string> names() { return {"cvode-adams", "cvode-bdf"}; }

RBDYN_INLINE std::unique_ptr<Engine> make(const std::string& name, double tolerance, Program::Rounding rounding) {
    if (name == "cvode-adams") return std::make_unique<CvodeEngine>(CvodeEngine::Method::adams, tolerance, rounding);
    if (name == "cvode-bdf") return std::make_unique<CvodeEngine>(CvodeEngine::Method::bdf, tolerance, rounding);
    return nullptr;
}

#else

RBDYN_INLINE std::vector<std::string> names() { return {}; }

RBDYN_INLINE std::unique_ptr<Engine> make(const std::string& /*name*/, double /*tolerance*/,
                                          Program::Rounding /*rounding*/) {
    return nullptr;
}

#endif

}  // namespace rbdyn::inline RBDYN_FORM::cvode
