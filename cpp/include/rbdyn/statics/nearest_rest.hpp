// The state of rest nearest to a place, of those that searches from there and from about it lead to.
//
// Newton's method goes to some zero of the forces, often not to the nearest one. So it is begun, too, where a search
// downhill ends, and at places about: along every freedom, and on ways between them, at parts of the distance of the
// nearest zero known; a nearer one begins this anew. Angles, and parameters of closed rails, are taken back by the
// whole turns that the forces do not tell. Not all there are need be found.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/statics/tree_forces.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

class NearestRest {
public:
    NearestRest(TreeForces& forces, std::vector<double> near) : forces_(forces), near_(std::move(near)) {}

    /// Throws InvalidInput where the forces are not finite at the place itself.
    std::optional<std::vector<double>> find();

private:
    // freedoms up to which all of this is done; of more, searches from about are for scenes where all else fails
    static constexpr int most_freedoms = 24;

    /// Takes the zero that a search leads to; whether it is the nearest so far.
    bool consider(std::vector<double> q);
    /// Without the whole turns that change nothing.
    std::vector<double> turned_back(std::vector<double> q);
    /// Directions of unit length, in the freedoms.
    std::vector<std::vector<double>> directions() const;
    /// At places about, as far as a reach in units of every freedom; whether one led to a nearer zero.
    bool looks_about(double reach, const std::vector<double>& units);

    TreeForces& forces_;
    std::vector<double> near_;
    std::optional<std::vector<double>> best_;
    double distance_ = 0.0;
};

}  // namespace rbdyn::inline RBDYN_FORM::statics
