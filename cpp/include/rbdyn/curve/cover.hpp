// A plane curve as a tree of stretches with boxes around them, ending in stretches that are graphs over their chords.
//
// A graph: along a stretch that turns little, with xi along the chord and eta to its left, both in half chords from its
// middle, the curve is eta = f(xi), -1 <= xi <= 1, f a polynomial interpolated at Chebyshev points of xi (Trefethen,
// "Approximation Theory and Approximation Practice", SIAM 2013, ch. 3 and 8). A point lies to the left of the curve
// where eta > f(xi).
//
// Stretches are made where they are asked for and kept. A stretch is divided at its roundest parameter, the one with
// the fewest binary digits: at 0, at multiples of large powers of two, at whole numbers, and only then between them, so
// that what changes at whole parameters (a knot of a spline) lies at ends. Next to a cusp or a corner the stretches
// shrink towards it until they are no larger than rounding.
//
// A curve without end is covered by stretches each twice as long as the one before, to 2^64 times the length of the
// first, which is about the size of the first path asked for. What is guaranteed: boxes hold the curve where 17 points
// of a stretch show it, with a margin of the widest gap between neighbours, in each coordinate;
// a feature that no point falls on and that is farther out than this gap is not seen. Units: a power of two in them
// changes no bit but the scale.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/curve/curve.hpp"
#include "rbdyn/curve/point.hpp"

namespace rbdyn::inline RBDYN_FORM::curves {

/// A rectangle in the plane of a curve, along its own axes.
struct Box {
    double x0 = std::numeric_limits<double>::infinity(), x1 = -std::numeric_limits<double>::infinity();
    double y0 = std::numeric_limits<double>::infinity(), y1 = -std::numeric_limits<double>::infinity();

    bool meets(const Box& b) const { return x0 <= b.x1 && b.x0 <= x1 && y0 <= b.y1 && b.y0 <= y1; }
    double size() const { return std::max(x1 - x0, y1 - y0); }
    double farthest() const;
    void add(double x, double y);
    void add(const Box& b);
    void widen(double by_x, double by_y);
};

/// A stretch as a graph over its chord.
struct Graph {
    static constexpr int degree = 20;

    double x, y;                          // middle of the chord, own axes
    double along_x, along_y;              // unit vector along the chord, growing u
    double half;                          // of the chord's length
    int order, u_order;                   // of f and u
    std::array<double, degree + 1> f, u;  // coefficients of f(xi), and of a first guess of u(xi)
    double low, high;                     // bounds of f
    double noise;                         // what points of the curve are rounded by, in half chords

    /// Components of vectors in half chords, and xi of a point.
    double along(const Vector3& v) const { return (v[0] * along_x + v[1] * along_y) / half; }
    double across(const Vector3& v) const { return (v[1] * along_x - v[0] * along_y) / half; }
    double along_from(const Vector3& point) const;
};

/// The number with the fewest binary digits in the open interval (a, b); the middle if there is none.
double roundest(double a, double b);

class CurveCover {
public:
    enum class State { whole, divided, graph, point };
    struct Stretch {
        double begin, end;  // parameters
        Box box;
        State state = State::whole;
        int child = -1;  // the first of two that follow each other, or the graph's number
    };

    /// The curve must lie in the plane of its first two own axes. `period`: by how much the parameter of a closed curve
    /// grows in a turn, 0 for others. Throws InvalidInput if it is neither.
    explicit CurveCover(Curve curve, double period = 0.0);

    const Curve& curve() const { return curve_; }
    /// What is covered: of a closed curve, one turn.
    Domain domain() const { return domain_; }
    /// Zero unless closed.
    double period() const { return period_; }
    const Stretch& stretch(int i) const { return stretches_[static_cast<std::size_t>(i)]; }
    const Graph& graph(const Stretch& s) const { return graphs_[static_cast<std::size_t>(s.child)]; }

    /// Appends the longest stretches that meet a box.
    void find(const Box& box, std::vector<int>& found);

    /// Makes a whole stretch a graph, a point, or divides it in two.
    void refine(int i);

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static constexpr int samples = 17;
    static constexpr int octaves = 64;

    /// Stretches one after the other outward, and boxes of each with all beyond it.
    struct Chain {
        std::vector<int> stretches;
        std::vector<Box> beyond;
    };

    static double spacing(const Stretch& s) { return epsilon * std::max(std::abs(s.begin), std::abs(s.end)); }

    using Values = std::array<long double, Graph::degree + 1>;

    /// cos(pi k / n), exact at its zeros and ends.
    template <int n>
    static long double chebyshev(int k) {
        static const auto table = [] {
            std::array<long double, static_cast<std::size_t>(2 * n)> t;
            for (int j = 0; j < 2 * n; ++j)
                t[static_cast<std::size_t>(j)] = std::sin(std::numbers::pi_v<long double> * (n - 2 * j) / (2 * n));
            return t;
        }();
        return table[static_cast<std::size_t>(k % (2 * n))];
    }
    /// The points of a stretch that are looked at, from its begin to its end.
    static double sample(const Stretch& s, int k);

    void begin(const Box& box);

    Chain chain(double from, const std::vector<double>& ends);

    /// A power of two by which the curve goes about as far as a path does.
    double first_length(double u, double distance) const;

    int add(double begin, double end);

    /// Appends the graph of a stretch if it is one, and draws the stretch's box close.
    bool make_graph(Stretch& s);

    /// The parameter of Chebyshev point k of a chord, by Newton's method from that of the point before.
    std::optional<double> met_at(const Graph& g, const Stretch& s, int k, double guess) const;

    /// Coefficients of the polynomial through values at the points cos(pi k / n), those below `negligible` at the end
    /// left out; false if the last three are not below `resolved`, unless that is zero.
    static bool fit(const Values& values, double resolved, double negligible,
                    std::array<double, Graph::degree + 1>& coefficients, int& order);

    Curve curve_;
    Domain domain_;
    double period_ = 0.0;
    std::vector<Chain> chains_;
    std::vector<Stretch> stretches_;
    std::vector<Graph> graphs_;
};

}  // namespace rbdyn::inline RBDYN_FORM::curves
