// Which way a quantity passes a zero.
#pragma once

namespace rbdyn {

enum class Direction { either, rising, falling };

}  // namespace rbdyn
