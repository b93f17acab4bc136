// Watched functions whose terms cancel: high powers and products with roots close together, far from where a step
// begins. Expanded there, they are rounding where they pass zero; their values are not. Every truth is a closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "rbdyn/integrate.hpp"
#include "support.hpp"

namespace rbdyn::test::test_cancelling_terms {
namespace {

struct Watched {
    std::string name;
    std::function<Expression(Expression)> function;  // of u = (x - c) / w
    std::vector<double> roots;                       // of it
    int degree;
};

std::vector<Watched> watched(std::mt19937_64& random) {
    std::uniform_real_distribution<double> in(-1.0, 1.0);
    std::vector<Watched> all;
    for (int n = 2; n <= 32; n += 2) {
        all.push_back({"power " + text(n), [=](const Expression& u) { return pow(u, n) - 1.0; }, {-1.0, 1.0}, n});
        all.push_back({"power " + text(n) + " and its square",
                       [=](const Expression& u) { return pow(u, n) * (1.0 + pow(u, n)) - 2.0; },
                       {-1.0, 1.0},
                       2 * n});
    }
    for (int count = 2; count <= 8; ++count) {
        std::vector<double> roots(static_cast<std::size_t>(count));
        const auto are_near = [&] {
            for (std::size_t k = 1; k < roots.size(); ++k)
                if (roots[k] - roots[k - 1] < 0.01) return true;
            return false;
        };
        do {
            for (double& root : roots) root = in(random);
            std::sort(roots.begin(), roots.end());
        } while (are_near());
        all.push_back({"product of " + text(count),
                       [=](const Expression& u) {
                           Expression product = 1.0;
                           for (const double root : roots) product = product * (u - root);
                           return product;
                       },
                       roots, count});
    }
    return all;
}

/// x = t, in one step if nothing shortens it; also where the run ends among the roots, or at one.
TEST(CancellingTerms, hide_no_root_of_a_watched_function) {
    std::mt19937_64 random(20261123);
    for (const double width : {0.1, 1e-2, 1e-3, 1e-5})
        for (const double place : {0.5, 0.3, 0.871})
            for (const Watched& w : watched(random))
                for (const int end : {0, 1, 2, 3}) {
                    std::vector<double> roots;
                    for (const double u : w.roots) roots.push_back(place + width * u);
                    const double until = end == 0   ? 1.0
                                         : end == 1 ? place
                                         : end == 2 ? 0.5 * (roots.back() + place)
                                                    : 1e3;
                    // not beyond the largest double
                    if (w.degree * std::log10(std::max(until - place, place) / width) > 290.0) continue;
                    std::erase_if(roots, [=](double x) { return x > until; });
                    for (const std::string engine : {"auto", "dop853"}) {
                        Scene scene;
                        const BodyHandle body = scene.add(Particle{1.0}, FreeStart{{0, 0, 0}, {1.0, 0, 0}});
                        scene.watch(
                            "w", [=](const Now& now) { return w.function((now[body].position()[0] - place) / width); });
                        SCOPED_TRACE(w.name + " at " + text(place) + ", width " + text(width) + ", until " +
                                     text(until) + ", " + engine);
                        const Attempt run = attempt(scene, {.until = until, .error = 1e-9, .engine = engine});
                        // what its steps cannot tell is refused
                        if (engine == "dop853" && run.outcome != simulating::Outcome::good) continue;
                        ASSERT_EQ(run.outcome, simulating::Outcome::good) << run.message;
                        const auto found = run.run.events().times("w");
                        ASSERT_EQ(found.size(), roots.size());
                        for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], roots[k], 1e-12);
                    }
                }
}

}  // namespace
}  // namespace rbdyn::test::test_cancelling_terms
