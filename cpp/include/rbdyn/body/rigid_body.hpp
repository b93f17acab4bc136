// A rigid body: mass, centre of mass and inertia, in axes that are fixed in it.
//
//   I_Q, off the diagonal -Int rho x_i x_j                                                    (eq. 7.33 and its proof)
//   gyroscope: two equal principal moments about G                                            (Def. 7.4)
//   balanced about an axis: I_13 = I_23 = 0 and G on it, a principal axis about G     (7.47 on a fixed axis)
//
// What the user gave is kept as it was given; sums, shifts, turns and other points are computed in 32 digits from it,
// so that a body welded of pieces has the digits of the whole. Invariant: the moments about the centre of mass are
// those of some distribution of mass (validation.hpp).
#pragma once

#include <optional>
#include <string>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_vector.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/body/mass_properties.hpp"
#include "rbdyn/body/principal_axes.hpp"
#include "rbdyn/rotation/attitude.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What an inertia is about: the centre of mass, or the origin of the body's axes.
enum class InertiaAbout { com, origin };

/// Three principal moments along the body's axes, or the whole tensor [kg m^2].
struct Inertia {
    Matrix3 tensor;

    Inertia(double i1, double i2, double i3) : Inertia(Vector3(i1, i2, i3)) {}
    /// From a vector of three or a matrix, or an expression of Eigen's that makes one.
    template <class Derived>
    Inertia(const Eigen::MatrixBase<Derived>& given) {
        if constexpr (Derived::IsVectorAtCompileTime) {
            tensor.setZero();
            for (int i = 0; i < 3; ++i) tensor(i, i) = given[i];
        } else {
            tensor = given;
        }
    }
};

struct RigidBodyOptions {
    Vector3 com = Vector3::Zero();  // centre of mass, from the body's origin [m]
    InertiaAbout inertia_about = InertiaAbout::com;
};

/// What a body asks of the bearings of an axis that is fixed in it, by its motion alone; body axes. Turning at a rate w
/// about it the reaction is -w^2 offset, its moment about the point of the axis w^2 couple (7.47).
struct Imbalance {
    Vector3 offset;  // m times the way from the axis to G, across it [kg m]
    Vector3 couple;  // e x I e, e the direction of the axis, I about the point [kg m^2]
};

class RigidBody {
public:
    /// RigidBody(1.0, {0.5, 0.5, 0.25}, {.com = {0, 0, 0.5}, .inertia_about = InertiaAbout::origin})
    /// Throws InvalidInput if no distribution of mass has these properties.
    RigidBody(double mass, const Inertia& inertia, const RigidBodyOptions& options = {});
    /// From numbers of 32 digits. Throws InvalidInput as above; `body` names it then.
    explicit RigidBody(MassProperties given, InertiaAbout about = InertiaAbout::com, const std::string& body = name);

    /// [kg]
    double mass() const { return static_cast<double>(given_.mass); }
    /// Centre of mass, from the body's origin, body axes [m].
    Vector3 com() const { return rounded(given_.com); }
    /// What the inertia was given about, and what was given [kg m^2], in 32 digits and rounded.
    InertiaAbout inertia_about() const { return about_; }
    const MassProperties& given() const { return given_; }
    Matrix3 given_inertia() const { return rounded(given_.inertia); }

    /// I_G, I about the origin, or about any point of the body [m]; body axes [kg m^2].
    Matrix3 inertia(InertiaAbout about = InertiaAbout::com) const;
    Matrix3 inertia(const Vector3& point) const { return rounded(inertia_exact(point)); }
    /// The same in 32 digits.
    const Matrix3Of<DoubleDouble>& inertia_exact() const { return central_.inertia; }
    Matrix3Of<DoubleDouble> inertia_exact(const Vector3& point) const;
    /// Mass, centre of mass and I_G in 32 digits.
    const MassProperties& exact() const { return central_; }

    /// Principal moments and axes about the centre of mass, or about any point of the body [m]: in the order in which
    /// they lie nearest to the body's axes, right-handed.
    PrincipalAxes principal() const { return rounded(principal_exact()); }
    PrincipalAxes principal(const Vector3& point) const { return rounded(principal_exact(point)); }
    PrincipalAxesOf<DoubleDouble> principal_exact() const { return principal_axes(central_.inertia); }
    PrincipalAxesOf<DoubleDouble> principal_exact(const Vector3& point) const;

    /// Whether two principal moments about the centre of mass differ by at most rtol of the larger (Def. 7.4).
    bool is_gyroscope(double rtol = 1e-9) const { return gyroscope_axis(rtol).has_value(); }
    /// The unit vector e3 of Def. 7.4, body axes; of a body with three equal moments the body's third axis or what is
    /// principal nearest to it; nothing if no two are equal.
    std::optional<Vector3> gyroscope_axis(double rtol = 1e-9) const;

    /// About an axis through a point of the body, body axes [m].
    Imbalance imbalance(const Vector3& axis, const Vector3& point = Vector3::Zero()) const;
    /// Whether it turns about the axis without asking anything of its bearings: whether that is a principal axis about
    /// the centre of mass, to rtol of the moments about the point and of mass times radius of gyration.
    bool is_balanced(const Vector3& axis, const Vector3& point = Vector3::Zero(), double rtol = 1e-9) const;

    /// Whether a principal moment about the centre of mass is zero to the rounding of what was given: all mass lies on
    /// a line, and nothing resists a spin about it.
    bool is_rod() const { return rod_axis().has_value(); }
    /// Whether all three are: all mass lies in a point.
    bool is_point() const;
    /// The line's direction, body axes; of a point any.
    std::optional<Vector3> rod_axis() const;

    /// Moved by r in its own axes [m]: what was at the origin is at r.
    RigidBody shifted(const Vector3& r) const;
    /// Turned about the origin of its axes: what lay along v lies along R v.
    RigidBody rotated(const Attitude& attitude) const { return RigidBody(turned(central_, attitude.exact())); }
    /// Two bodies in the same axes, welded.
    friend RigidBody operator+(const RigidBody& a, const RigidBody& b) {
        return RigidBody(welded(a.central_, b.central_));
    }

    /// Whether the same was given, in all digits.
    bool operator==(const RigidBody& other) const { return given_ == other.given_ && about_ == other.about_; }

private:
    static constexpr const char* name = "RigidBody";

    /// The numbers of one body, each by itself.
    static MassProperties checked(double mass, const Inertia& inertia, const RigidBodyOptions& options);

    double given_size() const { return largest(rounded(given_.inertia)); }

    MassProperties given_;
    InertiaAbout about_ = InertiaAbout::com;
    MassProperties central_;
};

}  // namespace rbdyn::inline RBDYN_FORM
