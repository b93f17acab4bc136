// Where in a step a constraint opens that holds with others alone.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/mechanics/constraint.hpp"
#include "rbdyn/mechanics/tree.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM::mechanics {

/// Finds where the first of some constraints opens, the rows that are used closed.
class Loosening : public Locator {
public:
    Loosening(std::shared_ptr<const Tree> tree, std::shared_ptr<const Conditions> conditions, std::vector<int> rows,
              std::vector<int> which, double loosest_gap, int samples)
        : tree_(std::move(tree)),
          conditions_(std::move(conditions)),
          rows_(std::move(rows)),
          which_(std::move(which)),
          loosest_(loosest_gap),
          samples_(samples) {}

    std::optional<double> first(const Piece& piece, bool fresh) const override;

private:
    bool is_open(const Piece& piece, double tau) const;

    std::shared_ptr<const Tree> tree_;
    std::shared_ptr<const Conditions> conditions_;
    std::vector<int> rows_, which_;  // the rows that are used, and the constraints with others
    double loosest_;
    int samples_;
};

}  // namespace rbdyn::inline RBDYN_FORM::mechanics
