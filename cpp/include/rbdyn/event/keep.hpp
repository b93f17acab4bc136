// What is asked of a run: what is kept of it and of its events, and which side of a jump a value is of.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// Which side of a jump a value is asked for.
enum class Side { before, after };

/// What of a run is kept.
struct Keep {
    enum class What { all, end, times } what = What::all;
    std::vector<double> times = {};  // in any order
    bool winds = true;               // and, of times, what no state says (HybridModel::winding)
};

struct Event;  // event/event.hpp

/// What of the events of a run is kept.
struct KeepEvents {
    /// all; or the last of each kind, name and subject, with the count of those it stands for.
    enum class What { all, last } what = What::all;
    /// Called with each event of the run that is returned, once and in order; then those alone are kept that end it.
    /// While it runs where nothing is held against it (`rtol`) and it is one part, else when it is judged.
    std::function<void(const Event&)> each = {};

    bool keeps_all() const { return what == What::all && !each; }
};

/// Called now and then with the time reached; false stops the run.
using Monitor = std::function<bool(double)>;

/// Called with a sentence on what whoever runs should know before it is over: that it needs more memory than there is.
using Warn = std::function<void(const std::string&)>;

}  // namespace rbdyn::inline RBDYN_FORM
