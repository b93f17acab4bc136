// Inertia of bodies that move together, and the wrenches it takes to move them, at one point.
//
// With twists (omega', a_P) and wrenches (moment about P, force), world axes, an inertia is the symmetric matrix
//     | A   B |     moment = A omega' + B a_P
//     | B^T D |     force  = B^T omega' + D a_P
// of a body with c = G - P: A = I_G + m (|c|^2 1 - c c^T), B = m [c], D = m 1, [c] v = c x v. Seen from P' with
// r = P - P':  B' = B + [r] D,  A' = A - B [r] + [r] B'^T.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/mechanics/moving.hpp"
#include "rbdyn/model/rigid_state.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

/// What a wrench does on a twist.
template <class S>
S power(const Twist<S>& twist, const Wrench<S>& wrench) {
    return dot<S>(twist.turn, wrench.moment) + dot<S>(twist.move, wrench.force);
}

/// The same wrench about another point, r from it to the one it was about.
template <class S>
Wrench<S> about(const Wrench<S>& w, const Vector3Of<S>& r) {
    Wrench<S> result;
    result.force = w.force;
    result.moment = w.moment + cross<S>(r, w.force);
    return result;
}
template <class S>
void add(Wrench<S>& to, const Wrench<S>& w, const S& times) {
    to.force += Vector3Of<S>(w.force * times);
    to.moment += Vector3Of<S>(w.moment * times);
}

template <class S>
bool is_nothing(const S& x) {
    if constexpr (std::is_same_v<S, Expression>)
        return x.is_zero();
    else
        return x == S(0.0);
}
template <class S>
class SixInertia {
public:
    using Block = std::array<std::array<S, 3>, 3>;

    SixInertia() {
        for (Block* block : {&a_, &b_, &d_})
            for (auto& row : *block) row = {S(0.0), S(0.0), S(0.0)};
    }
    /// Of a body: c = G - P, its central inertia in world axes. `square`: m |c|^2.
    SixInertia(const S& mass, const Vector3Of<S>& c, const Block& central, const S& square) : SixInertia() {
        const Vector3Of<S> mc = c * mass;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = i; j < 3; ++j)
                a_[i][j] = central[i][j] + ((i == j ? square : S(0.0)) - c[at(i)] * mc[at(j)]);
        b_[0][1] = -mc[2];
        b_[0][2] = mc[1];
        b_[1][0] = mc[2];
        b_[1][2] = -mc[0];
        b_[2][0] = -mc[1];
        b_[2][1] = mc[0];
        for (std::size_t i = 0; i < 3; ++i) d_[i][i] = mass;
    }

    Wrench<S> operator*(const Twist<S>& x) const {
        Wrench<S> w;
        for (std::size_t i = 0; i < 3; ++i) {
            S moment(0.0), force(0.0);
            for (std::size_t j = 0; j < 3; ++j) {
                moment += a(i, j) * x.turn[at(j)] + b_[i][j] * x.move[at(j)];
                force += b_[j][i] * x.turn[at(j)] + d(i, j) * x.move[at(j)];
            }
            w.moment[at(i)] = moment;
            w.force[at(i)] = force;
        }
        return w;
    }

    SixInertia& operator+=(const SixInertia& other) {
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) {
                b_[i][j] += other.b_[i][j];
                if (j < i) continue;
                a_[i][j] += other.a_[i][j];
                d_[i][j] += other.d_[i][j];
            }
        return *this;
    }

    /// What is left of it where a motion is free that takes the wrench u for a unit rate: - u u^T / (its power).
    /// `scaled`: u over that power.
    void release(const Wrench<S>& u, const Wrench<S>& scaled) {
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) {
                b_[i][j] -= u.moment[at(i)] * scaled.force[at(j)];
                if (j < i) continue;
                a_[i][j] -= u.moment[at(i)] * scaled.moment[at(j)];
                d_[i][j] -= u.force[at(i)] * scaled.force[at(j)];
            }
    }

    /// The same where the motion is a turn about one of the axes it is given in, or a slide along one: what is left
    /// meets nothing along that, to the last digit.
    void release(const Wrench<S>& u, const Wrench<S>& scaled, const Twist<S>& motion) {
        release(u, scaled);
        const int turn = only_one(motion.turn), move = only_one(motion.move);
        for (std::size_t j = 0; j < 3; ++j) {
            if (turn >= 0 && move == nothing) {
                const auto i = static_cast<std::size_t>(turn);
                a_[std::min(i, j)][std::max(i, j)] = b_[i][j] = S(0.0);
            } else if (move >= 0 && turn == nothing) {
                const auto i = static_cast<std::size_t>(move);
                d_[std::min(i, j)][std::max(i, j)] = b_[j][i] = S(0.0);
            }
        }
    }

    /// About another point, r from it to this one.
    SixInertia about(const Vector3Of<S>& r) const {
        SixInertia result;
        result.d_ = d_;
        const auto crossed = [&](std::size_t i, const auto& column) {  // row i of [r] times a column
            const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
            return r[at(j)] * column(k) - r[at(k)] * column(j);
        };
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
                result.b_[i][j] = b_[i][j] + crossed(i, [&](std::size_t k) { return d(k, j); });
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = i; j < 3; ++j) {
                // (B [r])_ij = -([r] B^T)_ji
                const S back = crossed(j, [&](std::size_t k) { return b_[i][k]; });
                result.a_[i][j] = a_[i][j] + (back + crossed(i, [&](std::size_t k) { return result.b_[j][k]; }));
            }
        return result;
    }

private:
    static constexpr int nothing = -1, several = -2;
    /// Of a vector the only component that is not zero.
    static int only_one(const Vector3Of<S>& v) {
        int found = nothing;
        for (int k = 0; k < 3; ++k)
            if (!is_nothing(v[k])) found = found == nothing ? k : several;
        return found;
    }

    static Eigen::Index at(std::size_t i) { return static_cast<Eigen::Index>(i); }
    const S& a(std::size_t i, std::size_t j) const { return i <= j ? a_[i][j] : a_[j][i]; }
    const S& d(std::size_t i, std::size_t j) const { return i <= j ? d_[i][j] : d_[j][i]; }

    Block a_, b_, d_;  // of the symmetric ones the upper half
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
