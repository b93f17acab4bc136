// Definitions of rbdyn/expression/kept_series.hpp and rbdyn/expression/borrowed_series.hpp.
#pragma once

#include "rbdyn/expression/borrowed_series.hpp"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

#include "rbdyn/expression/kept_series.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE KeptSeries::KeptSeries() : shelf_(std::make_shared<Shelf>()) {}
RBDYN_INLINE KeptSeries& KeptSeries::operator=(const KeptSeries& other) {
    if (this != &other) shelf_ = std::make_shared<Shelf>();
    return *this;
}

RBDYN_INLINE BorrowedSeries::BorrowedSeries(const Program& program, int order, SeriesEvaluator::Use use)
    : shelf_(program.kept_series().shelf_), order_(order), use_(use) {
    {
        const std::lock_guard lock(shelf_->mutex);
        const auto found =
            std::find_if(shelf_->free.begin(), shelf_->free.end(), [&](const KeptSeries::Shelf::Kept& kept) {
                return kept.order == order && (kept.use == use || !kept.series->is_large());
            });
        if (found != shelf_->free.end()) {
            series_ = std::move(found->series);
            shelf_->free.erase(found);
        }
    }
    if (series_)
        series_->renew();
    else
        series_ = std::make_unique<SeriesEvaluator>(program, order, use);
}

RBDYN_INLINE BorrowedSeries::~BorrowedSeries() {
    // those of members side by side come back together
    constexpr std::size_t most_together = 1U << 20;
    const auto has_room = [](std::size_t count, std::size_t each) {
        return count < KeptSeries::Shelf::most || (count + 1) * each <= most_together;
    };
    using Shelf = KeptSeries::Shelf;
    const std::size_t bytes = series_->bytes();
    const bool is_long = bytes > Shelf::most_bytes;
    const bool has_code = series_->has_repeated_code() || series_->has_streamed_code();
    if (is_long && !(has_code && bytes + series_->bytes_of_lists() <= Shelf::most_bytes_of_long)) return;
    const std::lock_guard lock(shelf_->mutex);
    const auto longs = static_cast<std::size_t>(std::ranges::count_if(shelf_->free, &Shelf::Kept::is_long));
    if (is_long ? longs < Shelf::most_long : has_room(shelf_->free.size() - longs, bytes))
        shelf_->free.push_back({order_, use_, std::move(series_)});
}

}  // namespace rbdyn::inline RBDYN_FORM
