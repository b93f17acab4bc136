// Sorting what is short or nearly in order, by insertion: equals stay in the order they are in.
#pragma once

#include <cstddef>
#include <span>
#include <utility>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

template <class T, class Before>
void sort_few(std::span<T> all, const Before& before) {
    for (std::size_t i = 1; i < all.size(); ++i)
        for (std::size_t j = i; j > 0 && before(all[j], all[j - 1]); --j) std::swap(all[j], all[j - 1]);
}

}  // namespace rbdyn::inline RBDYN_FORM
