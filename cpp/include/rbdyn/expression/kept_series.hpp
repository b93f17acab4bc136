// Evaluators of a program's series that are kept for whoever needs one next (borrowed_series.hpp): where events follow
// one another it takes longer to make one than to expand it.
#pragma once

#include <memory>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Those of one program, for any number of threads. A copy of the program has none yet.
class KeptSeries {
public:
    KeptSeries();
    KeptSeries(const KeptSeries&) : KeptSeries() {}
    KeptSeries& operator=(const KeptSeries& other);

private:
    friend class BorrowedSeries;
    struct Shelf;
    std::shared_ptr<Shelf> shelf_;
};

}  // namespace rbdyn::inline RBDYN_FORM
