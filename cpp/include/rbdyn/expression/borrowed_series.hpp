// An evaluator of a program's series that is borrowed from those that are kept.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/kept_series.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct KeptSeries::Shelf {
    struct Kept {
        int order;
        SeriesEvaluator::Use use;
        std::unique_ptr<SeriesEvaluator> series;
        // of what repeats itself to make one takes as long as some steps
        bool is_long() const { return series->bytes() > most_bytes; }
    };
    static constexpr std::size_t most = 4;  // that are free: an engine's, and of those that look at a start
    static constexpr std::size_t most_bytes = 1U << 18;  // of one
    // and so many larger ones with repeated code, with their lists of so many bytes: of two runs that judge each other
    // each has an order of its own
    static constexpr std::size_t most_long = 2, most_bytes_of_long = 1U << 29;

    std::mutex mutex;
    std::vector<Kept> free;
};

/// One of them, as if it were new, until this goes.
class BorrowedSeries {
public:
    BorrowedSeries(const Program& program, int order, SeriesEvaluator::Use use = SeriesEvaluator::Use::any);
    BorrowedSeries(const BorrowedSeries&) = delete;
    BorrowedSeries& operator=(const BorrowedSeries&) = delete;
    ~BorrowedSeries();

    SeriesEvaluator& operator*() const { return *series_; }
    SeriesEvaluator* operator->() const { return series_.get(); }

private:
    std::shared_ptr<KeptSeries::Shelf> shelf_;
    int order_;
    SeriesEvaluator::Use use_;
    std::unique_ptr<SeriesEvaluator> series_;
};

}  // namespace rbdyn::inline RBDYN_FORM
