// Whether the steps of a run still get on.
//
// Where what is called back jumps, and the motion is driven to the jump from both of its sides, no guard tells of it:
// every step that the tolerance lets pass crosses the jump, and the run chatters in steps of about the tolerance. The
// same is met where a function has no finite slope and the motion comes to rest (x' = -x^0.4 at 0). Looked at are steps
// that move nothing by more than a few tolerances, a thousand in a row:
//
// * a jump of the equations lies on their way, or where the rates would lead in a few steps more, found by halving the
//   way between two states until the rates differ by as much over 2^-40 of it, of one step after the other;
// * or all of them together have led nowhere, and at their pace the rest of the run takes more than a share of
//   max_steps.
//
// Besides, steps that get shorter and shorter over tens of thousands of them (x' = x^2 + sin x on its way to infinity),
// so that at their pace max_steps will not do, need not be counted to their end.
//
// Steps of ordinary length cost a comparison.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Progress {
public:
    /// `tolerance`: of the steps, relative.
    explicit Progress(double tolerance);

    enum class Verdict {
        gets_on,
        leads_nowhere,  // steps go to and fro or get ever shorter, and are too many
        jumps           // across a jump of the equations
    };

    /// After a step in a mode that was stored up to `length` of its piece.
    Verdict after(const Mode& mode, const Piece& piece, double length, double until, std::int64_t max_steps);

    /// The variable whose rate jumps, and the rates on both sides, of the last verdict `jumps`.
    struct Jump {
        int variable = -1;
        double before = 0.0, after = 0.0;
    };
    const Jump& jump() const { return jump_; }
    /// The largest extent of a variable so far.
    double extent() const;
    /// The length of the steps looked at, on average [s].
    double pace() const { return pace_; }

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    /// Whether steps have got shorter from one row of many to the next, and will be more than max_steps.
    bool is_slowing_down(Instant end, Instant start, double until, std::int64_t max_steps);
    /// Begins to look at steps anew, from the start of a piece.
    void begin(const Piece& piece);
    /// Looks for a jump near the end of a piece.
    void look(const Mode& mode, const Piece& piece, double length);
    /// The variable whose rates differ most, by more than a thousandth; -1: none.
    static int most_different(const std::vector<double>& a, const std::vector<double>& b);

    static constexpr int many_steps = 10'000;
    // steps looked at, in a row; those of them whose sides are looked at
    static constexpr int row = 1000, first_looked_at = 200, looked_at = 32;
    // as many steps to the end are ordinary ones; more than this share of max_steps are too many
    static constexpr double few_steps = 1e4, share = 0.01;

    double hardly_;                         // a step that moves anything by more of its extent is an ordinary one
    std::vector<double> low_, high_;        // extent of the variables so far
    int count_ = 0;                         // steps in a row
    Instant since_;                         // when the first of them began
    std::vector<double> origin_, way_, x_;  // the state there, and how far the variables went since, to and fro
    int crossings_ = 0;                     // steps with rates that differ near their end
    Jump jump_;
    int steps_ = 0, slower_ = 0;  // of the present row of many; rows that were slower than the one before
    Instant window_;              // when that began
    double last_pace_ = 0.0;
    double pace_ = 0.0;
};

}  // namespace rbdyn::inline RBDYN_FORM
