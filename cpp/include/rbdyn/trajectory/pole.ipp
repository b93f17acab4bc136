// Definitions of rbdyn/trajectory/pole.hpp.
#pragma once

#include "rbdyn/trajectory/pole.hpp"

#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/model/system_report.hpp"
#include "rbdyn/scene/handles.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Pole::Pole(const Vector3& point) : pole_(point) {
    for (int i = 0; i < 3; ++i)
        require(std::isfinite(point[i]), "Trajectory", "component " + std::to_string(i) + " of pole", point[i],
                "a pole is finite, in m");
}

RBDYN_INLINE Pole::Pole(Function path) {
    if (path.inputs() != 1 || path.outputs() != 3)
        throw InvalidInput("Trajectory: the function of the pole has " + std::to_string(path.inputs()) +
                           " inputs and " + std::to_string(path.outputs()) +
                           " results; it is of time and has three coordinates, in m");
    Function velocity = path.derivative(0);
    pole_ = Path{std::move(path), std::move(velocity)};
}

RBDYN_INLINE Pole::Now Pole::at(double t, const SystemReport& system) const {
    const auto body = [&](int index) -> const BodyReport& {
        require(index >= 0 && index < static_cast<int>(system.bodies.size()), "Trajectory", "body of the pole", index,
                "a handle comes from the scene of this run");
        return system.bodies[static_cast<std::size_t>(index)];
    };
    if (const Vector3* point = std::get_if<Vector3>(&pole_)) return {*point, Vector3::Zero()};
    if (const BodyHandle* handle = std::get_if<BodyHandle>(&pole_)) {
        const BodyReport& b = body(handle->index);
        return {b.position, b.velocity};
    }
    if (const BodyPoint* point = std::get_if<BodyPoint>(&pole_)) {
        const BodyReport& b = body(point->body);
        return {b.place(point->point), b.velocity_of(point->point)};
    }
    const Path& path = std::get<Path>(pole_);
    const auto value = [&](const Function& f) {
        const std::vector<double> y = f(std::span<const double>(&t, 1));
        return Vector3(y[0], y[1], y[2]);
    };
    return {value(path.place), value(path.velocity)};
}

}  // namespace rbdyn::inline RBDYN_FORM
