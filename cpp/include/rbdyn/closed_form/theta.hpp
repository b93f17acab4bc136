// Quotients of theta functions along the real axis, the building blocks of closed forms in elliptic functions:
//
//   first:   theta_1(x - i s) / theta_4(x),    second:   theta_2(x - i s) / theta_4(x),    x = pi v/(2 K), s = pi w/(2
//   K),
//
// each times a constant and e^{i mu v}, each regular for all real v (Whittaker and Watson, ch. 21; DLMF 20.2, 20.7).
// Their moduli vanish, if at all, where v = i w and v = K + i w.
//
// Two forms of the series, so that the nome is at most e^-pi and four terms give 16 digits:
// * circular, k^2 <= 1/2: in sines and cosines of x with q = exp(-pi K'/K);
// * hyperbolic, k^2 > 1/2: after Jacobi's imaginary transformation, in hyperbolic functions of y = pi v/(2 K') with
//   q = exp(-pi K/K'); the factor e^{i v w pi/(2 K K')} that it leaves is kept apart as rates. At k = 1 the period is
//   infinite, q = 0, and the quotients are those of tanh and sech.
//
// Set-up keeps 31 digits; a value costs one sine and cosine, or one exponential, in doubles.
#pragma once

#include <complex>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// The theta functions of one modulus.
class Theta {
public:
    static constexpr int terms = 4;

    /// Terms of the series at one place: of the first quotient's real and imaginary part, then of the second's.
    struct Waves {
        double first_real[terms], first_imaginary[terms], second_real[terms], second_imaginary[terms];
        double denominator;
    };

    /// A quotient: weights of the terms. Its phase grows by `twist` times the reduced place, and per unit of v by
    /// `drift` more than that of a motion which knows its rate at its turning point (see first and second).
    struct Quotient {
        double real[terms] = {}, imaginary[terms] = {};
        double twist = 0.0;
        DoubleDouble drift = 0.0;
    };

    Theta() = default;
    /// From k^2 and 1 - k^2, each with all its digits.
    Theta(const DoubleDouble& m, const DoubleDouble& complement);

    /// z = scale v is x of the circular form or y of the hyperbolic one, to be reduced by whole periods, 2 K in v; each
    /// turns the sign of both quotients. K in v.
    const DoubleDouble& scale() const { return scale_; }
    const DoubleDouble& period() const { return period_; }
    const DoubleDouble& quarter() const { return quarter_; }

    Waves waves(double z) const { return hyperbolic_ ? hyperbolic_waves(z) : circular_waves(z); }

    static std::complex<double> first(const Quotient& f, const Waves& at);
    static std::complex<double> second(const Quotient& f, const Waves& at);

    /// The quotients with a zero at v = i w and at v = K + i w, |w| <= K'. If the phase of the motion they describe
    /// grows by the rate r per unit of v at v = K, respectively at v = 0, where the modulus is stationary, then
    /// mu = r + drift.
    Quotient quotient_first(const DoubleDouble& w) const;
    Quotient quotient_second(const DoubleDouble& w) const;

    /// Derivatives by z of a quotient's sums, twist included, at a reduced place (for set-up).
    std::complex<double> slope_first(const Quotient& f, double z) const;
    std::complex<double> slope_second(const Quotient& f, double z) const;

private:
    static DoubleDouble infinite_if_zero(const DoubleDouble& mean);

    static std::complex<double> sums(const Quotient& f, const double* a, const double* b);

    static std::complex<double> slope(const Quotient& f, std::complex<double> value, std::complex<double> rise,
                                      double denominator, double denominator_rise);

    Waves circular_waves(double x) const;

    // all times 2 e^-|y|, which cancels
    Waves hyperbolic_waves(double y) const;

    // derivatives of the waves: each term's partner times its frequency
    Waves slopes(double z, const Waves& at) const;

    /// Weights q^{n(n+1)} cosh((2n+1)s)/cosh(s) and the same with sinh; alternating signs for the first quotient.
    Quotient circular(const DoubleDouble& w, double alternation) const;

    /// Weights cos(n w) and sin(n w) with alternating signs, n odd for the first quotient and even for the second; the
    /// drift is -scale times the logarithmic derivative of theta_4 at w, and what the transformation leaves.
    Quotient hyperbolic(const DoubleDouble& w, bool odd) const;

    // q^36 is below 1e-49 and q^25 below 1e-34 for q <= e^-pi
    static constexpr int set_up_terms = 5;

    bool hyperbolic_ = false;
    DoubleDouble quarter_, co_quarter_, scale_, period_, nome_;
    double square_[terms] = {}, below_square_[terms] = {};  // q^{n^2}, q^{n(n-1)}
};

}  // namespace rbdyn::inline RBDYN_FORM
