// Definitions of rbdyn/cost.hpp.
#pragma once

#include "rbdyn/cost.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <exception>
#include <iomanip>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/engine/engine.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/model/points.hpp"
#include "rbdyn/plan/kept_plan.hpp"
#include "rbdyn/plan/linear_motion.hpp"
#include "rbdyn/plan/plan.hpp"
#include "rbdyn/plan/planning.hpp"
#include "rbdyn/scene/parts.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/solve.hpp"
#include "rbdyn/trajectory/accuracy.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE const CostRow& Price::cheapest(double error) const {
    const CostRow* best = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const CostRow& row : rows) {
        least = std::min(least, row.error);
        if (row.error <= error && (best == nullptr || row.seconds < best->seconds)) best = &row;
    }
    if (rows.empty()) throw InvalidInput("Price: the table has 0 rows; give cost() a larger budget");
    if (best == nullptr)
        throw InvalidInput("Price: error is " + text(error) + "; the most accurate row of this table reaches " +
                           text(least));
    return *best;
}

RBDYN_INLINE Price cost(const Scene& scene, const CostOptions& options) {
    using namespace simulating;
    using Clock = std::chrono::steady_clock;
    const auto seconds_since = [](Clock::time_point t) {
        return std::chrono::duration<double>(Clock::now() - t).count();
    };
    require(options.budget > 0.0, "cost", "budget", options.budget, "it is positive, in s");
    for (double e : options.errors) require(e > 0.0 && e <= 0.1, "cost", "an error", e, "it lies between 0 and 0.1");
    SimulateOptions base;
    base.until = options.until;
    base.start = options.start;
    base.rtol = 1e-16;
    base.monitor = options.monitor;
    validate(base);
    const auto began = Clock::now();
    const auto [plan_scene, plan, is_new] = planned(scene);
    // each by itself, as simulate() does; their times add up
    struct Part {
        const Plan& plan;
        const Scene& scene;
        std::vector<double> start;
        Record reference;
    };
    std::vector<Part> parts;
    if (plan.parts.empty()) parts.push_back({plan, plan_scene, {}, {}});
    for (std::size_t i = 0; i < plan.parts.size(); ++i)
        parts.push_back({plan.parts[i], plan.apart->parts[i].scene, {}, {}});
    const auto integrated = [&](const Part& part, const std::string& engine, double tolerance) {
        Timed timed = integrate(*part.plan.model, part.start, base, engine, tolerance, {});
        if (timed.record.thrown) std::rethrow_exception(timed.record.thrown);
        return timed;
    };
    for (Part& part : parts) {
        const std::string& engine = part.plan.integrator;
        part.start = part.plan.model->start(options.start);
        part.reference = integrated(part, engine, 0.1 * least_tolerance(engine)).record;
    }
    // what ends one of them ends all
    if (parts.size() > 1)
        for (const Part& part : parts) base.until = std::min(base.until, part.reference.end.hi);
    std::vector<std::string> engines;
    for (const std::string& engine : options.engines.empty() ? simulating::engines() : options.engines) {
        if (options.engines.empty() && plan.calls_back && engine == "taylor") continue;
        engines.push_back(engine != "auto" ? engine : plan.is_closed() ? "closed form" : plan.integrator);
        for (const Part& part : parts) (void)engine_for(part.plan, engines.back());
    }
    std::vector<double> errors = options.errors;
    std::sort(errors.rbegin(), errors.rend());
    Price price;
    const double share = options.budget / static_cast<double>(std::max<std::size_t>(engines.size(), 1) *
                                                              std::max<std::size_t>(errors.size(), 1));
    if (plan.is_closed() && (options.engines.empty() || std::erase(engines, "closed form") > 0)) {
        CostRow row{"closed form"};
        const double span = base.until - options.start;
        for (Part& part : parts) {
            const auto first = Clock::now();
            const auto form = planning::closed_form(part.scene, *part.plan.model, true).form;
            std::vector<double> end(part.start.size());
            form->state({span, 0.0}, end);
            row.seconds += seconds_since(first);
            row.error = std::max(row.error, form->error(span, 1e-9));
        }
        price.rows.push_back(row);
    }
    for (const std::string& engine : engines) {
        double tolerance = errors.empty() ? 1e-9 : errors.front(), reached = std::numeric_limits<double>::infinity();
        for (double wanted : errors) {
            tolerance = std::min(tolerance, wanted);
            while (reached > wanted && tolerance >= least_tolerance(engine) && seconds_since(began) < options.budget) {
                CostRow row{engine, tolerance};
                std::vector<double> times;
                const auto first = Clock::now();
                do {
                    times.push_back(0.0);
                    for (const Part& part : parts) {
                        const Timed run = integrated(part, engine, tolerance);
                        times.back() += run.seconds;
                        if (times.size() > 1) continue;
                        row.steps += run.record.work.steps;
                        row.right_hand_sides += run.record.work.right_hand_sides;
                        row.error =
                            std::max(row.error, AccuracyCheck(*part.plan.model, 1.0)(run.record, part.reference).error);
                    }
                } while (times.size() < 7 && seconds_since(first) < 0.2 * share);
                std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2),
                                 times.end());
                row.seconds = times[times.size() / 2];
                reached = std::min(reached, row.error);
                price.rows.push_back(row);
                tolerance *= 0.1;
            }
        }
    }
    return price;
}

RBDYN_INLINE std::ostream& operator<<(std::ostream& out, const Price& price) {
    out << std::left << std::setw(14) << "engine" << std::right << std::setw(11) << "tolerance" << std::setw(11)
        << "error" << std::setw(12) << "time [ms]" << std::setw(9) << "steps" << std::setw(19) << "right-hand sides"
        << '\n';
    const auto flags = out.flags();
    const auto digits = out.precision();
    for (const CostRow& r : price.rows)
        out << std::left << std::setw(14) << r.engine << std::right << std::scientific << std::setprecision(0)
            << std::setw(11) << r.tolerance << std::setprecision(1) << std::setw(11) << r.error << std::fixed
            << std::setprecision(4) << std::setw(12) << r.seconds * 1e3 << std::setw(9) << r.steps << std::setw(19)
            << r.right_hand_sides << '\n';
    out.flags(flags);
    out.precision(digits);
    return out;
}

}  // namespace rbdyn::inline RBDYN_FORM
