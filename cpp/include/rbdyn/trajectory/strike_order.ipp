// Definitions of rbdyn/trajectory/strike_order.hpp.
#pragma once

#include "rbdyn/trajectory/strike_order.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "rbdyn/event/event.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::optional<double> unknown_order(const HybridModel& model, const Record& run,
                                                 const std::vector<StrikeOfTwo>& strikes, double start, double wanted) {
    // what two runs round alike is more than what they differ by; a flight beside which the time between is nothing
    constexpr double alike = 20.0, flight = 1e3;
    const auto last_before = [&](std::size_t i, int contact, int other, double time) {
        while (i-- > 0) {
            const Event& e = *strikes[i].here;
            if ((e.contact == contact || e.contact == other) && e.time < time) return e.time;
        }
        return start;
    };
    const auto feel_each_other = [&](const Event& a, const Event& b) {
        const std::size_t i = run.find(std::min(a.time, b.time), Side::before);
        const Piece piece = run.piece(i);
        std::vector<double> x(static_cast<std::size_t>(run.variables));
        piece.state(Record::tau(piece, std::min(a.time, b.time)), x);
        return model.feel_each_other(a.contact, b.contact, run.mode(i), a.time, x);
    };
    for (std::size_t i = 0; i < strikes.size(); ++i)
        for (std::size_t j = i + 1; j < strikes.size(); ++j) {
            const Event &a = *strikes[i].here, &b = *strikes[j].here;
            const double here = b.instant - a.instant, there = strikes[j].there->instant - strikes[i].there->instant,
                         apart = std::max(std::abs(here), std::abs(there));
            if (apart > 2.0 * alike * wanted * (a.time - start)) break;
            const bool is_known =
                here * there > 0.0 && std::min(std::abs(here), std::abs(there)) >= alike * std::abs(here - there);
            if (a.contact == b.contact || apart == 0.0 || is_known) continue;
            const double time = std::min(a.time, b.time);
            if (time - last_before(i, a.contact, b.contact, time) >= flight * apart && feel_each_other(a, b))
                return time;
        }
    return std::nullopt;
}

}  // namespace rbdyn::inline RBDYN_FORM
