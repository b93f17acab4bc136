// Everything in rbdyn.
#pragma once

namespace rbdyn {
inline constexpr const char* version = "0.1.0";
}
