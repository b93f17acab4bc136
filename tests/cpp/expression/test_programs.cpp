// Recorded functions: the same numbers as the functions themselves, exact derivatives, exact series, nothing left over.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/expression/evaluate.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/plan/kept_plan.hpp"
#include "rbdyn/special/special_model.hpp"

namespace rbdyn::test_programs {
namespace {

double uniform(double lo, double hi) {
    static std::uint64_t state = 1;
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return lo + (hi - lo) * static_cast<double>(state >> 11) * 0x1p-53;
}

/// Functions of three positive variables, written once over the number type.
struct Everything {
    static constexpr int outputs = 21;

    template <class S>
    static std::vector<S> of(const std::vector<S>& x) {
        using std::asinh, std::atanh, std::cos, std::exp, std::expm1, std::log, std::log1p, std::pow, std::sin,
            std::sqrt, std::tan, std::tanh, std::abs;
        const S &a = x[0], &b = x[1], &c = x[2];
        return {a + b - c,
                2.0 * a * b + 3.0 * (b * c) - a * a + 1.0,
                (a + b) / (c + 1.0) - 1.0 / a,
                sqrt(a * a + b * b),
                sin(a) * cos(b) + cos(a) * sin(b),
                tan(0.3 * a),
                exp(-a * b) + log(a + c),
                tanh(a - b),
                pow(a, 3.0) + pow(b, -2.0),
                pow(a + b, 1.5) - pow(c, -0.75),
                pow(a, 0.5),
                pow(a, S(b)),
                abs(a - 2.0 * c),
                (a - b) * (a + b) * (c - a) * (b - c),
                ((a + b) * c + (a + b)) / sqrt(c + a * b),
                S(3.5),
                expm1(a - b),
                log1p(a * b),
                asinh(a - 2.0 * b),
                atanh(0.3 * c),
                pow(S(2.0), S(b - c))};
    }
};

/// Everything as a program; signs of its switches set for a point.
template <class T>
void point_signs(const Program& program, Evaluator<T>& evaluator, std::span<const T> x) {
    std::vector<T> parameters(static_cast<std::size_t>(program.parameters()), T(1));
    evaluator.set_parameters(parameters);
    evaluator(T(0), x);
    for (std::size_t k = 0; k < program.switches().size(); ++k)
        if (!program.switches()[k].is_norm)
            parameters[static_cast<std::size_t>(program.switches()[k].parameter)] =
                evaluator.switch_value(static_cast<int>(k)) < T(0) ? T(-1) : T(1);
    evaluator.set_parameters(parameters);
}

Program everything() {
    Recorder recorder;
    const std::vector<Expression> outputs =
        Everything::of<Expression>({recorder.input(0), recorder.input(1), recorder.input(2)});
    return Program(recorder, outputs, 3);
}

TEST(Programs, give_the_numbers_of_the_function_they_were_recorded_from) {
    const Program program = everything();
    const Function function = Function::record(3, [](const std::vector<Expression>& x) { return Everything::of(x); });
    ASSERT_EQ(program.outputs(), Everything::outputs);
    ASSERT_EQ(function.outputs(), Everything::outputs);
    Evaluator<double> evaluator(program);
    Evaluator<long double> precise(program);
    for (int trial = 0; trial < 200; ++trial) {
        const std::vector<double> x{uniform(0.1, 3.0), uniform(0.1, 3.0), uniform(0.1, 3.0)};
        const std::vector<long double> z(x.begin(), x.end());
        point_signs<double>(program, evaluator, x);
        evaluator(0.0, x);
        point_signs<long double>(program, precise, z);
        precise(0.0L, z);
        const std::vector<double> direct = Everything::of(x), again = function(std::span<const double>(x));
        const std::vector<long double> exact = Everything::of(z);
        for (int k = 0; k < Everything::outputs; ++k) {
            const auto i = static_cast<std::size_t>(k);
            // sums are gathered in another order; terms here are below 1e3
            const double tolerance = 1e-13 * (1.0 + std::abs(direct[i]));
            EXPECT_NEAR(evaluator.output(k), direct[i], tolerance) << k;
            EXPECT_NEAR(again[i], direct[i], tolerance) << k;
            EXPECT_NEAR(static_cast<double>(precise.output(k) - exact[i]), 0.0, 1e-16 * (1.0 + std::abs(direct[i])))
                << k;
        }
    }
}

/// d f_k / d x_i by differences in long double, Richardson's to fourth order.
template <class F>
long double difference(F&& f, std::vector<long double> x, std::size_t i) {
    const auto central = [&](long double h) {
        std::vector<long double> lo = x, hi = x;
        lo[i] -= h;
        hi[i] += h;
        return (f(hi) - f(lo)) / (2 * h);
    };
    const long double h = 1e-4L;
    return (4 * central(h / 2) - central(h)) / 3;
}

TEST(Programs, have_the_jacobian_that_differences_approach) {
    const Program program = everything();
    JacobianEvaluator jacobian(program);
    for (int trial = 0; trial < 50; ++trial) {
        const std::vector<double> x{uniform(0.3, 2.0), uniform(0.3, 2.0), uniform(0.3, 2.0)};
        point_signs<double>(program, jacobian, x);
        jacobian.differentiate(0.0, x);
        for (int k = 0; k < Everything::outputs; ++k) {
            if (k == 12 && std::abs(x[0] - 2.0 * x[2]) < 1e-3) continue;  // |a - 2 c| at its corner
            for (std::size_t i = 0; i < 3; ++i) {
                const auto f = [&](const std::vector<long double>& z) {
                    return Everything::of(z)[static_cast<std::size_t>(k)];
                };
                const double expected = static_cast<double>(difference(f, {x.begin(), x.end()}, i));
                EXPECT_NEAR(jacobian.derivative(k, static_cast<int>(i)), expected, 1e-10 * (1.0 + std::abs(expected)))
                    << "output " << k << ", variable " << i;
            }
        }
    }
}

TEST(Functions, have_derivatives_that_are_functions_again) {
    const Function f = Function::record(3, [](const std::vector<Expression>& x) { return Everything::of(x); });
    for (int input = 0; input < 3; ++input) {
        const Function derivative = f.derivative(input);
        for (int trial = 0; trial < 20; ++trial) {
            const std::vector<double> x{uniform(0.3, 2.0), uniform(0.3, 2.0), uniform(0.3, 2.0)};
            if (std::abs(x[0] - 2.0 * x[2]) < 1e-3) continue;
            const std::vector<double> found = derivative(std::span<const double>(x));
            for (std::size_t k = 0; k < found.size(); ++k) {
                const auto g = [&](const std::vector<long double>& z) { return Everything::of(z)[k]; };
                const double expected =
                    static_cast<double>(difference(g, {x.begin(), x.end()}, static_cast<std::size_t>(input)));
                EXPECT_NEAR(found[k], expected, 1e-10 * (1.0 + std::abs(expected)))
                    << "result " << k << ", input " << input;
            }
        }
    }
    EXPECT_TRUE(f.depends_on(0));
    const Function one =
        Function::record(2, [](const std::vector<Expression>& x) { return std::vector<Expression>{sin(x[1])}; });
    EXPECT_FALSE(one.depends_on(0));
    EXPECT_TRUE(one.depends_on(1));
    // a second derivative: sin'' = -sin
    const double at[2] = {0.0, 0.7};
    EXPECT_NEAR(one.derivative(1).derivative(1)(std::span<const double>(at))[0], -std::sin(0.7), 1e-15);
}

TEST(Functions, of_time_know_their_rate) {
    const TimeFunction shaking([](const auto& t) { return 0.5 * sin(3.0 * t) + t * t; });
    EXPECT_FALSE(shaking.is_constant());
    EXPECT_NEAR(shaking(0.4), 0.5 * std::sin(1.2) + 0.16, 1e-15);
    EXPECT_NEAR(shaking.rate(0.4), 1.5 * std::cos(1.2) + 0.8, 1e-15);
    EXPECT_TRUE(TimeFunction([](const auto& t) { return 0.0 * t + 2.0; }).is_constant());
    EXPECT_EQ(TimeFunction(2.0).rate(1.0), 0.0);
}

// --- series ---

/// Coefficients of f along x_i(t) = point_i + direction_i t; `parameter`: the value of all its parameters.
std::vector<double> series_of(const std::function<Expression(Recorder&, const std::vector<Expression>&)>& f,
                              const std::vector<double>& point, const std::vector<double>& direction, int order,
                              double parameter = 0.0) {
    Recorder recorder;
    std::vector<Expression> x;
    for (int i = 0; i < static_cast<int>(point.size()); ++i) x.push_back(recorder.input(i));
    const Expression outputs[] = {f(recorder, x)};
    const Program program(recorder, outputs, static_cast<int>(point.size()));
    SeriesEvaluator series(program, order);
    std::vector<double> parameters(static_cast<std::size_t>(program.parameters()), parameter);
    series.set_parameters(parameters);
    series.begin(0.0, 1.0);
    for (int k = 0; k <= order; ++k) {
        for (std::size_t i = 0; i < point.size(); ++i)
            series.set_input(static_cast<int>(i), k, k == 0 ? point[i] : k == 1 ? direction[i] : 0.0);
        series.advance(k);
    }
    return {series.output(0), series.output(0) + order + 1};
}

TEST(Series, of_elementary_functions_have_the_coefficients_of_their_closed_forms) {
    constexpr int order = 24;
    const double a = 0.7, w = 1.3;
    const auto one = [&](auto f) {
        return series_of([f](Recorder&, const std::vector<Expression>& x) { return Expression(f(x[0])); }, {a}, {w},
                         order);
    };
    const auto sine = one([](const Expression&x) { return sin(x); }),
               cosine = one([](const Expression&x) { return cos(x); });
    const auto exponential = one([](const Expression&x) { return exp(x); }),
               logarithm = one([](const Expression&x) { return log(x); });
    const auto root = one([](const Expression&x) { return sqrt(x); }),
               power = one([](const Expression&x) { return pow(x, 1.7); });
    const auto inverse = one([](const Expression&x) { return 1.0 / x; }),
               cube = one([](const Expression&x) { return pow(x, 3.0); });
    const auto minus_fifth = one([](const Expression& x) { return pow(x, -5.0); });
    const auto pythagoras = one([](const Expression& x) { return sin(x) * sin(x) + cos(x) * cos(x); });
    long double factor = 1, ratio = 1, half = 1, exponent = 1, fifth = 1;  // w^k/k!, (w/a)^k, binomials times it
    const double pi_2 = 1.57079632679489661923;
    const double floor = 1e-300;
    for (int k = 0; k <= order; ++k) {
        const auto i = static_cast<std::size_t>(k);
        // each step of a recurrence may add a rounding
        const double rounding = 1e-15 * (k + 1);
        const double f = static_cast<double>(factor), r = static_cast<double>(ratio);
        EXPECT_NEAR(sine[i], f * std::sin(a + k * pi_2), rounding * f) << k;
        EXPECT_NEAR(cosine[i], f * std::cos(a + k * pi_2), rounding * f) << k;
        EXPECT_NEAR(exponential[i], f * std::exp(a), rounding * f * 2.1) << k;
        EXPECT_NEAR(logarithm[i], k == 0 ? std::log(a) : -std::pow(-1.0, k) * r / k, rounding * r) << k;
        EXPECT_NEAR(inverse[i], std::pow(-1.0, k) * r / a, rounding * r * 3.0) << k;
        EXPECT_NEAR(root[i], static_cast<double>(half) * std::sqrt(a),
                    rounding * std::abs(static_cast<double>(half)) * 4.0)
            << k;
        EXPECT_NEAR(power[i], static_cast<double>(exponent) * std::pow(a, 1.7),
                    8.0 * rounding * std::abs(static_cast<double>(exponent)))
            << k;
        // 1/x^5: every coefficient is a sum of five products that are together 2^5 times its size
        const double reciprocal = static_cast<double>(fifth) * std::pow(a, -5.0);
        EXPECT_NEAR(minus_fifth[i], reciprocal, 32.0 * 5.0 * rounding * std::abs(reciprocal)) << k;
        EXPECT_NEAR(pythagoras[i], k == 0 ? 1.0 : 0.0,
                    20.0 * rounding * std::pow(2.0 * w, k) / std::tgamma(k + 1.0) + floor)
            << k;
        const double cubes[4] = {a * a * a, 3.0 * a * a * w, 3.0 * a * w * w, w * w * w};
        EXPECT_NEAR(cube[i], k < 4 ? cubes[k] : 0.0, 1e-15 * 4.0) << k;
        factor *= static_cast<long double>(w) / (k + 1);
        ratio *= static_cast<long double>(w) / a;
        half *= (0.5L - k) / (k + 1) * w / a;
        exponent *= (1.7L - k) / (k + 1) * w / a;
        fifth *= (-5.0L - k) / (k + 1) * w / a;
    }
}

TEST(Series, of_inverses_have_all_digits_where_their_argument_is_small_and_where_it_is_large) {
    constexpr int order = 20;
    const double w = 1.3;
    using One = Expression (*)(const Expression&);
    const auto of = [&](One f, double a) {
        return series_of([f](Recorder&, const std::vector<Expression>& x) { return f(x[0]); }, {a}, {w}, order);
    };
    const One log_1p = [](const Expression&x) { return log1p(x); },
              exp_m1 = [](const Expression&x) { return expm1(x); },
              arsinh = [](const Expression&x) { return asinh(x); },
              artanh = [](const Expression&x) { return atanh(x); };
    const auto expect = [](double found, long double known, double roundings) {
        const double size = static_cast<double>(std::abs(known));
        EXPECT_NEAR(found, static_cast<double>(known), 2.3e-16 * roundings * size);
    };
    for (const double a : {1e-300, -1e-17, 3e-9, -1e-4, 0.25, -0.75, 1e3, 1e200, 1e300}) {
        SCOPED_TRACE(a);
        const long double at = static_cast<long double>(a);
        const auto log_of = of(log_1p, a), sine = of(arsinh, a);
        expect(log_of[0], std::log1p(at), 2.0);
        expect(sine[0], std::asinh(at), 2.0);
        expect(sine[1], w / std::hypot(1.0L, at), 3.0);
        long double power = w / (1.0L + at);
        for (int k = 1; k <= order; ++k, power *= -w / (1.0L + at))
            if (std::abs(power) > 1e-290L) expect(log_of[static_cast<std::size_t>(k)], power / k, 2.0 * k + 2.0);
        if (std::abs(a) < 1.0) {
            const auto tangent = of(artanh, a);
            expect(tangent[0], std::atanh(at), 2.0);
            expect(tangent[1], w / ((1.0L - at) * (1.0L + at)), 3.0);
            // half the difference of two geometric series
            long double up = w / (1.0L - at), down = -w / (1.0L + at), rising = 1.0L, falling = 1.0L;
            for (int k = 1; k <= order; ++k) {
                rising *= up;
                falling *= down;
                EXPECT_NEAR(tangent[static_cast<std::size_t>(k)], static_cast<double>((rising - falling) / (2.0L * k)),
                            2e-15 * k * static_cast<double>(std::abs(rising) + std::abs(falling)));
            }
        }
    }
    // x - x^3/6 + 3 x^5/40 - 15 x^7/336
    const auto sine = of(arsinh, 0.0);
    EXPECT_EQ(sine[2], 0.0);
    expect(sine[3], -std::pow(1.3L, 3.0L) / 6.0L, 8.0);
    expect(sine[5], 3.0L * std::pow(1.3L, 5.0L) / 40.0L, 16.0);
    expect(sine[7], -15.0L * std::pow(1.3L, 7.0L) / 336.0L, 24.0);
    for (const double a : {-1600.0, -40.0, -1e-12, 2e-300, 0.5, 600.0}) {
        const auto grown = of(exp_m1, a);
        expect(grown[0], std::expm1(static_cast<long double>(a)), 2.0);
        long double term = std::exp(static_cast<long double>(a));
        for (int k = 1; k <= order && term > 1e-290L; ++k)
            expect(grown[static_cast<std::size_t>(k)], term *= static_cast<long double>(w) / k, 2.0 * k + 2.0);
    }
}

TEST(Programs, have_the_lengths_and_powers_that_doubles_have) {
    Recorder recorder;
    const Expression x = recorder.input(0), y = recorder.input(1);
    const Expression outputs[] = {recorder.norm(x, y, 0.0, "norm"), pow(x, y)};
    const Program program(recorder, outputs, 2);
    Evaluator<double> evaluator(program);
    for (const double size : {1e-300, 1e-170, 1.0, 1e170, 1e300}) {
        evaluator(0.0, std::vector<double>{3.0 * size, -4.0 * size});
        EXPECT_NEAR(evaluator.output(0), 5.0 * size, 1e-15 * 5.0 * size);
    }
    evaluator(0.0, std::vector<double>{0.0, 0.0});
    EXPECT_EQ(evaluator.output(0), 0.0);
    EXPECT_EQ(evaluator.output(1), 1.0);
}

TEST(Series, of_a_norm_may_start_from_the_zero_vector) {
    const auto norm = [](Recorder& r, const std::vector<Expression>& x) { return r.norm(x[0], x[1], x[2], "norm"); };
    // |(3 t, 4 t, 12 t)| = 13 t
    const auto straight = series_of(norm, {0, 0, 0}, {3, 4, 12}, 8);
    for (std::size_t k = 0; k <= 8; ++k) EXPECT_DOUBLE_EQ(straight[k], k == 1 ? 13.0 : 0.0);
    // |(t, t^2, t^3)| = t sqrt(1 + t^2 + t^4)
    const auto bent = series_of(
        [](Recorder& r, const std::vector<Expression>& x) { return r.norm(x[0], x[0] * x[0], pow(x[0], 3.0), "norm"); },
        {0}, {1}, 8);
    const auto root = series_of(
        [](Recorder&, const std::vector<Expression>& x) { return x[0] * sqrt(1.0 + x[0] * x[0] + pow(x[0], 4.0)); },
        {0}, {1}, 8);
    for (std::size_t k = 0; k <= 8; ++k) EXPECT_NEAR(bent[k], root[k], 1e-15) << k;
    // away from zero: |(3 + t, 4, 0)| = sqrt(25 + 6 t + t^2)
    const auto away = series_of(norm, {3, 4, 0}, {1, 0, 0}, 8);
    EXPECT_DOUBLE_EQ(away[0], 5.0);
    EXPECT_NEAR(away[1], 0.6, 1e-15);
    EXPECT_NEAR(away[2], (1.0 - 0.36) / 10.0, 1e-15);
    // a motion that turns at zero, its zero known only to rounding: the flag of the norm says that it is one
    const auto flagged = series_of(norm, {1e-17, 0, -1e-17}, {3, 4, 12}, 8, 1.0);
    for (std::size_t k = 0; k <= 8; ++k) EXPECT_NEAR(flagged[k], k == 1 ? 13.0 : 0.0, 1e-14) << k;
    // a vector that stays zero
    for (double c : series_of(norm, {0, 0, 0}, {0, 0, 0}, 8)) EXPECT_EQ(c, 0.0);
}

TEST(Series, of_time_count_in_the_unit_given) {
    Recorder recorder;
    const Expression outputs[] = {recorder.time() * recorder.time()};
    const Program program(recorder, outputs, 0);
    SeriesEvaluator series(program, 4);
    series.set_parameters({});
    series.begin(3.0, 0.5);
    for (int k = 0; k <= 4; ++k) series.advance(k);
    // (3 + s/2)^2
    const double expected[] = {9.0, 3.0, 0.25, 0.0, 0.0};
    for (int k = 0; k <= 4; ++k) EXPECT_EQ(series.output(0)[k], expected[k]);
}

// --- nothing is left behind ---

int instructions(const Program& program) { return static_cast<int>(program.instructions().size()); }

TEST(Folding, zeros_and_ones_leave_nothing_behind) {
    Recorder r;
    const Expression x = r.input(0);
    EXPECT_TRUE((0.0 * x).is_zero());
    EXPECT_TRUE((x - x).is_zero());
    EXPECT_TRUE((Expression(0.0) / x).is_zero());
    EXPECT_EQ((1.0 * x).node(), x.node());
    EXPECT_EQ((x + 0.0).node(), x.node());
    EXPECT_EQ((x / 1.0).node(), x.node());
    EXPECT_EQ(pow(x, 1.0).node(), x.node());
    EXPECT_EQ(pow(x, 0.0).value(), 1.0);
    EXPECT_TRUE(sin(Expression(0.5)).is_constant());
    // the product of a vector with zeros has only what is there
    const Vector3Of<Expression> a(x, 0.0, 0.0), b(0.0, x, 0.0);
    const Vector3Of<Expression> c = cross(a, b);
    EXPECT_TRUE(c[0].is_zero());
    EXPECT_TRUE(c[1].is_zero());
    EXPECT_EQ(c[2].node(), (x * x).node());
    EXPECT_TRUE(dot(a, b).is_zero());
    const Expression output[] = {dot(a, b) + 0.0 * sin(x) + x};
    EXPECT_EQ(instructions(Program(r, output, 1)), 0);
}

TEST(Folding, equal_expressions_are_computed_once) {
    Recorder r;
    const Expression x = r.input(0), y = r.input(1);
    const Expression outputs[] = {sin(x + y), cos(y + x), sin(y + x) * sin(x + y)};
    // the sum, sine and cosine together, the square
    EXPECT_EQ(instructions(Program(r, outputs, 2)), 3);
}

TEST(Folding, an_expression_of_one_function_is_refused_in_another) {
    Recorder one, other;
    EXPECT_THROW(one.input(0) + other.input(0), Error);
    EXPECT_THROW(one.input(0) * other.input(0), Error);
}

/// The instructions of a scene's program, one a line, without the lines about the whole.
std::string code_of(const Scene& scene) {
    const Plan plan = make_plan(scene);
    const SpecialModel model(scene, plan.view);
    std::vector<double> x = model.start();
    const Program& program = model.begin(0.0, x).equations->program;
    const std::string text = program.text();
    const auto first = text.find('\n') + 1, last = text.find("  output");
    const std::string code = text.substr(first, last - first);
    EXPECT_EQ(std::count(code.begin(), code.end(), '\n'), instructions(program)) << text;
    return code;
}

TEST(Folding, the_hoop_is_a_sine_and_one_weighted_sum) {
    Scene hoop({0, 0, -9.81});
    hoop.add(Particle{0.5}, Rail(Circle{.radius = 0.5, .start = {0, 0, -1}, .toward = {1, 0, 0}}), {.parameter = 1.0});
    const std::string smooth = code_of(hoop);
    EXPECT_EQ(std::count(smooth.begin(), smooth.end(), '\n'), 2) << smooth;
    EXPECT_NE(smooth.find("sincos"), std::string::npos) << smooth;
    // in any plane that holds the field, in any direction
    const Matrix3 turn = Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()).toRotationMatrix();
    Scene turned(turn * Vector3(0, 0, -9.81));
    turned.add(Particle{0.5},
               Rail(Circle{.radius = 0.5, .start = turn * Vector3(0, 0, -1), .toward = turn * Vector3(1, 0, 0)}),
               {.parameter = 1.0});
    EXPECT_EQ(code_of(turned), smooth);
    // effects that are absent cost nothing, those that are there something
    Scene idle = hoop;
    idle.apply(Drag{0.0, 0.0}, {0});
    idle.apply(Force(Vector3(0, 0, 0)), {0});
    EXPECT_EQ(code_of(idle), smooth);
    Scene damped = hoop;
    damped.apply(Drag{.quadratic = 1.0}, {0});
    EXPECT_GT(code_of(damped).size(), smooth.size());
}

TEST(Programs, constants_of_32_digits_are_rounded_once) {
    Recorder recorder;
    const Expression third = DoubleDouble(1.0) / 3.0, x = recorder.input(0);
    // folded with doubles, and gathered into one weight
    const Expression outputs[] = {0.1 * third * (3.0 * x), third * x - x / 3.0, (third + 1.0) * x};
    const Program program(recorder, outputs, 1);
    Evaluator<double> values(program);
    values(0.0, std::vector{1.0});
    EXPECT_EQ(values.output(0), 0.1);
    EXPECT_EQ(values.output(1), 0x1p-54 / 3.0);
    EXPECT_EQ(values.output(2), 4.0 / 3.0);
    Evaluator<long double> wide(program);
    wide(0.0L, std::vector{1.0L});
    EXPECT_LE(std::abs(wide.output(2) - 4.0L / 3.0L), 2e-19L);

    // 4/3 alone is no double: the other one it may become is a unit away, on the side where it is
    std::vector<double> nearest, other;
    program.set_parameters<double>({}, nearest);
    program.set_parameters<double>({}, other, Program::Rounding::other);
    int different = 0;
    for (std::size_t k = 0; k < nearest.size(); ++k)
        if (nearest[k] != other[k]) {
            ++different;
            EXPECT_EQ(std::nextafter(nearest[k], other[k]), other[k]);
        }
    EXPECT_EQ(different, 1);
}

}  // namespace
}  // namespace rbdyn::test_programs
