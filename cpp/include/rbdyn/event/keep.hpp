// What is asked of a run: what is kept of it, and which side of a jump a value is of.
#pragma once

#include <functional>
#include <vector>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Which side of a jump a value is asked for.
enum class Side { before, after };

/// What of a run is kept.
struct Keep {
    enum class What { all, end, times } what = What::all;
    std::vector<double> times = {};  // increasing
    bool winds = true;               // and, of times, what no state says (HybridModel::winding)
};

/// Called now and then with the time reached; false stops the run.
using Monitor = std::function<bool(double)>;

}  // namespace rbdyn::inline RBDYN_FORM
