// Definitions of rbdyn/event/search.hpp: gaps of contacts that bounce by turns, lower than the rounding of doubles.
//
// A gap is a difference of places: in doubles it is rounding where it is 1e-16 of them. What a contact that flies on
// has left of it when another one strikes is known by the digits of the state beyond doubles
// (mechanics/tree_bounces.ipp).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/event/search.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/model/at_zero.hpp"
#include "rbdyn/model/leading_sign.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE bool EventSearch::is_gap(const Mode& mode, const Guard& guard, std::size_t g) const {
    return guard.contact >= 0 && guard.kind == EventKind::land && guard.output >= 0 && !(handled(g) && is_fresh_) &&
           model_.follows_bounces(mode);
}

RBDYN_INLINE bool EventSearch::begins_touching(const Mode& mode, const Guard& guard, bool fresh) const {
    return fresh && guard.contact >= 0 && guard.kind == EventKind::land && !mode.memory.empty() &&
           mode.memory[0] != engine_.piece().start.hi;
}

RBDYN_INLINE int EventSearch::zeros_of_gap(const Mode& mode, const Guard& guard) {
    // it has touched so far, so its rate is zero, and where its force has come to zero its acceleration is: where that
    // is not known for another reason, as far as its terms tell
    constexpr double doubt = 0x1p-40;
    const bool has_ended = std::find(ended_.begin(), ended_.end(), guard.contact) != ended_.end();
    return leading_term(mode, engine_.piece().start.hi, state_of_piece(0.0), guard.output, has_ended ? 3 : 2,
                        has_ended ? 0.0 : doubt)
        .order;
}

RBDYN_INLINE bool EventSearch::begins_level(const Mode& mode, const Guard& guard, const series::Coefficients& q) {
    double later = 0.0;
    for (int k = 3; k <= degree_; ++k) later = std::max(later, std::abs(q[static_cast<std::size_t>(k)]));
    return guard.output >= 0 && std::abs(q[0]) + std::abs(q[1]) + std::abs(q[2]) <= 0x1p-10 * later &&
           begins_at_zero(mode, guard, 8.0 * epsilon) &&
           leading_term(mode, engine_.piece().start.hi, state_of_piece(0.0), guard.output, 1).order > 2;
}

RBDYN_INLINE double EventSearch::fine_value(const Mode& mode, const Guard& guard, double tau) {
    if (fine_for_ != mode.equations) {
        fine_ = std::make_unique<Evaluator<DoubleDouble>>(mode.equations->program);
        fine_for_ = mode.equations;
    }
    const Piece& piece = engine_.piece();
    std::vector<double> x(static_cast<std::size_t>(piece.variables)), rest(x.size());
    engine_.state(tau, x);
    engine_.rest(tau, x, rest);
    std::vector<DoubleDouble> state;
    for (std::size_t i = 0; i < x.size(); ++i) state.push_back(DoubleDouble(exact_sum(x[i], rest[i])));
    fine_->set_parameters(std::vector<DoubleDouble>(mode.parameters.begin(), mode.parameters.end()));
    (*fine_)(DoubleDouble(piece.at(tau)), state);
    return static_cast<double>(fine_->output(guard.output));
}

RBDYN_INLINE std::optional<double> EventSearch::low_gap(const Mode& mode, const Guard& guard, std::size_t g,
                                                        const series::Coefficients& q) {
    // far beside what it may become on the piece it is not low, or does not matter; but what has been struck may come
    // back on a later piece, which begins where rounding is much of it
    constexpr double told = 0x1p-26;
    const bool is_lowest = std::abs(q[0]) <= 0x1p-10 * (std::abs(q[1]) + std::abs(q[2]));
    if (degree_ < 2 || !(is_lowest || (handled(g) && !is_fresh_))) return std::nullopt;
    const double size = size_of_terms(mode, engine_.piece().start.hi, state_of_piece(0.0), guard.output);
    if (std::abs(q[0]) > (is_lowest ? low_gaps : epsilon / told) * size) return std::nullopt;
    const double value = fine_value(mode, guard, 0.0);
    // what is open is not inside: it is at its surface, but for the rounding of these digits or of the place it was
    // found
    return value <= 0x1p-96 * size ? 0.0 : value;
}

RBDYN_INLINE bool EventSearch::is_passed_barely(const Mode& mode, const Guard& guard, double cut, double slope) {
    if (mode.equations->program.has_calls()) return false;
    const Piece& piece = engine_.piece();
    const double late = value_rounding(mode, guard, cut / piece.length) * piece.unit;
    return late > 16.0 * epsilon * std::abs(piece.at(cut).hi) * std::abs(slope);
}

RBDYN_INLINE double EventSearch::polished_low(const Mode& mode, const Guard& guard, double cut, double slope) {
    double best = std::numeric_limits<double>::infinity(), place = cut;
    const double start = cut;
    // or as far as the rounding of doubles may have moved it, which may be a part of the whole way
    const auto is_near = [&](double way) {
        if (way < 1e-3 * start) return true;
        const double off = 4.0 * value_rounding(mode, guard, start / engine_.piece().length) / std::abs(slope);
        return way < std::min(off, 0.5 * start);
    };
    for (int iteration = 0; iteration < 4; ++iteration) {
        const double g = fine_value(mode, guard, place);
        if (!(std::abs(g) < best)) break;
        best = std::abs(g);
        cut = place;
        place = cut - g / slope;
        if (!is_near(std::abs(place - cut)) || place == cut || place <= 0.0 || place > engine_.piece().length) break;
    }
    return cut;
}

}  // namespace rbdyn::inline RBDYN_FORM
