// Definitions of rbdyn/mechanics/cone_program.hpp.
#pragma once

#include "rbdyn/mechanics/cone_program.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/mechanics/closure.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

namespace cones {

/// A coefficient that leaves no edge to slide on.
inline bool is_endless(const Cone& cone) { return !(cone.mu < 1e8); }

/// The same problem with numbers near 1: z and u of each contact divided by sizes of its own, T by mu besides.
struct Scaled {
    Scaled(const Square& matrix, const std::vector<double>& driving, const std::vector<double>& rounding,
           const std::vector<Cone>& all)
        : cones(all), a(matrix), b(driving), noise(rounding), force(driving.size(), 1.0), width(driving.size(), 1.0) {
        double most = 0.0, largest_of_all = 0.0;
        for (std::size_t i = 0; i < b.size(); ++i) largest_of_all = std::max(largest_of_all, std::abs(a[i][i]));
        // in a unit that is a power of two, so that roots are the same in units of mass that are one
        if (largest_of_all > 0.0) whole = std::ldexp(1.0, std::ilogb(largest_of_all));
        for (const Cone& cone : cones) {
            const auto f = static_cast<std::size_t>(cone.first);
            double largest = 0.0;
            for (std::size_t i = f; i < f + unknowns(cone); ++i) largest = std::max(largest, std::abs(a[i][i]) / whole);
            for (std::size_t i = f; i < f + unknowns(cone); ++i) {
                force[i] = largest > 0.0 ? 1.0 / std::sqrt(largest) : 1.0;
                most = std::max(most, std::abs(b[i]) * force[i]);
                if (i > f && !is_endless(cone)) force[i] *= width[i] = cone.mu;
            }
        }
        size = most > 0.0 ? most : 1.0;
        for (std::size_t i = 0; i < b.size(); ++i) {
            for (std::size_t j = 0; j < b.size(); ++j) a[i][j] = a[i][j] / whole * (force[i] * force[j]);
            b[i] *= force[i] / size;
            noise[i] *= force[i] / size;
        }
    }
    static std::size_t unknowns(const Cone& cone) { return cone.is_line ? 1 : 3; }

    std::vector<double> rates(const std::vector<double>& z) const {
        std::vector<double> u = b;
        for (std::size_t i = 0; i < u.size(); ++i)
            for (std::size_t j = 0; j < z.size(); ++j) u[i] += a[i][j] * z[j];
        return u;
    }
    /// The size of the rounding of a rate.
    double rounding(std::size_t i, const std::vector<double>& z) const {
        double sum = noise[i];
        for (std::size_t j = 0; j < z.size(); ++j) sum += 1e-15 * std::abs(a[i][j] * z[j]);
        return sum;
    }
    std::vector<double> in(std::vector<double> z) const {
        for (std::size_t i = 0; i < z.size(); ++i) z[i] /= force[i] * size / whole;
        return z;
    }
    ConeForces out(const std::vector<double>& z, const std::vector<double>& u, std::vector<ConeState> states) const {
        ConeForces result{z, u, std::move(states), true};
        for (std::size_t i = 0; i < z.size(); ++i) {
            result.force[i] *= force[i] * size / whole;
            result.rate[i] *= size / force[i];
        }
        return result;
    }

    const std::vector<Cone>& cones;
    Square a;
    std::vector<double> b, noise, force;  // the last: of z, times size / whole, for a unit of the scaled problem
    std::vector<double> width;            // mu where it scales, else 1
    double size = 1.0, whole = 1.0;       // of rates, and of the matrix
};

inline double across(const std::vector<double>& v, std::size_t f) { return std::hypot(v[f + 1], v[f + 2]); }

/// Where z.A z/2 + b.z is least in the cones, by an interior path (S. Boyd and L. Vandenberghe, Convex Optimization,
/// 2004, chapter 11); none if it has no least value.
inline std::optional<std::vector<double>> least_in_cones(const Scaled& p, const std::vector<double>& b) {
    const std::size_t n = b.size();
    constexpr double beyond = 1e8, regular = 1e-13;
    std::vector<double> z(n, 0.0);
    for (const Cone& cone : p.cones) z[static_cast<std::size_t>(cone.first)] = 1.0;
    const auto has_edge = [](const Cone& cone) { return !cone.is_line && !is_endless(cone); };
    // N^2 - |T|^2 without what cancels
    const auto inside = [&](const Cone& cone, const std::vector<double>& at) {
        const auto f = static_cast<std::size_t>(cone.first);
        if (!has_edge(cone)) return at[f];
        const double t = across(at, f);
        return at[f] > t ? (at[f] - t) * (at[f] + t) : -1.0;
    };
    const auto value = [&](const std::vector<double>& at, double weight) -> std::optional<double> {
        double sum = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            double slope = 0.5 * regular * p.width[i] * p.width[i] * at[i] + b[i];
            for (std::size_t j = 0; j < n; ++j) slope += 0.5 * p.a[i][j] * at[j];
            sum += slope * at[i];
        }
        for (const Cone& cone : p.cones) {
            const double q = inside(cone, at);
            if (!(q > 0.0)) return std::nullopt;
            sum -= weight * std::log(q);
        }
        return sum;
    };
    for (double weight = 1.0; weight > 1e-19; weight *= 0.1) {
        std::optional<double> reached;  // the value where it is
        for (int pass = 0; pass < 50; ++pass) {
            Square bend = p.a;
            std::vector<double> down(n);
            for (std::size_t i = 0; i < n; ++i) {
                const double own = regular * p.width[i] * p.width[i];
                bend[i][i] += own;
                down[i] = -b[i] - own * z[i];
                for (std::size_t j = 0; j < n; ++j) down[i] -= p.a[i][j] * z[j];
            }
            for (const Cone& cone : p.cones) {
                const auto f = static_cast<std::size_t>(cone.first);
                const double q = inside(cone, z);
                if (!has_edge(cone)) {
                    down[f] += weight / q;
                    bend[f][f] += weight / (q * q);
                    continue;
                }
                const double slope[3] = {2.0 * z[f], -2.0 * z[f + 1], -2.0 * z[f + 2]};
                for (std::size_t i = 0; i < 3; ++i) {
                    down[f + i] += weight * slope[i] / q;
                    bend[f + i][f + i] -= weight * (i == 0 ? 2.0 : -2.0) / q;
                    for (std::size_t j = 0; j < 3; ++j) bend[f + i][f + j] += weight * slope[i] * slope[j] / (q * q);
                }
            }
            const std::vector<double> step = solve_definite<double>(bend, down);
            double falls = 0.0, largest = 0.0;
            for (std::size_t i = 0; i < n; ++i) falls += step[i] * down[i];
            if (!(falls > 1e-8 * weight)) break;
            const double now = reached ? *reached : *value(z, weight);
            double way = 1.0;
            std::vector<double> next(n);
            for (; way > 1e-10; way *= 0.5) {
                for (std::size_t i = 0; i < n; ++i) next[i] = z[i] + way * step[i];
                reached = value(next, weight);
                if (reached && *reached <= now - 0.1 * way * falls) break;
            }
            if (way <= 1e-10) break;
            z = next;
            for (const double one : z) largest = std::max(largest, std::abs(one));
            if (!(largest < beyond)) return std::nullopt;
        }
    }
    return z;
}

/// Newton's method for what each contact does, from z and, of what slides, its speed over its force: u_t = -slip T.
/// Whether it arrives.
inline bool newton(const Scaled& p, const std::vector<ConeState>& states, std::vector<double>& z,
                   std::vector<double>& slip) {
    std::vector<std::size_t> unknown;  // of z, then of slip
    std::vector<std::size_t> sliding;
    for (std::size_t k = 0; k < p.cones.size(); ++k) {
        const auto f = static_cast<std::size_t>(p.cones[k].first);
        for (std::size_t i = 0; i < Scaled::unknowns(p.cones[k]); ++i)
            if (states[k] == ConeState::open)
                z[f + i] = 0.0;
            else
                unknown.push_back(f + i);
        if (states[k] == ConeState::slides && !p.cones[k].is_line) sliding.push_back(k);
    }
    const std::size_t n = unknown.size(), all = n + sliding.size();
    if (all == 0) return true;
    double before = 1e300;
    for (int pass = 0; pass < 60; ++pass) {
        std::vector<double> u = p.rates(z), left(all);
        SquareMatrix m(static_cast<int>(all));
        const auto put = [&](std::size_t i, std::size_t j, double v) {
            m(static_cast<int>(i), static_cast<int>(j)) += v;
        };
        const auto place = [&](std::size_t of) {
            return static_cast<std::size_t>(std::find(unknown.begin(), unknown.end(), of) - unknown.begin());
        };
        for (std::size_t i = 0; i < n; ++i) {
            left[i] = -u[unknown[i]];
            for (std::size_t j = 0; j < n; ++j) put(i, j, p.a[unknown[i]][unknown[j]]);
        }
        for (std::size_t s = 0; s < sliding.size(); ++s) {
            const std::size_t k = sliding[s];
            const auto f = static_cast<std::size_t>(p.cones[k].first);
            for (std::size_t i = 1; i < 3; ++i) {
                const std::size_t row = place(f + i);
                left[row] -= slip[k] * z[f + i];
                put(row, row, slip[k]);
                put(row, n + s, z[f + i]);
                put(n + s, row, 2.0 * z[f + i]);
            }
            put(n + s, place(f), -2.0 * z[f]);
            const double t = across(z, f);
            left[n + s] = (z[f] - t) * (z[f] + t);
        }
        double size = 0.0;
        for (std::size_t i = 0; i < all; ++i) {
            double noise = 1e-300;
            if (i < n) {
                noise += p.rounding(unknown[i], z);
            } else {
                const double normal = z[static_cast<std::size_t>(p.cones[sliding[i - n]].first)];
                noise += 1e-15 * normal * normal;
            }
            if (!std::isfinite(left[i])) return false;
            size = std::max(size, std::abs(left[i]) / noise);
        }
        // as near as rounding lets it
        if (!(size < before) && before < 100.0) return true;
        if (pass > 20 && !(size < before)) return false;
        before = size;
        // numbers near 1, so that what is small beside them is rounding
        double force = 1e-150;
        for (const double one : z) force = std::max(force, std::abs(one));
        std::vector<double> row(all, 1.0 / force), column(all, force);
        for (std::size_t i = 0; i < n; ++i) {
            row[i] /= p.width[unknown[i]];
            column[i] /= p.width[unknown[i]];
        }
        for (std::size_t s = 0; s < sliding.size(); ++s) {
            const std::size_t k = sliding[s];
            const auto f = static_cast<std::size_t>(p.cones[k].first);
            const double own = std::max(std::abs(z[f]), 1e-150);
            // forces are on the edge, and rows across it small where mu is, or large where it slips fast
            double resisted = std::max(std::abs(slip[k]), 1e-150);
            for (std::size_t i = 1; i < 3; ++i)
                for (std::size_t j = 0; j < n; ++j) resisted = std::max(resisted, std::abs(p.a[f + i][unknown[j]]));
            for (std::size_t i = 1; i < 3; ++i) {
                row[place(f + i)] = 1.0 / (force * resisted);
                column[place(f + i)] = force;
            }
            row[n + s] /= own;
            column[n + s] = resisted * force / own;
        }
        for (std::size_t i = 0; i < all; ++i) {
            left[i] *= row[i];
            for (std::size_t j = 0; j < all; ++j) m(static_cast<int>(i), static_cast<int>(j)) *= row[i] * column[j];
        }
        const std::vector<double> step = solve(m, left, 1e-12).x;
        for (std::size_t i = 0; i < n; ++i) z[unknown[i]] += step[i] * column[i];
        for (std::size_t s = 0; s < sliding.size(); ++s) slip[sliding[s]] += step[n + s] * column[n + s];
    }
    return before < 100.0;
}

/// Whether what contacts hold is at rest to the rounding of forces that move something. Those that cancel each other,
/// as of what is squeezed between two surfaces, move nothing however large they are, and rounding of ever larger ones
/// would be any rates at all.
inline bool is_held_by_what_moves(const Scaled& p, const std::vector<ConeState>& states, const std::vector<double>& z,
                                  const std::vector<double>& slip) {
    constexpr double large = 1e3, nothing = 1e-12, roundings = 100.0;
    const int n = static_cast<int>(z.size());
    const std::vector<double> u = p.rates(z);
    double largest = 0.0;
    SquareMatrix m(n);
    std::vector<double> made;
    for (std::size_t i = 0; i < z.size(); ++i) {
        for (std::size_t j = 0; j < z.size(); ++j) {
            m(static_cast<int>(i), static_cast<int>(j)) = p.a[i][j];
            largest = std::max(largest, std::abs(p.a[i][j] * z[j]));
        }
        made.push_back(u[i] - p.b[i]);
    }
    if (largest <= large) return true;
    // the same rates by forces without such a part
    const std::vector<double> moving = solve(std::move(m), std::move(made), nothing).x;
    for (std::size_t k = 0; k < states.size(); ++k) {
        if (states[k] == ConeState::open) continue;
        const auto f = static_cast<std::size_t>(p.cones[k].first);
        for (std::size_t i = f; i < f + Scaled::unknowns(p.cones[k]); ++i) {
            const double asked = i == f || states[k] == ConeState::held ? 0.0 : -slip[k] * z[i];
            if (std::abs(u[i] - asked) > roundings * p.rounding(i, moving)) return false;
        }
    }
    return true;
}

/// The exact solution from one nearby, what contacts do changed until all conditions hold.
inline std::optional<ConeForces> settled(const Scaled& p, std::vector<ConeState> states, std::vector<double> z) {
    const std::size_t count = p.cones.size();
    // what has no edge does not slide on it
    for (std::size_t k = 0; k < count; ++k)
        if (states[k] == ConeState::slides && !p.cones[k].is_line && is_endless(p.cones[k])) return std::nullopt;
    std::vector<double> slip(count, 0.0), u = p.rates(z);
    const auto resisted = [&](std::size_t k) {
        const auto f = static_cast<std::size_t>(p.cones[k].first);
        const double t = across(z, f);
        return t > 0.0 ? across(u, f) / t : 1.0;
    };
    for (std::size_t k = 0; k < count; ++k)
        if (states[k] == ConeState::slides && !p.cones[k].is_line) slip[k] = resisted(k);
    for (std::size_t turn = 0; turn <= 4 * count + 4; ++turn) {
        const std::vector<double> known = z;
        if (!newton(p, states, z, slip)) {
            // what slides and does not push has no resistance of its own: the one that pushes least opens
            z = known;
            std::size_t least = count;
            for (std::size_t k = 0; k < count; ++k) {
                const auto f = static_cast<std::size_t>(p.cones[k].first);
                if (states[k] != ConeState::slides || p.cones[k].is_line) continue;
                if (least == count || z[f] < z[static_cast<std::size_t>(p.cones[least].first)]) least = k;
            }
            if (least == count) return std::nullopt;
            states[least] = ConeState::open;
            continue;
        }
        u = p.rates(z);
        std::size_t worst = count;
        double most = 0.0;
        ConeState instead = ConeState::open;
        const auto fails = [&](std::size_t k, double by, ConeState other) {
            if (by <= most) return;
            most = by;
            worst = k;
            instead = other;
        };
        for (std::size_t k = 0; k < count; ++k) {
            const Cone& cone = p.cones[k];
            const auto f = static_cast<std::size_t>(cone.first);
            if (states[k] == ConeState::open) {
                if (u[f] < -8.0 * p.rounding(f, z)) fails(k, -u[f], cone.is_line ? ConeState::slides : ConeState::held);
                continue;
            }
            if (z[f] < 0.0) fails(k, -z[f], ConeState::open);
            if (cone.is_line) continue;
            if (states[k] == ConeState::slides && slip[k] < 0.0) fails(k, -slip[k], ConeState::held);
            const double over = across(z, f) - z[f];
            if (states[k] == ConeState::held && !is_endless(cone) && z[f] > 0.0 && over > 1e-14 * z[f])
                fails(k, over, ConeState::slides);
        }
        if (worst == count) {
            if (!is_held_by_what_moves(p, states, z, slip)) return std::nullopt;
            // what is at rest is so exactly
            for (std::size_t k = 0; k < count; ++k) {
                if (states[k] == ConeState::open) continue;
                const auto f = static_cast<std::size_t>(p.cones[k].first);
                u[f] = 0.0;
                for (std::size_t i = 1; i < Scaled::unknowns(p.cones[k]); ++i)
                    u[f + i] = states[k] == ConeState::held ? 0.0 : -slip[k] * z[f + i];
            }
            return p.out(z, u, std::move(states));
        }
        const auto f = static_cast<std::size_t>(p.cones[worst].first);
        states[worst] = instead;
        if (instead == ConeState::slides && !p.cones[worst].is_line) {
            slip[worst] = 0.0;
            // onto its edge
            const double t = across(z, f);
            for (std::size_t i = 1; i < 3; ++i) z[f + i] *= z[f] / t;
        }
    }
    return std::nullopt;
}

}  // namespace cones

RBDYN_INLINE std::optional<ConeForces> made_exact(const Square& a, const std::vector<double>& b,
                                                  const std::vector<double>& noise, const std::vector<Cone>& all,
                                                  const ConeForces& near) {
    const cones::Scaled p(a, b, noise, all);
    return cones::settled(p, near.states, p.in(near.force));
}

RBDYN_INLINE std::optional<ConeForces> solve_convex(const Square& a, const std::vector<double>& b,
                                                    const std::vector<double>& noise, const std::vector<Cone>& all) {
    const cones::Scaled p(a, b, noise, all);
    std::vector<double> speed(all.size(), 0.0);
    for (int turn = 0; turn < 40; ++turn) {
        std::vector<double> pushed = p.b;
        for (std::size_t k = 0; k < all.size(); ++k) pushed[static_cast<std::size_t>(all[k].first)] += speed[k];
        const auto z = cones::least_in_cones(p, pushed);
        if (!z) return std::nullopt;
        const std::vector<double> u = p.rates(*z);
        std::vector<ConeState> states;
        double change = 0.0;
        for (std::size_t k = 0; k < all.size(); ++k) {
            const auto f = static_cast<std::size_t>(all[k].first);
            const double normal = (*z)[f], away = u[f] + speed[k];
            // by which of two numbers whose product is all but zero is the smaller
            if (all[k].is_line || cones::is_endless(all[k])) {
                const ConeState closed = all[k].is_line ? ConeState::slides : ConeState::held;
                states.push_back(normal < away ? ConeState::open : closed);
                continue;
            }
            // a speed is mu times as large here
            const double slips = cones::across(u, f), t = cones::across(*z, f);
            states.push_back(normal + t < away - slips                    ? ConeState::open
                             : normal - t > away + slips / p.width[f + 1] ? ConeState::held
                                                                          : ConeState::slides);
            change = std::max(change, std::abs(slips - speed[k]));
            speed[k] = slips;
        }
        if (auto exact = cones::settled(p, states, *z)) return exact;
        if (change < 1e-12) break;
    }
    return std::nullopt;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
