// What errors of a motion are measured against: the scales of all that is seen of it.
//
// Positions are measured by the extent of their body's motion, axes by the angle it would turn by at its quickest or by
// its place over its radius of gyration, a radian at most, all else by its largest magnitude; of bodies that belong
// together by least_share() of the largest of their kind at least. What constraints hold at zero, and what is no more
// than rounding or the error wanted of what moves, is measured by what moves.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/model/equations.hpp"

namespace rbdyn::inline RBDYN_FORM {

struct Observed;

class ErrorScales {
public:
    void clear() { scales_.clear(); }

    /// All of it as numbers, and back.
    std::vector<double> numbers() const;
    static ErrorScales of(std::span<const double> numbers);

    /// Takes what is seen at a time into account.
    void widen(std::span<const Observed> seen);

    /// Whatever is seen has been; from here on errors are asked for. `wanted`: the error of the motion; `span`: its
    /// time [s].
    void settle(double wanted, double span);

    /// A difference over its scale.
    double relative(std::size_t what, double difference) const;
    /// What the rounding of sums of a few terms is over their scales; and of which it is most, -1: of none.
    double rounding() const;
    int most_rounded() const;

private:
    double rounding_of(std::size_t what) const;

    struct Scale {
        Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity());
        Vector3 high = Vector3::Constant(-std::numeric_limits<double>::infinity());
        double size = 0.0, whole = 0.0, from = 0.0, gyration = 0.0, scale = 0.0, drive = 0.0;
        bool is_position = false, is_any = false;
        Alike alike = Alike::nothing;
        float held = 0.0F;
    };
    static constexpr std::size_t kinds = 5, numbers_each = 14;

    std::vector<Scale> scales_;
};

}  // namespace rbdyn::inline RBDYN_FORM
