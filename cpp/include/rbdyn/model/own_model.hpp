// A model of the user's own: x' = f(t, x) as any functor over the number type.
//
//     struct Pendulum {
//         int variables() const { return 2; }
//         template <class S>
//         void operator()(const S& t, std::span<const S> x, std::span<S> rate) const {
//             rate[0] = x[1];
//             rate[1] = -9.81 * sin(x[0]);
//         }
//     };
//
// It is recorded once for each side of its case distinctions (abs, where, min, max, floor ...), which are located as
// events like those of scenes. What it may have besides: positions(), the number of variables at the front that are
// measured by the extent of their motion; watched(t, x), a std::vector<std::pair<std::string, S>> of functions whose
// zeros are noted; limits(t, x), another of functions that end the run where they fall through zero;
// require_start(x), which throws InvalidInput for a state it cannot start in.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/direction.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/expression/recording.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/sliding.hpp"
#include "rbdyn/model/variables_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What simulate() takes for a model: a functor that records.
template <class M>
concept OwnModel = requires(const M& m, const Expression& t, std::span<const Expression> x,
                            std::span<Expression> rate) {
    { m.variables() } -> std::convertible_to<int>;
    m(t, x, rate);
};

/// A functor as a hybrid model.
template <OwnModel M>
class FunctorModel : public VariablesModel {
public:
    explicit FunctorModel(M model) : model_(std::move(model)) {}

    int variables() const override { return model_.variables(); }

    Mode begin(double t, std::span<double> x) const override {
        if constexpr (requires { model_.require_start(std::span<const double>(x)); }) model_.require_start(x);
        Mode mode;
        choose(mode, t, x, {});
        return mode;
    }

    Mode next(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
              std::vector<Happening>& happenings) const override {
        std::vector<int> flipped;
        for (const int index : fired) flip(mode, index, true, x, flipped, happenings);
        Mode after = mode;
        choose(after, t, x, flipped);
        if (same_motion(mode, after, flipped)) happenings.clear();
        return after;
    }

private:
    std::vector<signed char> kind_of(const Mode&) const override { return {}; }

    std::unique_ptr<Structure> record(const Mode&, const RecordedFor& state) const override {
        Recorder r;
        r.follow(state.t, state.x, {}, state.decided.forced, state.decided.sides);
        const recording::Active active(r);
        const int n = variables();
        const Expression t = r.time();
        std::vector<Expression> x, rate(static_cast<std::size_t>(n), Expression(0.0));
        for (int i = 0; i < n; ++i) x.push_back(r.input(i));
        const auto laws = [&] {
            std::fill(rate.begin(), rate.end(), Expression(0.0));
            model_(t, std::span<const Expression>(x), std::span<Expression>(rate));
            return rate;
        };
        return written(r, n, state.decided.sliding, laws, [&](EquationsWriter& write, std::span<const Expression> f) {
            for (int i = 0; i < n; ++i) write.rate(i) = f[static_cast<std::size_t>(i)];
            [[maybe_unused]] int index = 0;
            if constexpr (requires { model_.watched(t, std::span<const Expression>(x)); }) {
                for (const auto& [name, value] : model_.watched(t, std::span<const Expression>(x)))
                    write.watch(
                        {.role = GuardRole::record, .direction = Direction::either, .name = name, .watch = index++},
                        value);
            }
            if constexpr (requires { model_.limits(t, std::span<const Expression>(x)); }) {
                for (const auto& [name, value] : model_.limits(t, std::span<const Expression>(x)))
                    write.watch(
                        {.role = GuardRole::stop, .direction = Direction::falling, .name = name, .watch = index++},
                        value);
            }
            int positions = 0;
            if constexpr (requires { model_.positions(); }) positions = model_.positions();
            std::vector<VariableGroup> groups;
            for (int i = 0; i < n; ++i) groups.push_back({i, 1, i < positions});
            return groups;
        });
    }

    M model_;
};

}  // namespace rbdyn::inline RBDYN_FORM
