// The joints of a tree: of each how its body moves against its parent.
//
// Every joint has move(parent, q, v), which places its body and says what its velocities add; a driven one is a
// function of time. Positions change as their velocities say, but for attitudes.
#pragma once

#include <type_traits>
#include <variant>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/mechanics/joint/cylindrical.hpp"
#include "rbdyn/mechanics/joint/driven.hpp"
#include "rbdyn/mechanics/joint/fixed.hpp"
#include "rbdyn/mechanics/joint/free.hpp"
#include "rbdyn/mechanics/joint/held.hpp"
#include "rbdyn/mechanics/joint/loose_rail.hpp"
#include "rbdyn/mechanics/joint/planar.hpp"
#include "rbdyn/mechanics/joint/prismatic.hpp"
#include "rbdyn/mechanics/joint/rail.hpp"
#include "rbdyn/mechanics/joint/revolute.hpp"
#include "rbdyn/mechanics/joint/spherical.hpp"
#include "rbdyn/mechanics/joint/universal.hpp"
#include "rbdyn/mechanics/moving.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

class JointLaw {
public:
    using Kind = std::variant<FreePointLaw, FreeBodyLaw, RailLaw, SphericalLaw, RevoluteLaw, PrismaticLaw, UniversalLaw,
                              CylindricalLaw, PlanarLaw, FixedLaw, DrivenLaw, LooseRailLaw>;

private:
    /// f(law) of the law there is: as std::visit, with less to compile.
    template <std::size_t i = 0, class F>
    decltype(auto) asked(const F& f) const {
        if constexpr (i + 1 < std::variant_size_v<Kind>) {
            if (kind_.index() != i) return asked<i + 1>(f);
        }
        return f(*std::get_if<i>(&kind_));
    }

public:
    JointLaw() = default;
    template <class Law>
    requires std::is_constructible_v<Kind, const Law&> JointLaw(const Law& law) : kind_(law) {}

    int positions() const {
        return asked([](const auto& law) { return law.positions; });
    }
    int velocities() const {
        return asked([](const auto& law) { return law.velocities; });
    }
    const Held& held() const {
        return asked([](const auto& law) -> const Held& { return law; });
    }
    /// Takes the offset, given from the origin of the parent's axes, from its P.
    void shift(const Vector3Of<DoubleDouble>& held) {
        std::visit([&](Held& law) { law.offset -= held; }, kind_);
    }
    template <class Law>
    const Law* as() const {
        return std::get_if<Law>(&kind_);
    }

    /// The rail of a bead, also of one that may leave it.
    const RailLaw* rail() const {
        const RailLaw* law = as<RailLaw>();
        return law != nullptr ? law : as<LooseRailLaw>();
    }
    bool flies() const { return as<LooseRailLaw>() != nullptr && as<LooseRailLaw>()->flies; }
    void set_flying() { std::get<LooseRailLaw>(kind_).flies = true; }

    template <class S>
    Moving<S> move(const Moving<S>& parent, const S& t, const S* q, const S* v) const {
        return asked([&](const auto& law) {
            if constexpr (requires { law.template move<S>(parent, t); })
                return law.template move<S>(parent, t);
            else if constexpr (requires { law.template move<S>(parent, t, q, v); })
                return law.template move<S>(parent, t, q, v);
            else
                return law.template move<S>(parent, q, v);
        });
    }

    /// The first position that is part of a quaternion, and the first velocity that is part of an angular velocity in
    /// world axes; -1 if there is none.
    int attitude() const { return as<FreeBodyLaw>() != nullptr ? 3 : as<SphericalLaw>() != nullptr ? 0 : -1; }

    /// The rates of the positions.
    template <class S>
    void rates(const S* q, const S* v, S* rate) const {
        const int first = attitude();
        for (int k = 0; k < (first < 0 ? positions() : first); ++k) rate[k] = v[k];
        if (first >= 0) quaternion_rate<S>(q + first, Vector3Of<S>(v[first], v[first + 1], v[first + 2]), rate + first);
    }

private:
    Kind kind_;
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
