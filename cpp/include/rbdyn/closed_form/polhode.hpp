// The angular velocity of a free body in principal axes: constants of its motion, with all 32 digits.
//
// The axes are ordered and directed so that K circles axis 3, the intermediate moment is I2, omega_1 >= 0, omega_3 > 0
// and the three are right-handed. With s = sign(I3 - I2), E the energy and K the angular momentum (7.48, M = 0):
//   omega = (alpha cn u, s beta sn u, gamma dn u),  u = mu t + u0,
//   alpha^2 = w1^2 + I2 (I3-I2) / (I1 (I3-I1)) w2^2,  gamma^2 = w3^2 + I2 (I2-I1) / (I3 (I3-I1)) w2^2,
//   m = I1 (I2-I1) alpha^2 / (I3 (I3-I2) gamma^2),     1-m = |D| / (I3 |I3-I2| gamma^2).
// These are sums of positive terms but for D = A (B-A) wA^2 - C (C-B) wC^2 = 2E B - K^2, A < B < C the moments, whose
// sign tells which axis K circles and whose zero is the separatrix, m = 1.
//
// Source: Landau and Lifshitz, Mechanics, 37; Whittaker, Analytical Dynamics, 69.
#pragma once

#include <array>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct Polhode {
    std::array<int, 3> axis;       // which of the given axes are 1, 2, 3
    std::array<bool, 3> reversed;  // and whether they point the other way
    DoubleDouble i1, i2, i3;       // moments
    double sign;                   // of I3 - I2
    DoubleDouble alpha, beta, gamma, mu, u0;
    DoubleDouble m, m1;                // the parameter, and 1 - m
    DoubleDouble quarter, quarter1;    // K(m), K(1-m)
    DoubleDouble momentum, momentum1;  // |K|, I1 alpha
    DoubleDouble momentum3;            // I3 gamma
    DoubleDouble energy2;              // 2E
    double difference;                 // |D|

    /// Whether omega stays as it is: parallel to a principal axis (7.55, Def. 7.3).
    static bool constant(const Vector3Of<DoubleDouble>& moments, const Vector3Of<DoubleDouble>& omega);

    /// Of an angular velocity that is not constant, in principal axes.
    [[gnu::cold]] Polhode(const Vector3Of<DoubleDouble>& moments, const Vector3Of<DoubleDouble>& omega);
};

}  // namespace rbdyn::inline RBDYN_FORM
