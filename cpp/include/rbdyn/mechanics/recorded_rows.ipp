// Definitions of rbdyn/mechanics/recorded_rows.hpp.
#pragma once

#include "rbdyn/mechanics/recorded_rows.hpp"

#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/recorder.hpp"
#include "rbdyn/mechanics/accelerate.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/driven.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

RBDYN_INLINE RecordedRows::RecordedRows(const Tree& tree, const Conditions& conditions, const std::vector<int>& rows,
                                        double t, std::span<const double> state) {
    using S = Expression;
    constexpr std::size_t most_answers = 4096;
    const std::size_t count = rows.size();
    const auto velocities = static_cast<std::size_t>(tree.velocities());
    if (count * (count + velocities) > most_answers || !tree.feet().empty()) return;
    for (const Node& n : tree.nodes())
        if (driven(n) != nullptr || moved(n) != nullptr || n.joint.rail() != nullptr) return;
    const recording::WideFolding all_digits;
    const int inputs = tree.positions() + tree.velocities();
    Recorder r;
    r.follow(t, state, {});
    std::vector<S> x;
    for (int i = 0; i < inputs; ++i) x.push_back(r.input(i));
    const std::vector<Moving<S>> moving = tree.moving<S>(r.time(), x.data(), x.data() + tree.positions());
    const std::vector<S> all_gaps = conditions.gaps<S>(tree, moving);
    const std::vector<Row<S>> all_rows = conditions.rows<S>(tree, moving);
    const Accelerate<S> joints = accelerate<S>(tree, moving);
    std::vector<S> gap, rate, answer, columns;
    std::vector<Accelerate<S>::Sparse> responses;
    for (const int row : rows) {
        gap.push_back(all_gaps[static_cast<std::size_t>(row)]);
        rate.push_back(Conditions::rate(all_rows[static_cast<std::size_t>(row)], moving));
        responses.push_back(joints.response(all_rows[static_cast<std::size_t>(row)]));
        for (const auto& other : responses) answer.push_back(joints.between(responses.back(), other));
        std::vector<S> driven(static_cast<std::size_t>(joints.freedoms()), S(0.0));
        for (const auto& [n, one] : responses.back()) driven[static_cast<std::size_t>(n)] = one;
        for (const S& change : velocity_changes<S>(tree, joints.spread(driven))) columns.push_back(change);
    }
    answer.insert(answer.end(), columns.begin(), columns.end());
    gaps = Program(r, gap, inputs);
    rates = Program(r, rate, inputs);
    answers = Program(r, answer, inputs);
    is_there_ = r.branches().empty() && r.cells().empty();
    for (const Program* p : {&gaps, &rates, &answers})
        is_there_ = is_there_ && !p->has_calls() && p->switches().empty() && p->parameters() == 0;
}

RBDYN_INLINE const RecordedRows* LazyRows::operator()(const Tree& tree, const Conditions& conditions,
                                                      const std::vector<int>& rows, double t,
                                                      std::span<const double> x) const {
    std::call_once(once_, [&] { rows_ = std::make_unique<const RecordedRows>(tree, conditions, rows, t, x); });
    return rows_->is_there() ? rows_.get() : nullptr;
}

RBDYN_INLINE RowValues::RowValues(const RecordedRows& rows, int count, int velocities)
    : gaps_(rows.gaps),
      rates_(rows.rates),
      answers_(rows.answers),
      matrix_(static_cast<std::size_t>(count), std::vector<double>(static_cast<std::size_t>(count))),
      velocities_(velocities) {}

RBDYN_INLINE std::vector<double> RowValues::against(Evaluator<Real>& values, double t,
                                                    const std::vector<Real>& x) const {
    values(static_cast<Real>(t), x);
    std::vector<double> result;
    for (int j = 0; j < static_cast<int>(matrix_.size()); ++j) result.push_back(-static_cast<double>(values.output(j)));
    return result;
}

RBDYN_INLINE void RowValues::look(double t, std::span<const double> x) {
    answers_(t, x);
    int next = 0;
    for (std::size_t i = 0; i < matrix_.size(); ++i)
        for (std::size_t j = 0; j <= i; ++j) matrix_[i][j] = answers_.output(next++);
}

RBDYN_INLINE std::vector<double> RowValues::changes(const std::vector<double>& asked) const {
    const std::vector<double> lambda = solve_definite<double>(matrix_, asked);
    std::vector<double> all(static_cast<std::size_t>(velocities_));
    int next = static_cast<int>(matrix_.size() * (matrix_.size() + 1) / 2);
    for (const double one : lambda)
        for (double& change : all) change += one * answers_.output(next++);
    return all;
}

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
