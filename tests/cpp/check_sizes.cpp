// Every test program holds what its runs count against what plans say.
#include "rbdyn/simulate.hpp"

namespace {
[[maybe_unused]] const bool checked = (rbdyn::simulating::check_sizes(true), true);
}
