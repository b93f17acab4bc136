// How many pieces (path_pieces.hpp) a way without ends may take.
//
// Beside a branch point, and where forces change within a small part of their own length, series are as short as the
// way there: pieces shrink on the way to such a place and grow again behind it, a few of them to each halving. Such a
// hollow is a place of its own, not a part of the length that is to be searched: once pieces are as long again as
// before it, those in it are not counted, and a way does not end in one. Towards a pole, where forces grow as pieces
// shrink, it may.
#pragma once

#include <cstddef>
#include <vector>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM::statics {

class PathBudget {
public:
    /// Of `most` pieces; before the first one they are as long as `half`, half a piece.
    PathBudget(int most, double half);

    bool is_left() const;
    /// Whether more are taken than there would be without hollows.
    bool is_extended() const { return taken_ >= most_; }
    /// Half of the longest so far.
    double longest() const { return longest_; }

    /// A piece with the force in its middle.
    void take(double half, double force);
    /// A place passed without one.
    void leap() { ++count_; }

private:
    /// One such that all after it have been shorter.
    struct Crest {
        double half;
        int count;     // of pieces up to it
        double least;  // half of the shortest since the crest before
    };
    bool is_in_hollow() const;

    // parts of the length around to which one falls; pieces looked back at, of which a few make each halving and some
    // tens the floor; and pieces in hollows
    static constexpr double deep = 8.0, steep = 4.0;
    static constexpr std::size_t back = 64;
    static constexpr int most_in_hollows = 600;

    int most_, count_ = 0, taken_ = 0;
    double longest_, largest_ = 0.0;
    bool is_past_first_ = false;  // whether one was longer than before the first one
    std::vector<Crest> crests_;
    std::vector<double> halves_, forces_;
};

}  // namespace rbdyn::inline RBDYN_FORM::statics
