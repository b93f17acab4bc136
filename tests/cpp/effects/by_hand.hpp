// Equations written out by hand, which never heard of scenes, loads or effects: those of proof.hpp's motions.
//
// Notation: g gravity, m mass; a hoop of radius 1 m by the angle u from its lowest point, w = u'. All numbers are short
// in binary, so that no way to write the equations rounds.
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/recorded_model.hpp"
#include "rbdyn/simulate.hpp"
#include "rbdyn/special/special_model.hpp"

namespace rbdyn::proof {

inline constexpr double g = 9.8125, mass = 0.5;
inline const Vector3 weight{0.0, 0.0, -g};

using Rates = EquationsWriter;
using S = Expression;

/// The start of what flies freely [m/s].
inline const Vector3 thrown{1.0, 0.5, 4.0};

/// What flies freely: x, y, z, and the velocity of z at `v` if there is gravity; that of x and y stays as it starts.
template <bool gravity>
void fly(Recorder& r, Rates& rates, int v) {
    for (int i = 0; i < 3; ++i) rates.rate(i) = thrown[i];
    if constexpr (gravity) {
        rates.rate(2) = r.input(v);
        rates.rate(v) = -g;
    }
}

/// A particle.
template <bool gravity>
struct FreeParticle {
    static constexpr int variables = gravity ? 4 : 3;
    static std::vector<VariableGroup> groups() {
        if constexpr (gravity) return {{0, 3, true}, {3, 1, false, thrown[0]}};
        return {{0, 3, true}};
    }
    static void write(Recorder& r, Rates& rates) { fly<gravity>(r, rates, 3); }
};

inline constexpr double linear_drag = 0.125, quadratic_drag = 0.0625, stiffness = 2.0, rest_length = 0.5;
inline const Vector3 anchor{0.5, 0.25, 3.0}, anchor_in_plane{0.5, 0.0, 3.0};

/// What acts on a particle or on a centre of mass besides its weight.
enum class Acting { drag, spring };

/// What flies in space, or in the plane of x and z, with a load.
template <Acting acting, bool is_plane>
struct LoadedFlight {
    static constexpr int n = is_plane ? 2 : 3, variables = 2 * n;
    static std::vector<VariableGroup> groups() { return {{0, n, true}, {n, n, false}}; }
    static void write(Recorder& r, Rates& rates) {
        Vector3Of<S> place{S(0.0), S(0.0), S(0.0)}, velocity = place, force{S(0.0), S(0.0), S(-mass * g)};
        const auto axis = [](int i) { return is_plane ? 2 * i : i; };
        for (int i = 0; i < n; ++i) {
            place[axis(i)] = r.input(i);
            velocity[axis(i)] = r.input(n + i);
        }
        if constexpr (acting == Acting::drag) {
            force -= velocity * (S(linear_drag) + S(quadratic_drag) * length(velocity, "speed"));
        } else {
            const Vector3Of<S> d = place - Vector3Of<S>(is_plane ? anchor_in_plane : anchor);
            force += d * S(-stiffness) + d * (S(stiffness * rest_length) / length(d, "length"));
        }
        for (int i = 0; i < n; ++i) {
            rates.rate(i) = velocity[axis(i)];
            rates.rate(n + i) = force[axis(i)] / S(mass);
        }
    }
};

/// What is thrown in the plane of x and z.
struct PlaneFlight {
    static constexpr int variables = 3;
    static std::vector<VariableGroup> groups() { return {{0, 2, true}, {2, 1, false, thrown[0]}}; }
    static void write(Recorder& r, Rates& rates) {
        rates.rate(0) = thrown[0];
        rates.rate(1) = r.input(2);
        rates.rate(2) = -g;
    }
};

/// What does not move.
struct Rest {
    static constexpr int variables = 0;
    static std::vector<VariableGroup> groups() { return {}; }
    static void write(Recorder&, Rates&) {}
};

/// One coordinate and its rate, which stays as it starts if nothing acts along it.
template <bool acts>
std::vector<VariableGroup> one_coordinate(bool is_position) {
    if constexpr (acts) return {{0, 1, is_position}, {1, 1, false}};
    return {{0, 1, is_position}};
}

/// A bead on a hoop: u, w.
template <bool gravity>
struct Hoop {
    static constexpr int variables = gravity ? 2 : 1;
    static std::vector<VariableGroup> groups() { return one_coordinate<gravity>(true); }
    static void write(Recorder& r, Rates& rates) {
        rates.rate(0) = 1.0;
        if constexpr (gravity) {
            rates.rate(0) = r.input(1);
            rates.rate(1) = -g * sin(r.input(0));
        }
    }
};

inline constexpr double mu_static = 1.0 / 32.0, mu_dynamic = 1.0 / 64.0;

/// The same with friction, while it slides forward.
template <bool gravity>
struct RoughHoop {
    static constexpr int variables = 2;
    static std::vector<VariableGroup> groups() { return {{0, 1, true}, {1, 1, false}}; }
    static void write(Recorder& r, Rates& rates) {
        // the numbers of a mode: which way it slides; where it is held, while it sticks
        const S slides = r.parameter(0);
        r.parameter(1);
        const S u = r.input(0), w = r.input(1);
        S press = mass * (w * w), pull = 0.0;
        if constexpr (gravity) {
            press += mass * g * cos(u);
            pull = -mass * g * sin(u);
        }
        rates.rate(0) = w;
        rates.rate(1) = (pull - mu_dynamic * slides * abs_of(press)) / S(mass);
        rates.guard({.kind = EventKind::reverse, .subject = 0, .sign_parameter = 0}, w);
    }
    static S abs_of(const S& x) { return length(Vector3Of<S>{S(0.0), S(0.0), x}, "normal reaction", 0); }
};

inline constexpr double mu_hold = 1.0, belt = 0.25;  // m/s

/// A bead that the surface of the hoop carries along, held by as much friction as there is when it slides.
struct CarriedBead {
    static constexpr int variables = 2;
    static constexpr signed char slip = sticks;
    static std::vector<VariableGroup> groups() { return {{0, 1, true}, {1, 1, false}}; }
    static void write(Recorder& r, Rates& rates) {
        r.parameter(1);
        const S u = r.input(0), w = r.input(1);
        const S press = mass * (w * w) + mass * g * cos(u), pull = mass * g * sin(u);
        rates.rate(0) = w;
        rates.guard({.kind = EventKind::slip, .subject = 0}, (mu_hold * mu_hold) * (press * press) - pull * pull);
        // to which side it slips where friction lets go
        rates.output(pull);
    }
};

/// A bead that the hoop holds by pushing it inward: u and a place for its flight, then their velocities.
template <bool gravity>
struct PushingHoop {
    static constexpr int variables = 8;
    static std::vector<VariableGroup> groups() { return {{0, 1, true}, {1, 3, true}, {4, 1, false}, {5, 3, false}}; }
    static void write(Recorder& r, Rates& rates) {
        const S u = r.input(0), w = r.input(4);
        S press = mass * (w * w);
        rates.rate(0) = w;
        if constexpr (gravity) {
            press += mass * g * cos(u);
            rates.rate(4) = -g * sin(u);
        }
        rates.guard({.kind = EventKind::detach, .subject = 0}, press);
    }
};

/// A bead on a hoop that is shaken: its height is sin(2t)/4.
template <bool gravity>
struct ShakenHoop {
    static constexpr int variables = 2;
    static std::vector<VariableGroup> groups() { return {{0, 1, true}, {1, 1, false}}; }
    static void write(Recorder& r, Rates& rates) {
        const S u = r.input(0), w = r.input(1), t = r.time();
        const S slope = sin(u);
        S pull = -mass * sin(2.0 * t);
        if constexpr (gravity) pull += mass * g;
        rates.rate(0) = w;
        rates.rate(1) = -(slope * pull) / S(mass);
    }
};

inline const Vector3 moments{0.875, 1.375, 1.75};
inline constexpr double arm = 0.5;  // of the centre of mass from the joint

/// A number of 32 digits, as constants that derive from others are.
inline DoubleDouble wide(double x) { return DoubleDouble(x); }

/// Euler's equations: quaternion at `q`, angular velocity at `v`, moments of inertia `I` and moment of forces `M`.
inline void turn(Recorder& r, Rates& rates, int q, int v, const Vector3& I, const std::array<S, 3>& M) {
    const S p0 = r.input(q), p1 = r.input(q + 1), p2 = r.input(q + 2), p3 = r.input(q + 3);
    const S w1 = r.input(v), w2 = r.input(v + 1), w3 = r.input(v + 2);
    rates.rate(q) = -0.5 * (p1 * w1 + p2 * w2 + p3 * w3);
    rates.rate(q + 1) = 0.5 * (p0 * w1 + p2 * w3 - p3 * w2);
    rates.rate(q + 2) = 0.5 * (p0 * w2 + p3 * w1 - p1 * w3);
    rates.rate(q + 3) = 0.5 * (p0 * w3 + p1 * w2 - p2 * w1);
    rates.rate(v) = S(wide(I[1] - I[2]) / wide(I[0])) * (w2 * w3) + M[0] / S(wide(I[0]));
    rates.rate(v + 1) = S(wide(I[2] - I[0]) / wide(I[1])) * (w3 * w1) + M[1] / S(wide(I[1]));
    rates.rate(v + 2) = S(wide(I[0] - I[1]) / wide(I[2])) * (w1 * w2) + M[2] / S(wide(I[2]));
}

/// A free body: place of its centre of mass, quaternion, velocity of z, angular velocity.
template <bool gravity>
struct FreeBody {
    static constexpr int variables = gravity ? 11 : 10;
    static std::vector<VariableGroup> groups() {
        if constexpr (gravity) return {{0, 3, true}, {3, 4, false}, {7, 1, false, thrown[0]}, {8, 3, false}};
        return {{0, 3, true}, {3, 4, false}, {7, 3, false}};
    }
    static void write(Recorder& r, Rates& rates) {
        fly<gravity>(r, rates, 7);
        turn(r, rates, 3, variables - 3, moments, {S(0.0), S(0.0), S(0.0)});
    }
};

inline constexpr double plane_spin = 3.0;

/// A body thrown in the plane of x and z that turns in it: x, z, the two numbers of its quaternion, velocity of z.
struct PlaneBody {
    static constexpr int variables = 5;
    static std::vector<VariableGroup> groups() { return {{0, 2, true}, {2, 2, false}, {4, 1, false, thrown[0]}}; }
    static void write(Recorder& r, Rates& rates) {
        const S p0 = r.input(2), p2 = r.input(3);
        rates.rate(0) = thrown[0];
        rates.rate(1) = r.input(4);
        rates.rate(2) = -p2 * S(0.5 * plane_spin);
        rates.rate(3) = p0 * S(0.5 * plane_spin);
        rates.rate(4) = -g;
    }
};

/// A body held at a point below its centre of mass: quaternion, angular velocity.
template <bool gravity>
struct HeldBody {
    static constexpr int variables = 7;
    static std::vector<VariableGroup> groups() { return {{0, 4, false}, {4, 3, false}}; }
    static void write(Recorder& r, Rates& rates) {
        const double more = mass * arm * arm;
        std::array<S, 3> moment{S(0.0), S(0.0), S(0.0)};
        if constexpr (gravity) {
            // the third components of the body's first two axes
            const S p0 = r.input(0), p1 = r.input(1), p2 = r.input(2), p3 = r.input(3);
            moment[0] = (2.0 * mass * g * arm) * (p2 * p3 + p0 * p1);
            moment[1] = (-2.0 * mass * g * arm) * (p1 * p3 - p0 * p2);
        }
        turn(r, rates, 0, 4, moments + Vector3(more, more, 0.0), moment);
    }
};

/// A pendulum: its angle, and the rate.
template <bool gravity>
struct Pendulum {
    static constexpr int variables = gravity ? 2 : 1;
    static std::vector<VariableGroup> groups() { return one_coordinate<gravity>(false); }
    static void write(Recorder& r, Rates& rates) {
        rates.rate(0) = 1.0;
        if constexpr (gravity) {
            rates.rate(0) = r.input(1);
            rates.rate(1) = -(mass * g * arm) * sin(r.input(0)) / S(wide(moments[1] + mass * arm * arm));
        }
    }
};

/// A body on a vertical slide.
template <bool gravity>
struct Slide {
    static constexpr int variables = gravity ? 2 : 1;
    static std::vector<VariableGroup> groups() { return one_coordinate<gravity>(true); }
    static void write(Recorder& r, Rates& rates) {
        rates.rate(0) = 4.0;
        if constexpr (gravity) {
            rates.rate(0) = r.input(1);
            rates.rate(1) = -g;
        }
    }
};

/// Hand-written equations as a model; what they conserve is held as in the library.
template <class Written>
class Bare : public RecordedModel {
public:
    explicit Bare(std::shared_ptr<const SpecialModel> holder) : holder_(std::move(holder)) {}
    int variables() const override { return Written::variables; }
    Mode begin(double t, std::span<double> x) const override {
        Mode mode;
        mode.slip = {slip()};
        choose(mode, t, x, {});
        return mode;
    }
    Mode next(const Mode&, std::span<const int>, double, std::span<double>, std::vector<Happening>&) const override {
        throw Error("no event is met by equations written for smooth motion");
    }

private:
    std::vector<signed char> kind_of(const Mode&) const override { return {}; }
    void own_parameters(Mode& mode, std::span<const double>) const override {
        if (!mode.parameters.empty()) mode.parameters[0] = slip();
    }
    static constexpr signed char slip() {
        if constexpr (requires { Written::slip; }) return Written::slip;
        return 1;
    }
    std::unique_ptr<Structure> record(const Mode&, const RecordedFor& state) const override {
        Recorder r;
        r.follow(state.t, state.x, std::array{1.0}, {}, {});
        EquationsWriter rates(r, Written::variables);
        Written::write(r, rates);
        auto result = rates.finish(Written::groups());
        result->equations.projection = holder_->equations({slip()}).projection;
        return result;
    }
    std::shared_ptr<const SpecialModel> holder_;  // knows how to hold first integrals
};

}  // namespace rbdyn::proof
