// The point that moments are about: fixed, moving as a function of time says, or with a body.
#pragma once

#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/functor.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/model/system_report.hpp"
#include "rbdyn/scene/handles.hpp"

namespace rbdyn::inline RBDYN_FORM {

class Pole {
public:
    struct Now {
        Vector3 place, velocity;
    };

    /// A point of the world [m]; its origin by default.
    Pole(const Vector3& point = Vector3::Zero());
    /// A particle or the centre of mass of a body; a point of a body.
    Pole(BodyHandle body) : pole_(body) {}
    Pole(const BodyPoint& point) : pole_(point) {}
    /// From a recorded function of time with three results.
    Pole(Function path);
    /// [](const auto& t) { return vector; }
    template <class F>
    requires(Takes<F, Expression> && !std::is_same_v<std::decay_t<F>, Function> &&
             !std::is_same_v<std::decay_t<F>, Pole>) Pole(F f)
        : Pole(Function::record(1, [&](const std::vector<Expression>& x) {
              const Vector3Of<Expression> r = recording::vector(f, x[0]);
              return std::vector<Expression>{r[0], r[1], r[2]};
          })) {}

    /// Where it is and how it moves. Throws InvalidInput for a handle that is none of the system's.
    Now at(double t, const SystemReport& system) const;

private:
    struct Path {
        Function place, velocity;
    };
    std::variant<Vector3, BodyHandle, BodyPoint, Path> pole_;
};

}  // namespace rbdyn::inline RBDYN_FORM
