// Definitions of rbdyn/mechanics/tree_model.hpp and tree_writer.hpp: driven joints.
//
// A driven joint that jumps or has a corner ends a run by name, for that takes an impulse that nothing gives.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/rounding_sizes.hpp"
#include "rbdyn/mechanics/driven.hpp"
#include "rbdyn/mechanics/tree_model.hpp"
#include "rbdyn/mechanics/tree_writer.hpp"
#include "rbdyn/model/equations_writer.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE void TreeModel::require_finite_drives(double t) const {
    for (const mechanics::Node& n : tree_->nodes())
        if (const mechanics::DrivenLaw* law = n.joint.as<mechanics::DrivenLaw>())
            for (const double value : {law->way(t), law->rate(t), law->rate.rate(t)})
                if (!std::isfinite(value))
                    throw InvalidInput(n.name + ": the motion of its joint, or a rate of it, is " + text(value) +
                                       " at t = " + text(t) +
                                       " s; a motion is a finite function of time with finite derivatives, from where "
                                       "the scene starts");
    for (const mechanics::Node& n : tree_->nodes())
        if (const mechanics::RailLaw* rail = mechanics::moved(n))
            if (const auto value = mechanics::not_finite(*rail, t))
                throw InvalidInput(n.name + ": the motion of its rail, or a rate of it, is " + text(*value) +
                                   " at t = " + text(t) +
                                   " s; a motion is a finite function of time with finite derivatives, from where "
                                   "the scene starts");
}

RBDYN_INLINE std::string TreeModel::jump_of_drives(const Mode& before, const Mode& after, double t,
                                                   std::span<const double> x) const {
    if (before.equations->drives < 0 || after.equations->drives < 0) return {};
    RoundingSizes was(before.equations->program), is(after.equations->program);
    was.set_parameters(before.parameters);
    is.set_parameters(after.parameters);
    was(t, x);
    is(t, x);
    int place = 0;
    double from = 0.0, to = 0.0;
    const auto next_jumps = [&] {
        const int a = before.equations->drives + place, b = after.equations->drives + place;
        ++place;
        from = was.output(a);
        to = is.output(b);
        const double rounding = 16.0 * epsilon * (was.size(a) + is.size(b));
        // what differs by the rounding of numbers written with few digits is the same
        return std::abs(to - from) > std::max(rounding, 1e-9 * std::max(std::abs(from), std::abs(to)));
    };
    for (const mechanics::Node& n : tree_->nodes()) {
        const mechanics::DrivenLaw* law = mechanics::driven(n);
        if (law == nullptr) continue;
        for (const bool rates : {false, true}) {
            if (!next_jumps()) continue;
            const std::string unit = std::string(law->turns ? " rad" : " m") + (rates ? "/s" : "");
            return std::string("the ") + (rates ? "rate" : "coordinate") + " of the driven joint of " + n.name +
                   " jumps from " + text(from) + " to " + text(to) + unit + ", which takes an impulse" +
                   (rates ? "" : " that is not finite") + "; a motion has a rate that is continuous";
        }
    }
    for (const mechanics::Node& n : tree_->nodes()) {
        if (mechanics::moved(n) == nullptr) continue;
        for (int k = 0; k < 24; ++k) {
            if (!next_jumps()) continue;
            return std::string("the ") + (k < 12 ? "place" : "velocity") + " of the rail of " + n.name +
                   " jumps, which takes an impulse" + (k < 12 ? " that is not finite" : "") +
                   "; a motion has a rate that is continuous";
        }
    }
    return {};
}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE void TreeWriter::guard_drives(EquationsWriter& write) {
    const recording::WideFolding all_digits;
    std::vector<S> outputs;
    for (const Node& n : tree_.nodes()) {
        const DrivenLaw* law = driven(n);
        if (law == nullptr) continue;
        const S way = law->way(r_.time()), rate = law->rate(r_.time());
        // never zero, but perhaps no number; and what it distinguishes is guarded with it
        if (may_break(law->way.function()))
            write.guard({.kind = EventKind::singular, .name = "the motion of the joint of " + n.name},
                        way * way + rate * rate + 1.0);
        outputs.push_back(way);
        outputs.push_back(rate);
    }
    for (const Node& n : tree_.nodes()) {
        const RailLaw* rail = moved(n);
        if (rail == nullptr) continue;
        const auto way = numbers_of<S>(rail->motion.at<S>(r_.time())),
                   rate = numbers_of<S>(rail->motion.rate<S>(r_.time()));
        S size(1.0);
        for (const auto* part : {&way, &rate})
            for (const S& one : *part) {
                size += one * one;
                outputs.push_back(one);
            }
        if (may_break(rail->motion.function()))
            write.guard({.kind = EventKind::singular, .name = "the motion of the rail of " + n.name}, size);
    }
    for (const S& value : outputs) {
        const int place = write.output(value);
        if (drives_ < 0) drives_ = place;
    }
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
