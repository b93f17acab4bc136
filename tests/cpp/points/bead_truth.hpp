// The motion of one bead by other means, in more digits than doubles have: its law written again from F = m a, not from
// the library; Bulirsch and Stoer's extrapolation of Gragg's midpoint rule (Hairer, Norsett, Wanner, II.9).
//
// r(u) the rail's curve in its own place, moved by R(t), d(t): x = R r + d. Along r', m r'.a = r'.F + r'.Phi; across it
// the rest of m a - F is the rail's. Friction: -mu sign(slip) |Phi across| along r'/|r'|, slip = |r'| w - V(t). Numbers
// are drawn so that none of them, nor what is made of two of them, is a double but by chance.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#ifdef RBDYN_TEST_QUAD
#include <quadmath.h>
#endif

#include "support.hpp"

namespace rbdyn::test::beads {

#ifdef RBDYN_TEST_QUAD
using Real = __float128;
inline Real sine(Real x) { return sinq(x); }
inline Real cosine(Real x) { return cosq(x); }
inline Real root(Real x) { return sqrtq(x); }
inline constexpr double unit_of_truth = 1.9e-34;
#else
using Real = long double;
inline Real sine(Real x) { return std::sin(x); }
inline Real cosine(Real x) { return std::cos(x); }
inline Real root(Real x) { return std::sqrt(x); }
inline constexpr double unit_of_truth = 1.1e-19;
#endif
inline Real size_of(Real x) { return x < 0 ? -x : x; }

struct Vec {
    Real x = 0, y = 0, z = 0;
    Vec() = default;
    Vec(Real a, Real b, Real c) : x(a), y(b), z(c) {}
    explicit Vec(const Vector3& v) : x(v[0]), y(v[1]), z(v[2]) {}
};
inline Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec operator*(Real s, const Vec& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Real dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec cross(const Vec& a, const Vec& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Real norm(const Vec& a) { return root(dot(a, a)); }
inline Vec unit(const Vec& a) { return (1 / norm(a)) * a; }
inline double distance(const Vector3& a, const Vec& b) { return static_cast<double>(norm(Vec(a) - b)); }

/// Place, velocity and reaction of the bead.
struct Seen {
    Vec position, velocity, reaction;
    double effort = 0.0;  // what the reaction is a difference of
};

class Bead {
public:
    enum Shape { line, circle, cycloid, parabola, helix, polynomial, spline, own, shapes };
    enum class End { reached, stuck, rail_end, lost };

    static const char* name(int shape) {
        static const char* names[] = {"line",  "circle",     "cycloid", "parabola",
                                      "helix", "polynomial", "spline",  "function"};
        return names[shape];
    }

    explicit Bead(Random& random) {
        const auto some = [&](double size) {
            return Vector3(random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size));
        };
        shape = static_cast<Shape>(random.whole(0, shapes - 1));
        mass = random.uniform(0.3, 3.0);
        radius = random.logarithmic(0.2, 3.0);
        pitch = random.uniform(0.2, 3.0) * (random.chance(0.5) ? 1.0 : -1.0);
        bend = random.uniform(0.1, 1.0);
        first = random.uniform(0.5, 2.0) * random.direction();
        do second = random.uniform(0.5, 2.0) * random.direction();
        while (first.cross(second).norm() < 0.2);
        center = random.chance(0.5) ? some(1.0) : Vector3::Zero();
        gravity = random.chance(0.1) ? Vector3::Zero() : Vector3(random.uniform(2.0, 10.0) * random.direction());
        for (int k = 0; k < 4; ++k) {
            Vector3 c = some(k < 2 ? 1.0 : 0.3);
            if (k == 1) c += 2.0 * c.normalized();
            coefficients.push_back(c);
        }
        // a spline that does not turn back on itself
        const int count = random.whole(4, 7);
        const Vector3 way = random.uniform(1.0, 2.0) * random.direction();
        for (int k = 0; k < count; ++k) points.push_back(k * way + some(0.6));
        numbers = {random.uniform(0.3, 1.5), random.uniform(0.5, 2.0), random.uniform(0.3, 1.0),
                   random.uniform(0.3, 1.0)};
        if (shape == spline) solve_spline();
        is_rough = random.chance(0.4);
        mu_dynamic = random.uniform(0.05, 0.5);
        mu_static = mu_dynamic * random.uniform(1.0, 1.5);
        if (is_rough && random.chance(0.5)) {
            drive = random.uniform(-2.0, 2.0);
            if (random.chance(0.5)) {
                swing = random.uniform(0.1, 1.0);
                pace = random.uniform(0.5, 3.0);
            }
        }
        if (random.chance(0.3)) linear = random.uniform(0.01, 0.3);
        if (random.chance(0.2)) quadratic = random.uniform(0.01, 0.3);
        if (random.chance(0.3)) {
            stiffness = random.uniform(0.5, 10.0);
            rest = random.chance(0.5) ? random.uniform(0.1, 1.0) : 0.0;
            anchor = some(1.0) + (rest > 0.0 ? Vector3(4.0 * random.direction()) : Vector3(Vector3::Zero()));
        }
        if (random.chance(0.3)) {
            push = some(2.0);
            push_pace = random.uniform(0.3, 3.0);
            push_bend = random.uniform(-0.5, 0.5);
        }
        moves = random.chance(0.3) ? random.whole(1, 2) : 0;
        if (moves != 0) {
            shake = some(0.5);
            shake_pace = random.uniform(0.5, 3.0);
            turning = random.uniform(-2.0, 2.0);
            wobble = random.chance(0.5) ? random.uniform(0.1, 0.5) : 0.0;
            axis = random.uniform(0.5, 2.0) * random.direction();
            through = some(0.5);
        }
        by_length = random.chance(0.4);
        where = shape == spline ? random.uniform(0.2, 0.8) * (count - 1) : random.uniform(-1.5, 1.5);
        if (by_length && shape == spline) where = random.uniform(0.5, 2.0);
        speed = random.uniform(0.3, 4.0) * (random.chance(0.5) ? 1.0 : -1.0);
        if (is_rough && std::abs(speed - drive) < 0.2) speed += speed > drive ? 0.7 : -0.7;
        until = random.logarithmic(0.5, 12.0);
        if (!is_rough && random.chance(0.05)) until = random.uniform(50.0, 300.0);
        if (random.chance(0.15)) come_to_rest_at_top(random);
    }

    /// A circle in a field alone, with just more or less than takes it over its top: what it starts with grows.
    void come_to_rest_at_top(Random& random) {
        shape = circle;
        is_rough = by_length = false;
        drive = swing = linear = quadratic = stiffness = push_pace = 0.0;
        moves = 0;
        const Vector3 x = first.normalized(), y = (second - x * x.dot(second)).normalized();
        const double across = std::hypot(x.dot(gravity), y.dot(gravity)),
                     low = std::atan2(y.dot(gravity), x.dot(gravity));
        where = low + random.uniform(-1.0, 1.0);
        const double excess = std::pow(10.0, -random.uniform(2.0, 9.0)) * (random.chance(0.5) ? 1.0 : -1.0);
        speed = std::sqrt(2.0 * across * radius * (1.0 + std::cos(where - low)) * (1.0 + excess));
        until = random.uniform(3.0, 20.0) * std::sqrt(radius / (across + 0.1));
        if (!(speed > 0.0)) speed = 1.0;
    }

    std::string text() const {
        std::string words = name(shape);
        if (is_rough) words += ", rough";
        if (drive != 0.0) words += swing != 0.0 ? ", driven by turns" : ", driven";
        if (moves != 0) words += moves == 1 ? ", shaken" : ", turned";
        if (linear != 0.0 || quadratic != 0.0) words += ", drag";
        if (stiffness != 0.0) words += rest != 0.0 ? ", spring of a length" : ", spring";
        if (push_pace != 0.0) words += ", pushed";
        return words + (by_length ? ", from a length, until " : ", until ") + rbdyn::text(until);
    }

    BodyHandle add_to(Scene& scene) const {
        scene.set_gravity(gravity);
        const Curve curve = [&]() -> Curve {
            switch (shape) {
                case line: return Line{.direction = first, .point = center};
                case circle: return Circle{.radius = radius, .start = first, .toward = second, .center = center};
                case cycloid: return Cycloid{.radius = radius, .x = first, .y = second, .vertex = center};
                case parabola: return Parabola{.a = bend, .x = first, .y = second, .vertex = center};
                case helix:
                    return Helix{.radius = radius, .pitch = pitch, .start = first, .toward = second, .center = center};
                case polynomial: return Polynomial{.coefficients = coefficients};
                case spline: return Spline{.points = points};
                default: {
                    const auto n = numbers;
                    return Curve([n](const auto& u) {
                        using S = std::decay_t<decltype(u)>;
                        return Vector3Of<S>{u, n[0] * sin(n[1] * u), n[2] * u * cos(n[3] * u)};
                    });
                }
            }
        }();
        RailOptions options;
        if (swing != 0.0) {
            const double V = drive, A = swing, p = pace;
            options.drive = [V, A, p](const auto& t) { return V + A * sin(p * t); };
        } else {
            options.drive = drive;
        }
        if (moves == 1) {
            const Vector3 A = shake;
            const double p = shake_pace;
            options.motion = RigidMotion::translation([A, p](const auto& t) {
                using S = std::decay_t<decltype(t)>;
                const S s = sin(p * t);
                return Vector3Of<S>{A[0] * s, A[1] * s, A[2] * s};
            });
        } else if (moves == 2) {
            const double O = turning, b = wobble, p = shake_pace;
            options.motion =
                RigidMotion::rotation([O, b, p](const auto& t) { return O * t + b * sin(p * t); }, axis, through);
        }
        const std::optional<Coulomb> friction =
            is_rough ? std::optional<Coulomb>({.mu_static = mu_static, .mu_dynamic = mu_dynamic}) : std::nullopt;
        RailStart start;
        (by_length ? start.arc_length : start.parameter) = where;
        start.speed = speed;
        const BodyHandle b = scene.add(Particle{mass}, Rail(curve, friction, options), start);
        if (linear != 0.0 || quadratic != 0.0) scene.apply(Drag{.linear = linear, .quadratic = quadratic}, b);
        if (stiffness != 0.0) scene.connect(Spring{.stiffness = stiffness, .rest_length = rest}, b, anchor);
        if (push_pace != 0.0) {
            const Vector3 A = push;
            const double p = push_pace, k = push_bend;
            scene.apply(Force([A, p, k](const auto& t, const auto& r, const auto& v) {
                            using S = std::decay_t<decltype(t)>;
                            const S s = sin(p * t);
                            return Vector3Of<S>{A[0] * s, A[1] * s - k * r[0], A[2] * s - k * v[1]};
                        }),
                        b);
        }
        return b;
    }

    // --- its motion ---

    /// Begins at time 0. Another first step: other steps, which say how far this is known itself.
    void begin(double first_step = 0.1) {
        t_ = 0;
        u_ = where;
        if (by_length) u_ = parameter_at(Real(where));
        if (shape == spline) stretch_ = static_cast<int>(static_cast<double>(u_));
        step_ = Real(first_step);
        w_ = Real(speed) / norm(curve(u_).first);
        const Real slip = Real(speed) - drive_at(0);
        sign_ = !is_rough ? 0 : slip > 0 ? 1 : -1;
        way_ = speed > 0.0 ? 1 : -1;
        end = End::reached;
        reversals.clear();
    }
    /// Goes on to time t, or to where it ends.
    void advance(double to) {
        while (end == End::reached && t_ < Real(to)) {
            const Real left = Real(to) - t_;
            Real h = left > step_ ? step_ : left;
            State next = {};
            while (!extrapolated({u_, w_}, h, next)) {
                h /= 2;
                if (h < Real(1e-12)) {
                    end = End::lost;
                    return;
                }
            }
            const bool is_last = h == left;
            if (!is_last) step_ = last_column_ < most_columns - 3 ? 2 * h : h;
            // what happens within the step: by halving, and by secants
            const auto level = [&](const State& s, Real t, int what) -> Real {
                if (what == 3) {
                    const bool is_slip = is_rough && drive == 0.0 && swing == 0.0;
                    return quadratic != 0.0 && moves == 0 && !is_slip ? way_ * s[1] : Real(1);
                }
                if (what == 0) return is_rough ? sign_ * (norm(curve(s[0]).first) * s[1] - drive_at(t)) : Real(1);
                if (shape != spline) return 1;
                const Real k = what == 1 ? Real(stretch_ + 1) : Real(stretch_);
                return what == 1 ? k - s[0] : s[0] - k;
            };
            int what = -1;
            Real cut = h;
            State at_cut = next;
            for (int i = 0; i < 4; ++i) {
                if (!(level(at_cut, t_ + cut, i) < 0)) continue;
                Real a = 0, b = cut;
                Real fa = level({u_, w_}, t_, i), fb = level(at_cut, t_ + cut, i), found = cut;
                State s = at_cut;
                for (int k = 0; k < 200; ++k) {
                    Real c = a - fa * (b - a) / (fb - fa);
                    if (k % 3 == 2 || !(c > a && c < b)) c = (a + b) / 2;
                    if (!(c > a && c < b)) break;
                    if (!extrapolated({u_, w_}, c, s)) {
                        end = End::lost;
                        return;
                    }
                    const Real fc = level(s, t_ + c, i);
                    found = c;
                    (fc < 0 ? b : a) = c;
                    (fc < 0 ? fb : fa) = fc;
                    if (size_of(fc) < Real(16 * unit_of_truth) || b - a < Real(4 * unit_of_truth) * (t_ + c)) break;
                }
                cut = found;
                if (!extrapolated({u_, w_}, cut, at_cut)) {
                    end = End::lost;
                    return;
                }
                what = i;
            }
            t_ = is_last && what < 0 ? Real(to) : t_ + cut;
            u_ = at_cut[0];
            w_ = at_cut[1];
            if (what == 0) {
                w_ = drive_at(t_) / norm(curve(u_).first);
                const Held held = holding();
                if (size_of(held.along) <= Real(mu_static) * held.across) {
                    end = End::stuck;
                    margin = static_cast<double>(1 - size_of(held.along) / (Real(mu_static) * held.across));
                } else {
                    sign_ = held.along < 0 ? 1 : -1;
                    if (drive == 0.0 && swing == 0.0) way_ = sign_;
                    reversals.push_back(t_);
                }
            } else if (what == 3) {
                way_ = -way_;
            } else if (what > 0) {
                stretch_ += what == 1 ? 1 : -1;
                u_ = Real(what == 1 ? stretch_ : stretch_ + 1);
                if (stretch_ < 0 || stretch_ > static_cast<int>(points.size()) - 2) end = End::rail_end;
            }
        }
    }
    Real time() const { return t_; }
    Seen seen() const {
        const Kinematics k = kinematics(t_, u_, w_);
        const Vec force = active(t_, w_, k);
        const Real rate = acceleration(t_, u_, w_);
        const Vec a = rate * k.along + k.rest;
        return {k.position, k.velocity, Real(mass) * a - force,
                static_cast<double>(norm(force) + Real(mass) * norm(a))};
    }
    Shape shape;
    double mass, radius, pitch, bend;
    Vector3 first, second, center, gravity;
    std::vector<Vector3> coefficients, points;
    std::array<double, 4> numbers;
    bool is_rough;
    double mu_static, mu_dynamic, drive = 0.0, swing = 0.0, pace = 0.0, linear = 0.0, quadratic = 0.0;
    double stiffness = 0.0, rest = 0.0;
    Vector3 anchor, push, shake, axis, through;
    double push_pace = 0.0, push_bend = 0.0, shake_pace = 0.0, turning = 0.0, wobble = 0.0;
    int moves;  // 0: not, 1: shakes, 2: turns
    bool by_length;
    double where, speed, until;

    End end = End::reached;
    std::vector<Real> reversals;
    double margin = 1.0;  // of the cone where it came to stick

private:
    using State = std::array<Real, 2>;
    struct Point {
        Vec at, first, second;
    };
    struct Kinematics {
        Vec position, velocity;
        Vec along;  // R r'
        Vec rest;   // the acceleration without w' R r'
    };
    struct Held {
        Real along, across;
    };
    static constexpr int most_columns = 11;

    Real drive_at(Real t) const {
        return swing != 0.0 ? Real(drive) + Real(swing) * sine(Real(pace) * t) : Real(drive);
    }

    Point curve(Real u) const {
        const Vec c(center);
        const Vec x = unit(Vec(first));
        const Vec across = Vec(second) - dot(Vec(second), x) * x;
        const Vec y = unit(across);
        const Real R = radius;
        switch (shape) {
            case line: return {c + u * x, x, {}};
            case circle: {
                const Real s = sine(u), k = cosine(u);
                return {c + R * k * x + R * s * y, -R * s * x + R * k * y, -R * k * x - R * s * y};
            }
            case cycloid: {
                const Real s = sine(u), k = cosine(u);
                return {c + R * (u + s) * x + R * (1 - k) * y, R * (1 + k) * x + R * s * y, -R * s * x + R * k * y};
            }
            case parabola: return {c + u * x + Real(bend) * u * u * y, x + 2 * Real(bend) * u * y, 2 * Real(bend) * y};
            case helix: {
                const Real two_pi = 8 * arctangent_of_one();
                const Real s = sine(u), k = cosine(u), h = Real(pitch) / two_pi;
                const Vec z = cross(x, y);
                return {c + R * k * x + R * s * y + h * u * z, -R * s * x + R * k * y + h * z, -R * k * x - R * s * y};
            }
            case polynomial: {
                Point p;
                for (int k = static_cast<int>(coefficients.size()) - 1; k >= 0; --k) {
                    p.second = u * p.second + 2 * p.first;
                    p.first = u * p.first + p.at;
                    p.at = u * p.at + Vec(coefficients[static_cast<std::size_t>(k)]);
                }
                return p;
            }
            case spline: {
                const auto k = static_cast<std::size_t>(
                    stretch_ < 0 ? 0 : std::min<int>(stretch_, static_cast<int>(points.size()) - 2));
                const Real s = u - Real(static_cast<double>(k));
                const Vec p = Vec(points[k]), d = Vec(points[k + 1]) - p, a = slopes_[k], b = slopes_[k + 1];
                const Vec c2 = Real(3) * d - Real(2) * a - b, c3 = a + b - Real(2) * d;
                return {p + s * a + s * s * c2 + s * s * s * c3, a + 2 * s * c2 + 3 * s * s * c3,
                        Real(2) * c2 + 6 * s * c3};
            }
            default: {
                const Real a = numbers[0], b = numbers[1], f = numbers[2], g = numbers[3];
                const Real sb = sine(b * u), kb = cosine(b * u), sg = sine(g * u), kg = cosine(g * u);
                return {{u, a * sb, f * u * kg},
                        {1, a * b * kb, f * kg - f * u * g * sg},
                        {0, -a * b * b * sb, -2 * f * g * sg - f * u * g * g * kg}};
            }
        }
    }
    static Real arctangent_of_one() {
        // Machin: pi/4 = 4 arctan 1/5 - arctan 1/239
        const auto arctangent = [](Real inverse) {
            Real power = 1 / inverse, sum = 0, sign = 1;
            for (int n = 1; n < 160; n += 2) {
                sum += sign * power / n;
                power /= inverse * inverse;
                sign = -sign;
            }
            return sum;
        };
        static const Real value = 4 * arctangent(5) - arctangent(239);
        return value;
    }
    void solve_spline() {
        const std::size_t n = points.size();
        std::vector<std::vector<Real>> a(n, std::vector<Real>(n, 0));
        std::vector<Vec> m(n), d(n);
        for (std::size_t k = 0; k + 1 < n; ++k) d[k] = Vec(points[k + 1]) - Vec(points[k]);
        for (std::size_t k = 1; k + 1 < n; ++k) {
            a[k][k - 1] = a[k][k + 1] = 1;
            a[k][k] = 4;
            m[k] = Real(3) * (d[k - 1] + d[k]);
        }
        a[0][0] = 1;
        a[0][2] = -1;
        m[0] = Real(2) * (d[0] - d[1]);
        a[n - 1][n - 3] = 1;
        a[n - 1][n - 1] = -1;
        m[n - 1] = Real(2) * (d[n - 3] - d[n - 2]);
        for (std::size_t k = 0; k < n; ++k) {
            std::size_t pivot = k;
            for (std::size_t i = k + 1; i < n; ++i)
                if (size_of(a[i][k]) > size_of(a[pivot][k])) pivot = i;
            std::swap(a[k], a[pivot]);
            std::swap(m[k], m[pivot]);
            for (std::size_t i = 0; i < n; ++i) {
                if (i == k || a[i][k] == 0) continue;
                const Real f = a[i][k] / a[k][k];
                for (std::size_t j = k; j < n; ++j) a[i][j] -= f * a[k][j];
                m[i] = m[i] - f * m[k];
            }
        }
        for (std::size_t k = 0; k < n; ++k) m[k] = (1 / a[k][k]) * m[k];
        slopes_ = m;
    }

    /// The parameter a length from where lengths count: Simpson's rule refined by Romberg, Newton's steps.
    Real parameter_at(Real length) {
        const auto length_to = [&](Real to) {
            Real sum = 0;
            Real from = 0;
            const auto part = [&](Real lo, Real hi) {
                std::array<Real, 14> row{};
                Real best = 0;
                const auto f = [&](Real u) { return norm(curve(u).first); };
                Real trapezoid = (hi - lo) / 2 * (f(lo) + f(hi));
                row[0] = trapezoid;
                for (int k = 1; k < 12; ++k) {
                    const int count = 1 << (k - 1);
                    const Real h = (hi - lo) / (2 * count);
                    Real middle = 0;
                    for (int i = 0; i < count; ++i) middle += f(lo + (2 * i + 1) * h);
                    trapezoid = trapezoid / 2 + h * middle;
                    Real now = trapezoid, factor = 4;
                    for (int j = 1; j <= k; ++j) {
                        const Real next = now + (now - row[static_cast<std::size_t>(j - 1)]) / (factor - 1);
                        row[static_cast<std::size_t>(j - 1)] = now;
                        now = next;
                        factor *= 4;
                    }
                    row[static_cast<std::size_t>(k)] = now;
                    if (k > 4 && size_of(now - best) < Real(4 * unit_of_truth) * size_of(now)) return now;
                    best = now;
                }
                return best;
            };
            // stretch by stretch
            while (from != to) {
                Real next = to;
                if (shape == spline) {
                    stretch_ = static_cast<int>(static_cast<double>(from));
                    if (to > Real(stretch_ + 1)) next = stretch_ + 1;
                } else {
                    const Real most = Real(0.25);
                    if (next - from > most) next = from + most;
                    if (from - next > most) next = from - most;
                    if (shape == cycloid) {
                        // no step over a cusp, where |r'| has a corner
                        const Real turn = 8 * arctangent_of_one();
                        const Real n = std::floor(static_cast<double>(from / turn) + 0.5);
                        const Real above = turn * (n + Real(0.5)), below = turn * (n - Real(0.5));
                        if (from < above && next > above) next = above;
                        if (from > below && next < below) next = below;
                    }
                }
                sum += part(from, next);
                from = next;
            }
            return sum;
        };
        Real u = 0;
        for (int k = 0; k < 60; ++k) {
            if (shape == spline) stretch_ = static_cast<int>(static_cast<double>(u));
            const Real step = (length - length_to(u)) / norm(curve(u).first);
            u += step;
            if (shape == spline && u < 0) u = 0;
            if (size_of(step) < Real(4 * unit_of_truth) * (1 + size_of(u))) break;
        }
        return u;
    }

    Kinematics kinematics(Real t, Real u, Real w) const {
        const Point p = curve(u);
        if (moves == 0) return {p.at, w * p.first, p.first, (w * w) * p.second};
        if (moves == 1) {
            const Real q = shake_pace, s = sine(q * t), k = cosine(q * t);
            const Vec A(shake);
            return {p.at + s * A, w * p.first + (q * k) * A, p.first, (w * w) * p.second - (q * q * s) * A};
        }
        const Vec e = unit(Vec(axis)), o(through);
        const Real b = wobble, q = shake_pace, phi = Real(turning) * t + b * sine(q * t),
                   rate = Real(turning) + b * q * cosine(q * t), second_rate = -b * q * q * sine(q * t);
        const Real s = sine(phi), k = cosine(phi);
        const auto turned = [&](const Vec& v) { return k * v + s * cross(e, v) + ((1 - k) * dot(e, v)) * e; };
        const Vec r = turned(p.at - o), along = turned(p.first), bent = turned(p.second);
        // a = W' x r + W x (W x r) + 2 W x v' + a'
        const Vec omega = rate * e;
        return {o + r, w * along + cross(omega, r), along,
                (w * w) * bent + Real(2) * cross(omega, w * along) + second_rate * cross(e, r) +
                    cross(omega, cross(omega, r))};
    }
    Vec active(Real t, Real w, const Kinematics& k) const {
        Vec f = Real(mass) * Vec(gravity);
        if (linear != 0.0) f = f - Real(linear) * k.velocity;
        if (quadratic != 0.0) {
            // its size goes on smoothly through a zero, with the sign it had
            const Real size = norm(k.velocity);
            f = f - (Real(quadratic) * (moves == 0 && w * way_ < 0 ? -size : size)) * k.velocity;
        }
        if (stiffness != 0.0) {
            const Vec d = k.position - Vec(anchor);
            f = rest != 0.0 ? f - (Real(stiffness) * (1 - Real(rest) / norm(d))) * d : f - Real(stiffness) * d;
        }
        if (push_pace != 0.0) {
            const Real s = sine(Real(push_pace) * t), b = push_bend;
            f = f + s * Vec(push) - Vec{0, b * k.position.x, b * k.velocity.y};
        }
        return f;
    }
    Real acceleration(Real t, Real u, Real w) const {
        const Kinematics k = kinematics(t, u, w);
        const Vec tangent = unit(k.along), rest_force = Real(mass) * k.rest - active(t, w, k);
        Real along = -dot(rest_force, tangent);
        if (is_rough) {
            const Vec across = rest_force - dot(rest_force, tangent) * tangent;
            along -= Real(mu_dynamic) * sign_ * norm(across);
        }
        return along / (Real(mass) * norm(k.along));
    }
    /// What it takes to go on without slip: the force along, and the reaction across.
    Held holding() const {
        const Kinematics k = kinematics(t_, u_, w_);
        const Point p = curve(u_);
        const Real speed_of = norm(p.first);
        const Real drive_rate = swing != 0.0 ? Real(swing) * Real(pace) * cosine(Real(pace) * t_) : Real(0);
        // |r'| w = V: w' = (V' - r'.r'' w^2 / |r'|) / |r'|
        const Real rate = (drive_rate - dot(p.first, p.second) * w_ * w_ / speed_of) / speed_of;
        const Vec phi = Real(mass) * (rate * k.along + k.rest) - active(t_, w_, k);
        const Vec tangent = unit(k.along);
        const Real along = dot(phi, tangent);
        return {along, norm(phi - along * tangent)};
    }

    /// One step by extrapolation. Returns whether it settled.
    bool extrapolated(const State& x, Real h, State& out) const {
        const auto slope = [&](Real t, const State& s) { return State{s[1], acceleration(t, s[0], s[1])}; };
        const auto plus = [](const State& a, Real s, const State& b) {
            return State{a[0] + s * b[0], a[1] + s * b[1]};
        };
        std::array<State, most_columns> row;
        const State f0 = slope(t_, x);
        for (int j = 0; j < most_columns; ++j) {
            const int n = 2 * (j + 1);
            const Real step = h / n;
            // sums of increments, so that rounding is that of the increments
            State before{0, 0}, now{step * f0[0], step * f0[1]};
            for (int k = 1; k < n; ++k) {
                const State f = slope(t_ + k * step, plus(x, 1, now));
                const State next = plus(before, 2 * step, f);
                before = now;
                now = next;
            }
            // Neville's scheme: row[k] holds T(j-1, k) before, T(j, k) after
            State left = now;
            for (int k = 1; k <= j; ++k) {
                const Real ratio = Real(n) / Real(2 * (j - k + 1));
                const State above = row[static_cast<std::size_t>(k - 1)];
                State next;
                for (std::size_t i = 0; i < 2; ++i) next[i] = left[i] + (left[i] - above[i]) / (ratio * ratio - 1);
                row[static_cast<std::size_t>(k - 1)] = left;
                left = next;
            }
            row[static_cast<std::size_t>(j)] = left;
            if (j == 0) continue;
            const State& previous = row[static_cast<std::size_t>(j - 1)];
            Real change = 0;
            for (std::size_t i = 0; i < 2; ++i) change += size_of(left[i] - previous[i]);
            const Real scale = 1 + size_of(x[0]) + size_of(x[1]);
            if (j > 2 && change < Real(tolerance) * scale) {
                out = plus(x, 1, left);
                last_column_ = j;
                return change == change;
            }
        }
        return false;
    }
    static constexpr double tolerance = unit_of_truth < 1e-30 ? 1e-25 : 2e-19;

    Real t_ = 0, u_ = 0, w_ = 0, step_ = Real(0.1);
    int sign_ = 0, stretch_ = 0, way_ = 1;
    mutable int last_column_ = 0;
    std::vector<Vec> slopes_;
};

}  // namespace rbdyn::test::beads
