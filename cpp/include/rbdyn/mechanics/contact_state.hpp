// What a contact does in a mode, as its number in Mode::slip, and what a mode remembers of it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/mechanics/contact.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace mechanics {

/// Open (flies); closed and smooth: it pushes, or rests, its force one of many that the motion does not determine.
/// Closed and rough: it slides, in a direction that stays what it is across the normal, in one that turns, or, where
/// the speed is so small that its direction is rounding, in the last direction there was, or, where it starts from
/// rest, in that of its first acceleration, or in one that is a polynomial in time where it has none (curves); or it is
/// held, along those of three axes that are rows of their own (Touching::held_axis). What slides, its force one of
/// many, rests in a direction that stays, or veers with its slip, or sets out or bends where another one starts or
/// curves.
namespace contact_state {

inline constexpr signed char pushes = 1, rests = 3, straight = 4, turning = 5, brief = 6, starts = 7, curves = 8,
                             held = 9, veers = 17, sets_out = 18, bends = 19;

inline bool slides(signed char state) { return state >= straight && state <= curves; }
inline bool is_held(signed char state) { return state >= held && state < veers; }
/// Whether its normal force is a number of the mode, one of many.
inline bool is_given(signed char state) { return state == rests || state >= veers; }
/// Whether it slides in the direction that its slip has.
inline bool follows_slip(signed char state) { return state == turning || state == veers; }
/// Whether it starts from rest in a direction that stays, and whether its direction is a polynomial in time.
inline bool is_start(signed char state) { return state == starts || state == sets_out; }
inline bool is_curved(signed char state) { return state == curves || state == bends; }
/// What slides as another does whose force is one of many, and the other way round.
inline signed char given(signed char own) {
    return own == turning ? veers : own == starts ? sets_out : own == curves ? bends : rests;
}
inline signed char own(signed char given) {
    return given == veers ? turning : given == sets_out ? starts : given == bends ? curves : straight;
}
/// Whether what is held is so by a row of its own along an axis of the world.
inline bool is_row(signed char state, int axis) { return is_held(state) && ((state - held) >> axis & 1) != 0; }
inline const char* word(signed char state) { return state == flies ? "open" : is_held(state) ? "sticks" : "slides"; }

/// A speed so small that nothing is measured by it, the square of which is a number [m/s].
inline constexpr double least_speed = 1e-100;

/// Whether it remembers something that its equations need.
inline bool has_numbers(const ContactLaw& contact, signed char state) {
    return is_given(state) || (contact.is_rough() && state != flies);
}

}  // namespace contact_state

/// What a mode remembers of a resistance, behind what it does of contacts; it does what a contact does that slides or
/// is held: straight, turning, brief, starts, held.
struct ResistanceMemory {
    static constexpr int numbers = 3;  // its equations know them all

    double along[2] = {};  // the direction it turns in
    double least = 0.0;    // an angular velocity below which the direction is rounding [rad/s]; of an idle one a torque

    /// Whether a mode's equations take them.
    static bool has_numbers(const Resistance& law, signed char state) {
        return contact_state::slides(state) || (law.idle && contact_state::is_held(state));
    }
    static ResistanceMemory of(const double* m) { return {{m[0], m[1]}, m[2]}; }
    void put(double* m) const {
        m[0] = along[0];
        m[1] = along[1];
        m[2] = least;
    }
};

/// Mode::memory: when anything struck last [s], then of each contact what follows.
struct ContactMemory {
    static constexpr int terms = 8;  // of a direction that curves
    static constexpr int parameters = 12, more = terms + 1, numbers = parameters + more + 2;

    Vector3 axis = Vector3::Zero();  // it slides along axis x normal
    double least = 0.0;              // a speed below which the direction of sliding is rounding [m/s]
    // what it exerts along axes that are no rows of their own: force + rate (t - since) [N, N/s, s]
    Vector3 force = Vector3::Zero(), rate = Vector3::Zero();
    double since = 0.0;
    bool keeps = false;  // its body stands flat, slides straight and does not turn
    // it curves: by which angle from its axis, a polynomial in t - since without its first coefficient, and until when
    double angle[terms] = {}, until = 0.0;
    bool shares = false;   // it is held, and the motion does not determine its force
    bool at_edge = false;  // it slides, and has begun at the edge of its cone without an acceleration

    static std::size_t place(int contact) { return static_cast<std::size_t>(1 + numbers * contact); }
    /// How many of the numbers its equations know, the first ones.
    static int known(signed char state) { return contact_state::is_curved(state) ? parameters + more : parameters; }
    static ContactMemory of(const std::vector<double>& memory, int contact) {
        const double* const m = memory.data() + place(contact);
        ContactMemory result{{m[0], m[1], m[2]}, m[3], {m[4], m[5], m[6]},   {m[7], m[8], m[9]}, m[10],
                             m[11] != 0.0,       {},   m[parameters + terms]};
        std::copy(m + parameters, m + parameters + terms, result.angle);
        result.shares = m[parameters + 1 + terms] != 0.0;
        result.at_edge = m[parameters + 2 + terms] != 0.0;
        return result;
    }
    void put(std::vector<double>& memory, int contact) const {
        double* const m = memory.data() + place(contact);
        const double all[parameters] = {axis[0],  axis[1], axis[2], least,   force[0], force[1],
                                        force[2], rate[0], rate[1], rate[2], since,    keeps ? 1.0 : 0.0};
        std::copy(all, all + parameters, m);
        std::copy(angle, angle + terms, m + parameters);
        m[parameters + terms] = until;
        m[parameters + 1 + terms] = shares ? 1.0 : 0.0;
        m[parameters + 2 + terms] = at_edge ? 1.0 : 0.0;
    }
};

}  // namespace mechanics

}  // namespace rbdyn::inline RBDYN_FORM
