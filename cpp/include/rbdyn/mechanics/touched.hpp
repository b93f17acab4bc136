// Contacts of a tree at an instant, and what forces at them do to each other.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/mechanics/accelerate.hpp"
#include "rbdyn/mechanics/closure.hpp"
#include "rbdyn/mechanics/contact.hpp"
#include "rbdyn/mechanics/friction_cones.hpp"
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

/// R M^-1 G^T between rows R and what pushes G, while constraints C hold: less R M^-1 C^T (C M^-1 C^T)^-1 C M^-1 G^T.
class Coupled {
public:
    using Row = mechanics::Row<double>;

    Coupled(const mechanics::Tree& tree, const std::vector<mechanics::Moving<double>>& all,
            const std::vector<Row>& constraints, const std::vector<Row>& rows, const std::vector<Row>& pushes)
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
    }
    mechanics::Square matrix() const {
        mechanics::Square a(rows_.size(), std::vector<double>(pushes_.size()));
        for (std::size_t i = 0; i < rows_.size(); ++i)
            for (std::size_t j = 0; j < pushes_.size(); ++j) {
                a[i][j] = accelerate_.between(rows_[i], pushes_[j]);
                for (std::size_t k = 0; k < held_.size(); ++k)
                    a[i][j] += accelerate_.between(rows_[i], held_[k]) * answers_[j][k];
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
        }
        return mechanics::velocity_changes<double>(*tree_, accelerate_.spread(u));
    }

private:
    using Sparse = mechanics::Accelerate<double>::Sparse;
    const mechanics::Tree* tree_;
    mechanics::Accelerate<double> accelerate_;
    std::vector<Sparse> held_, rows_, pushes_;
    mechanics::Square used_, answers_;
};

}  // namespace friction

struct TreeModel::Touched {
    struct One {
        int contact;
        mechanics::Touching<double> at;
        Vector3 slip, along = Vector3::Zero();  // u across the normal; its direction where it slides
        bool slides = false;
        Vector3 axes[3];  // of its unknowns: the normal, and two across it
    };
    std::vector<One> all;
    std::vector<mechanics::Cone> cones;
    std::vector<mechanics::Row<double>> rows, pushes;
    mechanics::Square matrix;
    std::optional<friction::Coupled> coupled;  // always there
    std::vector<mechanics::Moving<double>> moving;
};

}  // namespace rbdyn::inline RBDYN_FORM
