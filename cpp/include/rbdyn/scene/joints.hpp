// Joints: how a body may move, and where its motion starts, in the joint's own words.
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "rbdyn/curve/curve.hpp"
#include "rbdyn/expression/time_function.hpp"

namespace rbdyn {

/// No constraint.
struct Free {};

/// Initial state of a free particle: position [m] and velocity [m/s], world axes.
struct FreeStart {
    Vector3 position = Vector3::Zero();
    Vector3 velocity = Vector3::Zero();
};

/// Coulomb-Morin friction (eq. 7.23): sliding, the tangential reaction is mu_dynamic times the perpendicular one,
/// against the slip; at rest it is whatever rest needs, up to mu_static times the perpendicular one.
struct Coulomb {
    double mu_static = 0.0;
    std::optional<double> mu_dynamic = std::nullopt;  // default: mu_static

    double dynamic() const { return mu_dynamic.value_or(mu_static); }
    bool present() const { return mu_static > 0.0 || dynamic() > 0.0; }
    void validate() const {
        require(std::isfinite(mu_static) && mu_static >= 0.0, "Coulomb", "mu_static", mu_static,
                "a friction coefficient is zero or positive and finite");
        require(std::isfinite(dynamic()) && dynamic() >= 0.0, "Coulomb", "mu_dynamic", dynamic(),
                "a friction coefficient is zero or positive and finite");
        require(dynamic() <= mu_static, "Coulomb", "mu_dynamic", dynamic(),
                "the dynamic coefficient is at most the static one, which is " + text(mu_static) +
                    "; exchange them, or make them equal");
    }
};

/// What happens when the bead reaches an end of its curve.
enum class RailEnds { stop };

/// Options of a rail beside its curve and friction.
struct RailOptions {
    TimeFunction drive = 0.0;  // speed with which the rail's surface slides along itself [m/s]
    RailEnds ends = RailEnds::stop;
};

/// A bilateral guide along a curve, smooth or rough (eqs. 7.7-7.17, 7.23-7.26).
class Rail {
public:
    Rail(Curve curve, std::optional<Coulomb> friction = std::nullopt, RailOptions options = {})
        : curve_(std::move(curve)), friction_(friction), options_(std::move(options)) {
        if (friction_) friction_->validate();
        if (options_.drive.is_constant())
            require(std::isfinite(options_.drive.constant()), "Rail", "drive", options_.drive.constant(),
                    "the speed of a rail's surface is finite; give it in m/s");
    }

    const Curve& curve() const { return curve_; }
    /// Friction, if any of its coefficients is not zero.
    std::optional<Coulomb> friction() const { return friction_ && friction_->present() ? friction_ : std::nullopt; }
    const TimeFunction& drive() const { return options_.drive; }
    RailEnds ends() const { return options_.ends; }

private:
    Curve curve_;
    std::optional<Coulomb> friction_;
    RailOptions options_;
};

/// Initial state on a rail: where (the curve's parameter or an arc length, one of them) and ds/dt along the curve as
/// placed [m/s]. Arc length counts from the beginning of the curve, or from u = 0 where it has none.
struct RailStart {
    std::optional<double> parameter = std::nullopt;
    std::optional<double> arc_length = std::nullopt;
    double speed = 0.0;
};

/// Where arc length counts from on a curve.
inline double arc_length_origin(const Curve& curve) {
    return std::isfinite(curve.domain().begin) ? curve.domain().begin : 0.0;
}

}  // namespace rbdyn
