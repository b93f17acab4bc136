// What loads that change in time do to bodies that are held where they are.
//
// Held at rest, bodies are moved by what acts along a fixed map: v' = A Q(t). Where Q is a sum of functions of time,
// each along a direction of its own, Q = sum f_k(t) d_k, nothing moves at any time if A d_k = 0 for all of them,
// whatever these functions are: no series, and no sample of times, has to be long enough for it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/mechanics/accelerate.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/constraint.hpp"
#include "rbdyn/mechanics/tree.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics::resting {

/// A recorded number as a sum of nodes with constant factors, no sums or multiples themselves; its constant part is
/// left out.
inline std::vector<std::pair<std::int32_t, double>> linear_parts(const Recorder& r, const Expression& whole) {
    std::vector<std::pair<std::int32_t, double>> parts;
    if (whole.is_constant()) return parts;
    std::vector<double> factors(static_cast<std::size_t>(whole.node()) + 1, 0.0);
    factors.back() = 1.0;
    const auto is_constant = [&](std::int32_t i) { return r.node(i).operation == Operation::constant; };
    // operands come before what is made of them
    for (std::int32_t i = whole.node(); i >= 0; --i) {
        const double factor = factors[static_cast<std::size_t>(i)];
        const auto& n = r.node(i);
        if (factor == 0.0 || n.operation == Operation::constant) continue;
        const auto pass = [&](std::int32_t to, double by) { factors[static_cast<std::size_t>(to)] += factor * by; };
        if (n.operation == Operation::add) {
            pass(n.a, 1.0);
            pass(n.b, 1.0);
        } else if (n.operation == Operation::multiply && is_constant(n.a)) {
            pass(n.b, r.node(n.a).value);
        } else if (n.operation == Operation::multiply && is_constant(n.b)) {
            pass(n.a, r.node(n.b).value);
        } else if (n.operation == Operation::divide && is_constant(n.b)) {
            pass(n.a, 1.0 / r.node(n.b).value);
        } else {
            parts.emplace_back(i, factor);
        }
    }
    return parts;
}

/// A tree at rest whose rows hold it.
class Reactions {
public:
    Reactions(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows,
              const std::vector<Moving<double>>& all)
        : accelerate_(accelerate<double>(tree, all)) {
        const auto every = conditions.rows<double>(tree, all);
        for (const Moving<double>& m : all) first_.push_back(first_.back() + static_cast<int>(m.joint.size()));
        for (const int r : rows) responses_.push_back(accelerate_.response(every[static_cast<std::size_t>(r)]));
    }

    /// Whether what acts moves nothing but for rounding: of each body force and moment about P, world axes; behind them
    /// what acts along each velocity of a joint.
    bool hold(const std::vector<double>& acts) const {
        const auto count = static_cast<std::size_t>(accelerate_.count());
        std::vector<Wrench<double>> left(count);
        for (std::size_t i = 0; i < count; ++i)
            for (int k = 0; k < 3; ++k) {
                left[i].force[k] = -acts[6 * i + static_cast<std::size_t>(k)];
                left[i].moment[k] = -acts[6 * i + 3 + static_cast<std::size_t>(k)];
            }
        std::vector<double> u = accelerate_.driven(
            std::move(left), std::vector<double>(acts.begin() + static_cast<std::ptrdiff_t>(6 * count), acts.end()));
        std::vector<double> sizes(u.size());
        std::transform(u.begin(), u.end(), sizes.begin(), [](double one) { return std::abs(one); });
        react(u, sizes);
        // what turns a body is a difference of moments: their rounding is known by all that moves it
        const auto is_rounding = [&](int first, int end) {
            double left_over = 0.0, size = 0.0;
            for (int n = first; n < end; ++n) {
                if (!(accelerate_.mass(n) > 0.0)) continue;
                const auto k = static_cast<std::size_t>(n);
                left_over += u[k] * u[k] / accelerate_.mass(n);
                size += sizes[k] * sizes[k] / accelerate_.mass(n);
            }
            return std::sqrt(left_over) <= 64.0 * std::numeric_limits<double>::epsilon() * std::sqrt(size);
        };
        for (std::size_t i = 0; i < count; ++i)
            if (!is_rounding(first_[i], first_[i + 1])) return false;
        return true;
    }

    /// Whether the rows leave one velocity of a body's joint nothing that it could be.
    bool determine(int body, int k) const {
        std::vector<double> u(static_cast<std::size_t>(accelerate_.freedoms()), 0.0), sizes(u.size(), 0.0);
        for (const auto& [n, one] : accelerate_.driving(body, k)) u[static_cast<std::size_t>(n)] = one;
        const double whole = energy(u);
        react(u, sizes);
        return energy(u) <= 1e-26 * whole;
    }

private:
    double energy(const std::vector<double>& u) const {
        double sum = 0.0;
        for (std::size_t n = 0; n < u.size(); ++n)
            if (const double mass = accelerate_.mass(static_cast<int>(n)); mass > 0.0) sum += u[n] * u[n] / mass;
        return sum;
    }

    /// Adds to what drives each velocity what the rows make of it, and to its size.
    void react(std::vector<double>& u, std::vector<double>& sizes) const {
        std::vector<std::vector<double>> a(responses_.size(), std::vector<double>(responses_.size()));
        for (std::size_t i = 0; i < responses_.size(); ++i)
            for (std::size_t j = 0; j <= i; ++j) a[i][j] = accelerate_.between(responses_[i], responses_[j]);
        // what a first solution leaves is rounding of the whole, what a second one leaves is rounding of that
        for (int pass = 0; pass < 2; ++pass) {
            std::vector<double> b;
            for (const auto& response : responses_) b.push_back(-accelerate_.along(response, u));
            const std::vector<double> forces = solve_definite<double>(a, std::move(b));
            for (std::size_t i = 0; i < responses_.size(); ++i)
                for (const auto& [n, one] : responses_[i]) {
                    u[static_cast<std::size_t>(n)] += one * forces[i];
                    sizes[static_cast<std::size_t>(n)] += std::abs(one * forces[i]);
                }
        }
    }

    Accelerate<double> accelerate_;
    std::vector<Accelerate<double>::Sparse> responses_;
    std::vector<int> first_{0};  // velocity of each body, and the end
};

}  // namespace rbdyn::inline RBDYN_FORM::mechanics::resting
