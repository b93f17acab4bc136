// Definitions of rbdyn/price.hpp.
#pragma once

#include "rbdyn/price.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <iomanip>
#include <limits>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "rbdyn/basics/error.hpp"

namespace rbdyn::inline RBDYN_FORM::pricing {

RBDYN_INLINE std::string about(double value) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.2g", value);
    return digits;
}

/// Throws InvalidInput where no row is as accurate.
[[noreturn]] RBDYN_INLINE void refuse_error(const Price& price, double error) {
    double least = std::numeric_limits<double>::infinity();
    for (const CostRow& row : price.rows)
        if (row.has_all_events) least = std::min(least, row.error);
    if (price.rows.empty()) throw InvalidInput("Price: the list has 0 rows; give cost() a larger budget");
    throw InvalidInput("Price: error is " + text(error) + "; the most accurate row of this list reaches " +
                       text(least) + (std::isfinite(least) ? "" : ", for none has all events"));
}

RBDYN_INLINE void require_error(double error) {
    require(error > 0.0, "Price", "error", error, "it is positive, relative to the scales of the motion");
}

/// The rows of an engine that have all events, from loose to tight, each with the largest error of it and the tighter
/// ones: a loose row may be lucky.
RBDYN_INLINE std::vector<CostRow> ladder_of(const Price& price, const std::string& engine) {
    std::vector<CostRow> rows;
    for (const CostRow& row : price.rows)
        if (row.engine == engine && row.has_all_events && std::isfinite(row.error)) rows.push_back(row);
    std::sort(rows.begin(), rows.end(), [](const CostRow& a, const CostRow& b) { return a.tolerance > b.tolerance; });
    for (std::size_t i = rows.size(); i-- > 1;) rows[i - 1].error = std::max(rows[i - 1].error, rows[i].error);
    return rows;
}

RBDYN_INLINE double between(double a, double b, double part) {
    return a > 0.0 && b > 0.0 ? std::exp((1.0 - part) * std::log(a) + part * std::log(b)) : part < 0.5 ? a : b;
}

RBDYN_INLINE std::string named(const CostRow& row) {
    return row.tolerance > 0.0 ? "tolerance " + about(row.tolerance) : "no tolerance";
}

/// A row itself.
RBDYN_INLINE Prediction as_measured(const CostRow& row) {
    return {row.engine, row.tolerance, row.seconds, row.total, "measured at " + named(row)};
}

/// What an error costs with one engine; none if it has no row as accurate.
RBDYN_INLINE std::optional<Prediction> predicted(const std::vector<CostRow>& ladder, double error) {
    const auto enough =
        std::find_if(ladder.begin(), ladder.end(), [&](const CostRow& row) { return row.error <= error; });
    if (enough == ladder.end()) return std::nullopt;
    Prediction p = as_measured(*enough);
    if (enough == ladder.begin() || enough->error == error) return p;
    const CostRow& loose = *(enough - 1);
    const double part =
        enough->error > 0.0 ? std::log(error / loose.error) / std::log(enough->error / loose.error) : 1.0;
    p.tolerance = between(loose.tolerance, enough->tolerance, part);
    p.seconds = between(loose.seconds, enough->seconds, part);
    p.total = between(loose.total, enough->total, part);
    p.basis = "interpolated between the rows at " + named(loose) + " and " + named(*enough);
    return p;
}

}  // namespace rbdyn::inline RBDYN_FORM::pricing

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const Prediction& p) {
    out << p.engine;
    if (p.tolerance > 0.0) out << " at tolerance " << pricing::about(p.tolerance);
    return out << ": " << pricing::about(p.seconds) << " s, " << p.basis;
}

RBDYN_INLINE const CostRow& Price::cheapest(double error) const {
    pricing::require_error(error);
    const CostRow* best = nullptr;
    for (const CostRow& row : rows)
        if (row.has_all_events && row.error <= error && (best == nullptr || row.seconds < best->seconds)) best = &row;
    if (best == nullptr) pricing::refuse_error(*this, error);
    return *best;
}

RBDYN_INLINE Prediction Price::predict(double error) const {
    pricing::require_error(error);
    std::optional<Prediction> best;
    std::vector<std::string> seen;
    for (const CostRow& row : rows) {
        if (std::find(seen.begin(), seen.end(), row.engine) != seen.end()) continue;
        seen.push_back(row.engine);
        const std::optional<Prediction> one = pricing::predicted(pricing::ladder_of(*this, row.engine), error);
        if (one && (!best || one->seconds < best->seconds)) best = one;
    }
    // between rows it is not to be had: what a row has reached it has, lucky or not
    return best ? *best : pricing::as_measured(cheapest(error));
}

RBDYN_INLINE std::vector<CostRow> Price::front() const {
    std::vector<CostRow> result;
    for (const CostRow& row : rows) {
        if (!row.has_all_events || !std::isfinite(row.error)) continue;
        const auto beats = [&](const CostRow& other) {
            return other.has_all_events && other.error <= row.error && other.seconds <= row.seconds &&
                   (other.error < row.error || other.seconds < row.seconds);
        };
        if (std::none_of(rows.begin(), rows.end(), beats)) result.push_back(row);
    }
    std::sort(result.begin(), result.end(), [](const CostRow& a, const CostRow& b) { return a.error > b.error; });
    return result;
}

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const Price& price) {
    const auto flags = out.flags();
    const auto digits = out.precision();
    // a number, or a dash where there is none
    const auto put = [&](int width, double value, bool is_any) -> std::ostream& {
        out << std::setw(width);
        return is_any ? out << value : out << "-";
    };
    out << std::left << std::setw(13) << "engine" << std::right << std::setw(10) << "tolerance" << std::setw(9)
        << "motion" << std::setw(9) << "events" << std::setw(9) << "found" << std::setw(11) << "time [ms]"
        << std::setw(8) << "spread" << std::setw(12) << "whole [ms]" << std::setw(9) << "steps" << std::setw(18)
        << "right-hand sides" << '\n';
    const std::vector<CostRow> front = price.front();
    for (const CostRow& r : price.rows) {
        out << std::left << std::setw(13) << r.engine << std::right << std::scientific << std::setprecision(0);
        put(10, r.tolerance, r.tolerance > 0.0) << std::setprecision(1);
        put(9, r.motion_error, std::isfinite(r.motion_error));
        put(9, r.event_error, r.events_expected > 0);
        out << std::setw(9)
            << (r.has_all_events && r.events_expected == 0
                    ? "-"
                    : std::to_string(r.events) + "/" + std::to_string(r.events_expected) +
                          (r.has_all_events ? "" : "!"));
        out << std::fixed << std::setprecision(4) << std::setw(11) << r.seconds * 1e3;
        out << std::setw(8)
            << (std::isnan(r.spread) ? "-" : std::to_string(static_cast<int>(std::ceil(r.spread * 100.0))) + " %");
        put(12, r.total * 1e3, !std::isnan(r.total));
        out << std::setw(9) << r.steps << std::setw(18) << r.right_hand_sides;
        const auto is_row = [&](const CostRow& f) { return f.engine == r.engine && f.tolerance == r.tolerance; };
        if (std::any_of(front.begin(), front.end(), is_row)) out << "  *";
        out << '\n';
    }
    out.flags(flags);
    out.precision(digits);
    out << "* none is as accurate and quicker; auto takes "
        << (price.automatic == "auto" ? "taylor, and cvode-bdf where that is stiff" : price.automatic) << '\n';
    for (const MissingEngine& m : price.missing) {
        out << "missing: " << m.engine;
        if (m.tolerance > 0.0) out << " from tolerance " << pricing::about(m.tolerance) << " on";
        out << ": " << m.reason << '\n';
    }
    return out << "errors against " << price.reference << '\n';
}

}  // namespace rbdyn::inline RBDYN_FORM
