// What a shared library exports: what rbdyn/rbdyn.hpp declares, with the headers that it includes. Each source includes
// this first, and is compiled with -fvisibility=hidden, so that the rest is hidden.
#pragma once

#include <Eigen/Geometry>

#pragma GCC visibility push(default)
#include "rbdyn/rbdyn.hpp"
#pragma GCC visibility pop
