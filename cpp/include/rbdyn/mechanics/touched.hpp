// Contacts of a tree at an instant, and what forces at them do to each other.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/mechanics/accelerate.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/contact.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"
#include "rbdyn/mechanics/joint_friction.hpp"
#include "rbdyn/mechanics/tree_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace friction {

/// Two directions across a normal.
inline std::pair<Vector3, Vector3> across(const Vector3& normal) {
    Vector3 least = Vector3::Zero();
    least[rbdyn::least(sizes(normal))] = 1.0;
    const Vector3 first = normal.cross(least).normalized();
    return {first, normal.cross(first)};
}

/// Two directions along a surface; of what moves in one plane the one along it first.
inline std::pair<Vector3, Vector3> along(const mechanics::Touching<double>& t) {
    if (t.is_in_plane) return {t.way(), t.across};
    return across(t.normal);
}

/// What joints that slide do against what presses them: each of them factor e . R, with its direction e held.
struct JointLaw {
    const std::vector<mechanics::RoughJoint>* joints = nullptr;
    double t = 0.0;
    std::vector<std::size_t> sliding;
    std::vector<double> factor;  // of each of them: -s mu r
    std::vector<std::array<double, 2>> along;
};

/// R M^-1 G^T between rows R and what pushes G, while constraints C hold: less R M^-1 C^T (C M^-1 C^T)^-1 C M^-1 G^T.
/// Joints that slide resist more where something pushes: what they do belongs to what pushes.
class Coupled {
public:
    using Row = mechanics::Row<double>;
    using Load = std::array<double, 2>;

    Coupled(const mechanics::Tree& tree, const std::vector<mechanics::Moving<double>>& all,
            const std::vector<Row>& constraints, const std::vector<Row>& rows, const std::vector<Row>& pushes,
            const JointLaw* law = nullptr)
        : tree_(&tree), accelerate_(mechanics::accelerate<double>(tree, all)) {
        for (const Row& r : constraints) held_.push_back(accelerate_.response(r));
        for (const Row& r : rows) rows_.push_back(accelerate_.response(r));
        for (const Row& r : pushes) pushes_.push_back(accelerate_.response(r));
        for (const Sparse& c : held_) {
            used_.emplace_back();
            for (const Sparse& other : held_) used_.back().push_back(accelerate_.between(c, other));
        }
        for (const Sparse& push : pushes_) {
            std::vector<double> b;
            for (const Sparse& c : held_) b.push_back(-accelerate_.between(c, push));
            answers_.push_back(mechanics::solve_definite<double>(used_, b));
        }
        if (law != nullptr) rub(*law, all, constraints, pushes);
    }
    mechanics::Square matrix() const {
        mechanics::Square a(rows_.size(), std::vector<double>(pushes_.size()));
        for (std::size_t i = 0; i < rows_.size(); ++i)
            for (std::size_t j = 0; j < pushes_.size(); ++j) {
                a[i][j] = accelerate_.between(rows_[i], pushes_[j]);
                for (std::size_t k = 0; k < held_.size(); ++k)
                    a[i][j] += accelerate_.between(rows_[i], held_[k]) * answers_[j][k];
                for (std::size_t s = 0; s < driven_.size(); ++s)
                    a[i][j] += accelerate_.along(rows_[i], driven_[s]) * rubbing_[j][s];
            }
        return a;
    }
    /// The changes of velocity variables by what pushes.
    std::vector<double> changes(const std::vector<double>& impulses) const {
        std::vector<double> u(static_cast<std::size_t>(accelerate_.freedoms()), 0.0);
        const auto take = [&](const Sparse& one, double times) {
            for (const auto& [n, part] : one) u[static_cast<std::size_t>(n)] += part * times;
        };
        for (std::size_t j = 0; j < pushes_.size(); ++j) {
            take(pushes_[j], impulses[j]);
            for (std::size_t k = 0; k < held_.size(); ++k) take(held_[k], answers_[j][k] * impulses[j]);
            for (std::size_t s = 0; s < driven_.size(); ++s)
                for (std::size_t n = 0; n < u.size(); ++n) u[n] += driven_[s][n] * (rubbing_[j][s] * impulses[j]);
        }
        return mechanics::velocity_changes<double>(*tree_, accelerate_.spread(u));
    }

    /// What a row would have of acceleration by a unit of its own, were nothing held.
    double alone(std::size_t row) const { return accelerate_.between(rows_[row], rows_[row]); }
    /// How a unit of what pushes presses joints, and what of it those that slide do against.
    const std::vector<Load>& loads(std::size_t push) const { return loads_[push]; }
    const std::vector<double>& rubbing(std::size_t push) const { return rubbing_[push]; }

private:
    using Sparse = mechanics::Accelerate<double>::Sparse;

    void rub(const JointLaw& law, const std::vector<mechanics::Moving<double>>& all,
             const std::vector<Row>& constraints, const std::vector<Row>& pushes) {
        const mechanics::FrictionResponse<double> response(*tree_, *law.joints, accelerate_, law.t, all, constraints);
        const std::size_t count = law.sliding.size();
        mechanics::Square m(count, std::vector<double>(count));
        const auto pressed = [&](std::size_t s, const Load& load) {
            return law.factor[s] * (law.along[s][0] * load[0] + law.along[s][1] * load[1]);
        };
        for (std::size_t s = 0; s < count; ++s) {
            driven_.push_back(response.driven(law.sliding[s]));
            for (std::size_t r = 0; r < count; ++r)
                m[s][r] = (s == r ? 1.0 : 0.0) - pressed(s, response.load(law.sliding[s], law.sliding[r]));
        }
        for (std::size_t p = 0; p < pushes.size(); ++p) {
            std::vector<double> u(static_cast<std::size_t>(accelerate_.freedoms()), 0.0);
            for (const auto& [n, part] : pushes_[p]) u[static_cast<std::size_t>(n)] += part;
            for (std::size_t k = 0; k < held_.size(); ++k)
                for (const auto& [n, part] : held_[k]) u[static_cast<std::size_t>(n)] += part * answers_[p][k];
            const auto spread = accelerate_.spread(u).bodies;
            std::vector<Load> loads;
            for (std::size_t i = 0; i < law.joints->size(); ++i) {
                loads.push_back(response.load(i, spread, answers_[p]));
                const Load less = response.across(i, response.less(i, pushes[p], 1.0));
                for (std::size_t k = 0; k < 2; ++k) loads.back()[k] += less[k];
            }
            std::vector<double> b;
            for (std::size_t s = 0; s < count; ++s) b.push_back(pressed(s, loads[law.sliding[s]]));
            const std::vector<double> found = mechanics::solve_any(m, b);
            for (std::size_t i = 0; i < loads.size(); ++i)
                for (std::size_t s = 0; s < count; ++s)
                    for (std::size_t k = 0; k < 2; ++k) loads[i][k] += response.load(i, law.sliding[s])[k] * found[s];
            rubbing_.push_back(found);
            loads_.push_back(std::move(loads));
        }
    }

    const mechanics::Tree* tree_;
    mechanics::Accelerate<double> accelerate_;
    std::vector<Sparse> held_, rows_, pushes_;
    mechanics::Square used_, answers_;
    std::vector<std::vector<double>> driven_, rubbing_;  // of each joint that slides; of each push what these do
    std::vector<std::vector<Load>> loads_;
};

}  // namespace friction

struct TreeModel::Touched {
    struct One {
        int contact;
        mechanics::Touching<double> at;
        Vector3 slip, along = Vector3::Zero();  // u across the normal; its direction where it slides
        bool slides = false;
        Vector3 axes[3];       // of its unknowns: the normal, and two across it
        double sliding = 0.0;  // its coefficient where it slides
    };
    std::vector<One> all;
    std::vector<mechanics::Cone> cones;
    std::vector<mechanics::Row<double>> rows, pushes;
    mechanics::Square matrix;
    std::optional<friction::Coupled> coupled;  // always there
    std::vector<mechanics::Moving<double>> moving;
    double t = 0.0;
    std::vector<double> state;
};

}  // namespace rbdyn::inline RBDYN_FORM
