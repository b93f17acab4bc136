// Evaluators of a program's series that are kept for whoever needs one next: where events follow one another it takes
// longer to make one than to expand it.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Program;
class SeriesEvaluator;

/// Those of one program, for any number of threads. A copy of the program has none yet.
class KeptSeries {
public:
    KeptSeries();
    KeptSeries(const KeptSeries&);
    KeptSeries& operator=(const KeptSeries&);
    ~KeptSeries();

private:
    friend class BorrowedSeries;

    struct Kept {
        int order;
        std::unique_ptr<SeriesEvaluator> series;
    };
    struct Shelf {
        std::mutex mutex;
        std::vector<Kept> free;
    };
    static constexpr std::size_t most = 4;  // that are free: an engine's, and of those that look at a start
    static constexpr std::size_t most_bytes = 1U << 18;  // of one

    std::shared_ptr<Shelf> shelf_;
};

/// One of them, as if it were new, until this goes.
class BorrowedSeries {
public:
    BorrowedSeries(const Program& program, int order);
    BorrowedSeries(const BorrowedSeries&) = delete;
    BorrowedSeries& operator=(const BorrowedSeries&) = delete;
    ~BorrowedSeries();

    SeriesEvaluator& operator*() const { return *series_; }
    SeriesEvaluator* operator->() const { return series_.get(); }

private:
    std::shared_ptr<KeptSeries::Shelf> shelf_;
    int order_;
    std::unique_ptr<SeriesEvaluator> series_;
};

}  // namespace rbdyn::inline RBDYN_FORM
