// Definitions of rbdyn/trajectory/narrow_hold.hpp.
#pragma once

#include "rbdyn/trajectory/narrow_hold.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::string NarrowHold::words() const {
    constexpr double rounding = std::numeric_limits<double>::epsilon();
    return name + " is passed from t = " + text(since) + " to " + text(until) + " s, by " + text(part) +
           " of what is held: rounding of the forces, " + text(rounding) + " of that, is " + text(rounding / part) +
           " of it, and what slips then is known no better; a load or a coefficient that leaves more, or a mu_dynamic "
           "below mu_static, is known well";
}

RBDYN_INLINE std::optional<NarrowHold> narrowest_hold(const Record& run) {
    constexpr double narrow = 1e-6;
    constexpr int places = 16;
    std::optional<NarrowHold> least;
    if (run.empty()) return least;
    std::vector<double> x(static_cast<std::size_t>(run.variables));
    for (std::size_t i = 0; i < run.events.size(); ++i) {
        const Event& slips = run.events[i];
        if (slips.kind != EventKind::slip || slips.time < run.piece(0).start.hi) continue;
        const auto stops =
            std::find_if(run.events.begin() + static_cast<std::ptrdiff_t>(i), run.events.end(), [&](const Event& e) {
                return e.kind == EventKind::stick && e.contact == slips.contact && e.subject == slips.subject;
            });
        const double until = stops != run.events.end() ? stops->time : run.end.hi;
        const Mode& held = run.mode(run.find(slips.time, Side::before));
        if (held.equations == nullptr || held.equations->program.has_calls() || !(until > slips.time)) continue;
        Evaluator<double> values(held.equations->program);
        values.set_parameters(held.parameters);
        for (const Guard& guard : held.equations->guards) {
            if (guard.kind != EventKind::slip || guard.output < 0 || guard.contact != slips.contact ||
                (guard.contact < 0 && guard.subject != slips.subject))
                continue;
            // the square of what is held, less that of its limit: a difference of twice the part
            double most = 0.0;
            for (int k = 1; k < places; ++k) {
                const double t = slips.time + (until - slips.time) * k / places;
                const Piece piece = run.piece(run.find(t, Side::after));
                piece.state(Record::tau(piece, t), x);
                values(t, x);
                most = std::max(most, -values.output(guard.output) / values.magnitude(guard.output));
            }
            if (most > 0.0 && most < std::min(narrow, least ? least->part : narrow))
                least = {guard.name, slips.time, until, most};
        }
    }
    return least;
}

}  // namespace rbdyn::inline RBDYN_FORM
