// Definitions of rbdyn/mechanics/friction_cones.hpp.
#pragma once

#include "rbdyn/mechanics/friction_cones.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/dense.hpp"
#include "rbdyn/mechanics/cone_program.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE std::vector<double> solve_any(const Square& a, const std::vector<double>& b, double nothing) {
    const int n = static_cast<int>(b.size());
    SquareMatrix matrix(n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) matrix(i, j) = a[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    return rbdyn::solve(std::move(matrix), b, nothing).x;
}

namespace cones {

using Three = std::array<double, 3>;

/// The forces of one contact that hold it, those across it resisted by `more` besides: (W + diag(0, more, more)) z =
/// -q; of many that do the least.
inline Three holding(const Square& a, std::size_t f, const Three& q, double more) {
    SquareMatrix w(3);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            w(i, j) =
                a[f + static_cast<std::size_t>(i)][f + static_cast<std::size_t>(j)] + (i == j && i > 0 ? more : 0.0);
    const LinearSolution solution = rbdyn::solve(w, {-q[0], -q[1], -q[2]}, 1e-12);
    // what joints resist beside it makes of it one that is not symmetric, which has no such axes
    double lopsided = 0.0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j) lopsided = std::max(lopsided, std::abs(w(i, j) - w(j, i)));
    if (solution.pivots > 1e-12 || lopsided > 1e-12 * std::max({w(0, 0), w(1, 1), w(2, 2)}))
        return {solution.x[0], solution.x[1], solution.x[2]};
    const SymmetricEigen parts = symmetric_eigen(w);
    Three z{};
    for (int k = 0; k < 3; ++k) {
        if (!(parts.values[static_cast<std::size_t>(k)] > 1e-12 * parts.values[2])) continue;
        double along = 0.0;
        for (int i = 0; i < 3; ++i) along -= parts.vectors(i, k) * q[static_cast<std::size_t>(i)];
        for (int i = 0; i < 3; ++i)
            z[static_cast<std::size_t>(i)] += parts.vectors(i, k) * along / parts.values[static_cast<std::size_t>(k)];
    }
    return z;
}

inline double across(const Three& z) { return std::hypot(z[1], z[2]); }

/// One contact alone, the others' forces given: its own force and state.
inline std::pair<Three, ConeState> alone(const Square& a, std::size_t f, double mu, const Three& q, double noise) {
    if (q[0] >= -noise || !(a[f][f] > 0.0)) return {{0.0, 0.0, 0.0}, ConeState::open};
    const Three held = holding(a, f, q, 0.0);
    if (held[0] > 0.0 && across(held) <= mu * held[0]) return {held, ConeState::held};
    if (!std::isfinite(mu)) return {{0.0, 0.0, 0.0}, ConeState::open};
    // it slides as if across it it were resisted by its speed: by how much is the root of |T| = mu N
    const auto excess = [&](const Three& z) { return across(z) - mu * std::max(z[0], 0.0); };
    double low = 0.0, high = 1e-3 * (a[f + 1][f + 1] + a[f + 2][f + 2]);
    Three z = holding(a, f, q, high);
    for (int i = 0; i < 200 && excess(z) > 0.0; ++i) {
        low = high;
        high *= 4.0;
        z = holding(a, f, q, high);
    }
    double above = excess(low > 0.0 ? holding(a, f, q, low) : held), below = excess(z);
    for (int i = 0; i < 200 && high - low > 4e-16 * high && below < 0.0; ++i) {
        double middle = low + (high - low) * above / (above - below);
        if (i % 3 == 2 || !(middle > low && middle < high)) middle = 0.5 * (low + high);
        const Three tried = holding(a, f, q, middle);
        const double now = excess(tried);
        (now > 0.0 ? low : high) = middle;
        (now > 0.0 ? above : below) = now;
        if (now <= 0.0) z = tried;
    }
    return {z, ConeState::slides};
}

/// But for rounding: also along axes that nothing can move along.
inline bool is_symmetric(const Square& a) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i][i]));
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (std::abs(a[i][j] - a[j][i]) > 1e-10 * std::sqrt(std::abs(a[i][i] * a[j][j])) + 1e-14 * largest)
                return false;
    return true;
}

/// Narrower than rounding: it is as good as a line.
inline bool is_needle(const Cone& cone) { return !cone.is_line && cone.mu < 1e-15; }

/// The same problem with lines in place of needles, and what follows across them.
inline ConeForces solve_with_lines(const Square& a, const std::vector<double>& b, const std::vector<double>& noise,
                                   const std::vector<Cone>& all) {
    std::vector<std::size_t> kept;
    std::vector<Cone> narrow;
    for (const Cone& cone : all) {
        const auto f = static_cast<std::size_t>(cone.first);
        const bool is_line = cone.is_line || is_needle(cone);
        narrow.push_back({static_cast<int>(kept.size()), is_line, cone.mu});
        for (std::size_t i = f; i < f + (is_line ? 1 : 3); ++i) kept.push_back(i);
    }
    Square rows(kept.size(), std::vector<double>(kept.size()));
    std::vector<double> driving, rounding;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        for (std::size_t j = 0; j < kept.size(); ++j) rows[i][j] = a[kept[i]][kept[j]];
        driving.push_back(b[kept[i]]);
        rounding.push_back(noise[kept[i]]);
    }
    ConeForces found = solve_cones(rows, driving, rounding, narrow);
    ConeForces result{std::vector<double>(b.size(), 0.0), b, std::move(found.states), found.is_solved};
    for (std::size_t i = 0; i < kept.size(); ++i) result.force[kept[i]] = found.force[i];
    for (std::size_t i = 0; i < b.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j) result.rate[i] += a[i][j] * result.force[j];
    for (std::size_t i = 0; i < kept.size(); ++i) result.rate[kept[i]] = found.rate[i];
    return result;
}

/// Of few contacts each way that they may go on, from forces nearby: where rows all but depend on each other, as of the
/// two ends of a rod that lies between them, what has nearly been found says little about what slides.
inline std::optional<ConeForces> by_trial(const Square& a, const std::vector<double>& b,
                                          const std::vector<double>& noise, const std::vector<Cone>& all,
                                          const ConeForces& near) {
    constexpr std::size_t most = 4;
    if (all.size() > most) return std::nullopt;
    std::size_t ways = 1;
    for (std::size_t k = 0; k < all.size(); ++k) ways *= 3;
    for (std::size_t way = 0; way < ways; ++way) {
        ConeForces tried = near;
        std::size_t rest = way;
        bool is_one = true;
        for (std::size_t k = 0; k < all.size(); ++k, rest /= 3) {
            const auto f = static_cast<std::size_t>(all[k].first);
            tried.states[k] = rest % 3 == 0 ? ConeState::slides : rest % 3 == 1 ? ConeState::held : ConeState::open;
            if (all[k].is_line) is_one = is_one && tried.states[k] != ConeState::held;
            if (all[k].is_line || tried.states[k] != ConeState::slides) continue;
            // on the edge of its cone, against what it would do
            double u[2] = {b[f + 1], b[f + 2]};
            for (std::size_t i = 0; i < 2; ++i)
                for (std::size_t j = 0; j < b.size(); ++j) u[i] += a[f + 1 + i][j] * near.force[j];
            const double speed = std::hypot(u[0], u[1]);
            if (!(tried.force[f] > 0.0)) tried.force[f] = std::abs(b[f]) / std::max(a[f][f], 1e-300);
            for (std::size_t i = 0; i < 2 && speed > 0.0; ++i)
                tried.force[f + 1 + i] = -all[k].mu * tried.force[f] * u[i] / speed;
        }
        if (!is_one) continue;
        if (auto exact = made_exact(a, b, noise, all, tried)) return exact;
    }
    return std::nullopt;
}

}  // namespace cones

RBDYN_INLINE ConeForces solve_cones(const Square& a, const std::vector<double>& b, const std::vector<double>& noise,
                                    const std::vector<Cone>& all) {
    const std::size_t n = b.size();
    ConeForces result{std::vector<double>(n, 0.0), b, std::vector<ConeState>(all.size(), ConeState::open), true};
    if (std::any_of(all.begin(), all.end(), cones::is_needle)) return cones::solve_with_lines(a, b, noise, all);
    std::vector<double>& z = result.force;
    result.is_solved = std::all_of(b.begin(), b.end(), [](double one) { return std::isfinite(one); });
    const auto pushes = [&](const Cone& cone) {
        return b[static_cast<std::size_t>(cone.first)] < -noise[static_cast<std::size_t>(cone.first)];
    };
    if (!result.is_solved || std::none_of(all.begin(), all.end(), pushes)) return result;
    const bool is_symmetric = cones::is_symmetric(a);
    if (is_symmetric)
        if (auto found = solve_convex(a, b, noise, all)) return *std::move(found);
    const auto driven = [&](std::size_t row, std::size_t first, std::size_t count) {
        double sum = b[row];
        for (std::size_t j = 0; j < n; ++j)
            if (j < first || j >= first + count) sum += a[row][j] * z[j];
        return sum;
    };
    // one contact after the other, until nothing changes
    const int most = is_symmetric ? 500 : 20000;
    double left = 1.0;
    for (int sweep = 0; sweep < most; ++sweep) {
        double change = 0.0, size = 0.0;
        for (std::size_t k = 0; k < all.size(); ++k) {
            const auto f = static_cast<std::size_t>(all[k].first);
            if (all[k].is_line) {
                const double q = driven(f, f, 1);
                const double force = q < -noise[f] && a[f][f] > 0.0 ? -q / a[f][f] : 0.0;
                change = std::max(change, std::abs(force - z[f]));
                size = std::max(size, std::abs(force));
                z[f] = force;
                result.states[k] = force > 0.0 ? ConeState::slides : ConeState::open;
                if (!(a[f][f] > 0.0) && q < -noise[f]) result.is_solved = false;
                continue;
            }
            const auto [force, state] =
                cones::alone(a, f, all[k].mu, {driven(f, f, 3), driven(f + 1, f, 3), driven(f + 2, f, 3)}, noise[f]);
            for (std::size_t i = 0; i < 3; ++i) {
                change = std::max(change, std::abs(force[i] - z[f + i]));
                size = std::max(size, std::abs(force[i]));
                z[f + i] = force[i];
            }
            result.states[k] = state;
        }
        left = size > 0.0 ? change / size : 0.0;
        // what takes long: by what each contact does so far
        if (!(left <= 1e-15) && sweep % 50 != 49 && sweep != most - 1) continue;
        if (auto exact = made_exact(a, b, noise, all, result)) return *exact;
        if (left <= 1e-15) break;
    }
    if (auto found = cones::by_trial(a, b, noise, all, result)) return *std::move(found);
    for (std::size_t i = 0; i < n; ++i) result.rate[i] = driven(i, n, 0);
    // one alone with a cone so wide that it all but has no edge is solved for as it is, if forces do not cancel each
    // other; else what is symmetric and has no exact solution has none
    constexpr double wide = 1e6, most_cancelled = 1e6;
    double largest = 0.0, asked = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        asked = std::max(asked, std::abs(b[i]));
        for (std::size_t j = 0; j < n; ++j) largest = std::max(largest, std::abs(a[i][j] * z[j]));
    }
    const bool is_exact = all.size() == 1 && all[0].mu > wide && left <= 1e-15 &&
                          result.states[0] == ConeState::slides && largest <= most_cancelled * asked;
    result.is_solved = result.is_solved && (is_exact || (left <= 1e-9 && !is_symmetric));
    return result;
}

RBDYN_INLINE ConeForces solve_any_cones(const Square& a, const std::vector<double>& b, const std::vector<double>& noise,
                                        std::vector<Cone> cones) {
    ConeForces found = solve_cones(a, b, noise, cones);
    const auto is_endless = [](const Cone& cone) { return !cone.is_line && !std::isfinite(cone.mu); };
    const auto slips = [&](std::size_t i) {
        const auto f = static_cast<std::size_t>(cones[i].first);
        return is_endless(cones[i]) && found.states[i] == ConeState::slides &&
               std::hypot(found.rate[f + 1], found.rate[f + 2]) > 1e3 * (noise[f + 1] + noise[f + 2]);
    };
    bool is_right = found.is_solved;
    for (std::size_t i = 0; i < cones.size() && is_right; ++i) is_right = !slips(i);
    if (is_right || std::none_of(cones.begin(), cones.end(), is_endless)) return found;
    for (Cone& cone : cones)
        if (is_endless(cone)) cone.mu = cone.widest;
    return solve_cones(a, b, noise, cones);
}

RBDYN_INLINE ConeForces held_by(const Square& a, const std::vector<double>& b, const std::vector<double>& noise,
                                const std::vector<Cone>& all) {
    std::vector<double> right;
    for (const double one : b) right.push_back(-one);
    ConeForces result{solve_any(a, right), b, {}, true};
    for (const Cone& cone : all) result.states.push_back(cone.is_line ? ConeState::slides : ConeState::held);
    for (std::size_t i = 0; i < b.size(); ++i) {
        double size = noise[i];
        for (std::size_t j = 0; j < b.size(); ++j) {
            result.rate[i] += a[i][j] * result.force[j];
            size += 1e-14 * std::abs(a[i][j] * result.force[j]);
        }
        result.is_solved = result.is_solved && std::abs(result.rate[i]) <= 100.0 * size;
        result.rate[i] = 0.0;
    }
    return result;
}

RBDYN_INLINE bool are_inside(const std::vector<double>& force, const std::vector<Cone>& all) {
    for (const Cone& cone : all) {
        const auto f = static_cast<std::size_t>(cone.first);
        if (!(force[f] >= 0.0)) return false;
        if (cone.is_line || !std::isfinite(cone.mu)) continue;
        if (std::hypot(force[f + 1], force[f + 2]) > cone.mu * force[f] * (1.0 + 1e-14)) return false;
    }
    return true;
}

RBDYN_INLINE std::vector<double> forces_inside(const std::vector<double>& z0, const Square& directions,
                                               const std::vector<Cone>& all, double size,
                                               std::vector<double>* nearest) {
    // the least of |z|^2 / (2 size^2) - 0.1 sum log(mu^2 N^2 - |T|^2); first, with N + s in place of N, of s less ever
    // less of the logarithms, until s is negative (S. Boyd and L. Vandenberghe, Convex Optimization, 2004, chapter 11)
    const std::size_t count = directions.size();
    double weight = 0.1;
    std::vector<double> c(count + 1, 0.0);  // the last: s / size
    const auto value_of = [&](const std::vector<double>& at, std::size_t row) {
        double sum = z0[row] / size;
        for (std::size_t i = 0; i < count; ++i) sum += at[i] * directions[i][row];
        return sum;
    };
    const auto slope_of = [&](std::size_t row, std::size_t i, bool is_normal) {
        return i < count ? directions[i][row] : is_normal ? 1.0 : 0.0;
    };
    // the value, and where asked its gradient and its second derivatives; of the value what is rounding
    double rounding = 0.0;
    std::vector<double> dn(count + 1), dq(count + 1);
    const Square none(count + 1, std::vector<double>(count + 1, 0.0));
    Square ddq = none;
    const auto barrier = [&](const std::vector<double>& at, bool first, std::vector<double>* slope, Square* bend) {
        double sum = first ? at[count] : 0.0;
        rounding = 0.0;
        if (slope != nullptr) {
            slope->assign(count + 1, 0.0);
            bend->assign(count + 1, std::vector<double>(count + 1, 0.0));
            if (first) (*slope)[count] = 1.0;
        }
        const auto square = [&](std::size_t row, double times) {
            const double v = value_of(at, row);
            sum += 0.5 * times * v * v;
            if (slope == nullptr) return;
            for (std::size_t i = 0; i < count; ++i) {
                (*slope)[i] += times * v * directions[i][row];
                for (std::size_t j = 0; j < count; ++j)
                    (*bend)[i][j] += times * directions[i][row] * directions[j][row];
            }
        };
        const auto inside = [&](double q, double terms, const std::vector<double>& by, const Square& twice) {
            if (!(q > 0.0)) return false;
            sum -= weight * std::log(q);
            rounding += 0x1p-50 * weight * terms / q;
            if (slope == nullptr) return true;
            for (std::size_t i = 0; i <= count; ++i) {
                (*slope)[i] -= weight * by[i] / q;
                for (std::size_t j = 0; j <= count; ++j)
                    (*bend)[i][j] += weight * (by[i] * by[j] / q - twice[i][j]) / q;
            }
            return true;
        };
        for (const Cone& cone : all) {
            const auto f = static_cast<std::size_t>(cone.first);
            const std::size_t own = cone.is_line ? 1 : 3;
            for (std::size_t i = 0; i < own; ++i) square(f + i, first ? 1e-2 * weight : 1.0);
            const double normal = value_of(at, f) + (first ? at[count] : 0.0);
            if (slope != nullptr)
                for (std::size_t i = 0; i <= count; ++i) dn[i] = slope_of(f, i, true);
            if (!inside(normal, 1.0, dn, none)) return std::pair(false, 0.0);
            if (cone.is_line || !std::isfinite(cone.mu)) continue;
            const double most = cone.mu * cone.mu * normal * normal;
            double q = most;
            for (std::size_t i = 0; i <= count && slope != nullptr; ++i) {
                dq[i] = 2.0 * cone.mu * cone.mu * normal * dn[i];
                for (std::size_t j = 0; j <= count; ++j) ddq[i][j] = 2.0 * cone.mu * cone.mu * dn[i] * dn[j];
            }
            for (std::size_t k = 1; k < 3; ++k) {
                const double v = value_of(at, f + k);
                q -= v * v;
                for (std::size_t i = 0; i <= count && slope != nullptr; ++i) {
                    dq[i] -= 2.0 * v * slope_of(f + k, i, false);
                    for (std::size_t j = 0; j <= count; ++j)
                        ddq[i][j] -= 2.0 * slope_of(f + k, i, false) * slope_of(f + k, j, false);
                }
            }
            if (!inside(q, most, dq, ddq)) return std::pair(false, 0.0);
        }
        return std::pair(true, sum);
    };
    const auto descend = [&](bool first) {
        std::vector<double> slope;
        Square bend;
        for (int pass = 0; pass < 200; ++pass) {
            const auto [is_in, now] = barrier(c, first, &slope, &bend);
            const double known = rounding;
            if (!is_in) return false;
            if (first && c[count] < 0.0) return true;
            if (!first)
                for (std::size_t i = 0; i <= count; ++i)
                    bend[i][count] = bend[count][i] = slope[count] = i == count ? 1.0 : 0.0;
            if (!first) slope[count] = 0.0;
            std::vector<double> down;
            for (const double s : slope) down.push_back(-s);
            const std::vector<double> step = solve_any(bend, down, 1e-40);
            double falls = 0.0;
            for (std::size_t i = 0; i <= count; ++i) falls -= step[i] * slope[i];
            // whether it falls by less than its rounding is not told; a last step ends what converges
            if (falls < std::max(first ? std::max(1e-13 * weight, 0x1p-52 * std::abs(now)) : 1e-13, known)) {
                std::vector<double> next = c;
                for (std::size_t i = 0; i <= count; ++i) next[i] += step[i];
                if (!first && barrier(next, first, nullptr, nullptr).first) c = next;
                return !first;
            }
            double way = 1.0;
            while (true) {
                std::vector<double> next = c;
                for (std::size_t i = 0; i <= count; ++i) next[i] += way * step[i];
                const auto [is_there, value] = barrier(next, first, nullptr, nullptr);
                if (is_there && value <= now - 0.1 * way * falls) {
                    c = next;
                    break;
                }
                way *= 0.5;
                if (way < 1e-12) return !first;
            }
        }
        return !first;
    };
    double lack = 0.0;
    for (const Cone& cone : all) {
        const auto f = static_cast<std::size_t>(cone.first);
        const double across = cone.is_line ? 0.0 : std::hypot(z0[f + 1], z0[f + 2]) / size;
        lack = std::max(lack, (std::isfinite(cone.mu) && cone.mu > 0.0 ? across / cone.mu : 0.0) - z0[f] / size);
    }
    c[count] = lack + 1.0;
    while (!descend(true)) {
        if ((weight *= 0.1) >= 1e-14) continue;
        if (nearest != nullptr)
            for (std::size_t i = 0; i < count; ++i) (*nearest)[i] = c[i] * size;
        return {};
    }
    c[count] = 0.0;
    weight = 0.1;
    if (!descend(false)) return {};
    std::vector<double> result;
    for (std::size_t i = 0; i < count; ++i) result.push_back(c[i] * size);
    // those that rounding cannot tell from their edges are not inside
    const auto rounding_of = [&](std::size_t row) {
        double sum = std::abs(z0[row]) / size;
        for (std::size_t i = 0; i < count; ++i) sum += std::abs(c[i] * directions[i][row]);
        return 0x1p-51 * sum;
    };
    for (const Cone& cone : all) {
        const auto f = static_cast<std::size_t>(cone.first);
        const double normal = value_of(c, f), known = rounding_of(f);
        if (!(normal > known)) return {};
        if (cone.is_line || !std::isfinite(cone.mu)) continue;
        const double across = std::hypot(value_of(c, f + 1), value_of(c, f + 2));
        if (!(cone.mu * normal - across > cone.mu * known + rounding_of(f + 1) + rounding_of(f + 2))) return {};
    }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
