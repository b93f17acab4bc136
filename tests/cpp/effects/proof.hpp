// Nothing unused is paid: for each kind of motion and each effect four models of the same motion.
//
//   without   the scene without the effect
//   zero      the effect is in the scene, and zero: a coefficient, a field, a traced function times a parameter of zero
//   bare      the equations written out by hand, which never heard of scenes, loads or effects
//   on        the effect is in the scene and acts
// The first three are the same motion: the same states bit for bit, the same work, the same instructions.
//
// Notation: g gravity, m mass; a hoop of radius 1 m by the angle u from its lowest point, w = u'. All numbers are short
// in binary, so that no way to write the equations rounds.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/simulate.hpp"

namespace rbdyn::proof {

inline constexpr double g = 9.8125, mass = 0.5;
inline const Vector3 weight{0.0, 0.0, -g};

// --- equations by hand ---

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
    explicit Bare(std::shared_ptr<const PointsModel> holder) : holder_(std::move(holder)) {}
    int variables() const override { return Written::variables; }
    Mode begin(double t, std::span<double> x) const override {
        Mode mode;
        mode.slip = {1};
        choose(mode, t, x, {});
        return mode;
    }
    Mode next(const Mode&, std::span<const int>, double, std::span<double>, std::vector<Happening>&) const override {
        throw Error("no event is met by equations written for smooth motion");
    }

private:
    std::vector<signed char> kind_of(const Mode&) const override { return {}; }
    void own_parameters(Mode& mode, std::span<const double>) const override {
        if (!mode.parameters.empty()) mode.parameters[0] = 1.0;
    }
    std::unique_ptr<Structure> record(const Mode&, const RecordedFor& state) const override {
        Recorder r;
        r.follow(state.t, state.x, std::array{1.0}, {}, {});
        EquationsWriter rates(r, Written::variables);
        Written::write(r, rates);
        auto result = rates.finish(Written::groups());
        result->equations.projection = holder_->equations({1}).projection;
        return result;
    }
    std::shared_ptr<const PointsModel> holder_;  // knows how to hold first integrals
};

// --- scenes ---

enum class Variant { without, zero, on };

/// One kind of motion.
struct Kind {
    std::string name;
    double until;
    std::vector<std::string> effects;  // those that can be absent from it
    /// The body, in a scene with gravity or not; `rail`: what its rail has besides, if it is on one.
    BodyHandle (*add)(Scene& scene, const RailOptions& more, std::optional<Coulomb> friction);
    std::unique_ptr<HybridModel> (*bare)(std::shared_ptr<const PointsModel> holder, bool gravity);
};

inline Circle hoop() { return {.radius = 1.0, .start = {0, 0, -1}, .toward = {1, 0, 0}}; }

template <template <bool> class Written>
std::unique_ptr<HybridModel> bare(std::shared_ptr<const PointsModel> holder, bool gravity) {
    if (gravity) return std::make_unique<Bare<Written<true>>>(std::move(holder));
    return std::make_unique<Bare<Written<false>>>(std::move(holder));
}

inline RigidMotion shaken(const Parameter& height) {
    return RigidMotion::translation([&](const auto& t) {
        using T = std::decay_t<decltype(t)>;
        return Vector3Of<T>{T(0.0), T(0.0), T(height) * sin(2.0 * t)};
    });
}

inline std::vector<Kind> kinds() {
    const std::vector<std::string> on_bodies{"gravity", "spring", "damper", "drag", "user force", "user torque"};
    std::vector<std::string> on_rails{"gravity",    "spring",      "damper",           "drag",
                                      "user force", "moving rail", "dynamic friction", "static friction"};
    return {
        {"particle, free",
         2.0,
         {"gravity", "spring", "damper", "drag", "user force"},
         [](Scene& s, const RailOptions&, std::optional<Coulomb>) {
             return s.add(Particle{mass}, FreeStart{{0.0, 0.0, 1.0}, thrown});
         },
         &bare<FreeParticle>},
        {"rail", 10.0, on_rails,
         [](Scene& s, const RailOptions& more, std::optional<Coulomb> friction) {
             return s.add(Particle{mass}, Rail(hoop(), friction, more), {.parameter = 2.0, .speed = 1.0});
         },
         &bare<Hoop>},
        {"rough rail",
         2.0,
         {"gravity", "spring", "damper", "drag", "user force", "drive", "moving rail"},
         [](Scene& s, const RailOptions& more, std::optional<Coulomb>) {
             return s.add(Particle{mass}, Rail(hoop(), Coulomb{mu_static, mu_dynamic}, more), {.speed = 16.0});
         },
         &bare<RoughHoop>},
        {"one-sided rail",
         2.0,
         {"gravity", "spring", "damper", "drag", "user force", "dynamic friction", "static friction"},
         [](Scene& s, const RailOptions& more, std::optional<Coulomb> friction) {
             RailOptions pushing = more;
             pushing.side = RailSide::plus;
             return s.add(Particle{mass}, Rail(hoop(), friction, pushing), {.speed = 16.0});
         },
         &bare<PushingHoop>},
        {"moving rail",
         10.0,
         {"gravity", "spring", "damper", "drag", "user force", "dynamic friction", "static friction"},
         [](Scene& s, const RailOptions& more, std::optional<Coulomb> friction) {
             RailOptions moving = more;
             moving.motion = shaken(Parameter(0.25));
             return s.add(Particle{mass}, Rail(hoop(), friction, moving), {.parameter = 2.0, .speed = 1.0});
         },
         &bare<ShakenHoop>},
        {"body, free", 10.0, on_bodies,
         [](Scene& s, const RailOptions&, std::optional<Coulomb>) {
             return s.add(RigidBody(mass, moments),
                          BodyStart{.velocity = thrown, .angular_velocity = Vector3(0.25, 3.0, 0.5)});
         },
         &bare<FreeBody>},
        {"body, spherical", 10.0, on_bodies,
         [](Scene& s, const RailOptions&, std::optional<Coulomb>) {
             return s.add(RigidBody(mass, moments), Spherical{.point = {0.0, 0.0, -arm}},
                          {.angular_velocity = Vector3(0.25, 3.0, 0.5)});
         },
         &bare<HeldBody>},
        {"body, revolute", 10.0, on_bodies,
         [](Scene& s, const RailOptions&, std::optional<Coulomb>) {
             return s.add(RigidBody(mass, moments), Revolute{.axis = {0, 1, 0}, .point = {0.0, 0.0, arm}},
                          {.angle = 2.0, .rate = 1.0});
         },
         &bare<Pendulum>},
        {"body, prismatic",
         2.0,
         {"gravity", "spring", "damper", "drag", "user force"},
         [](Scene& s, const RailOptions&, std::optional<Coulomb>) {
             return s.add(RigidBody(mass, moments), Prismatic{.axis = {0, 0, 1}}, {.displacement = 1.0, .rate = 4.0});
         },
         &bare<Slide>},
    };
}

/// A scene of a kind with an effect, without it, or with one that is zero.
inline Scene scene_of(const Kind& kind, const std::string& effect, Variant variant) {
    const bool is_there = variant != Variant::without, acts = variant == Variant::on;
    const auto amount = [&](double x) { return acts ? x : 0.0; };
    const Parameter factor(amount(1.0));
    Scene scene;
    if (effect != "gravity") scene.set_gravity(weight);
    if (effect == "gravity" && is_there) scene.set_gravity(amount(1.0) * weight);
    RailOptions rail;
    std::optional<Coulomb> friction;
    if (is_there) {
        if (effect == "drive") rail.drive = [&](const auto& t) { return S(factor) * sin(t); };
        if (effect == "moving rail") rail.motion = shaken(Parameter(amount(0.25)));
        if (effect == "static friction") friction = Coulomb{amount(mu_static), 0.0};
        if (effect == "dynamic friction") friction = Coulomb{amount(mu_dynamic), amount(mu_dynamic)};
    }
    const BodyHandle body = kind.add(scene, rail, friction);
    if (!is_there) return scene;
    const Vector3 anchor{0.5, 0.25, 3.0};
    if (effect == "spring") scene.connect(Spring{.stiffness = amount(2.0), .rest_length = 0.5}, body, anchor);
    if (effect == "damper") scene.connect(Spring{.damping = amount(0.25)}, body, anchor);
    if (effect == "drag") scene.apply(Drag{.linear = amount(0.125), .quadratic = amount(0.0625)}, body);
    if (effect == "user force")
        scene.apply(
            Force([&](const auto&, const auto& r, const auto& v) {
                using T = std::decay_t<decltype(r[0])>;
                const T k = factor;
                return Vector3Of<T>{-k * (r[0] - 0.5) - 0.125 * k * v[1], 0.125 * k * v[0] - k * r[1], -k * r[2]};
            }),
            body);
    if (effect == "user torque")
        scene.apply(Torque([&](const auto&, const auto&, const auto& omega) {
                        using T = std::decay_t<decltype(omega[0])>;
                        const T k = 0.125 * S(factor);
                        return Vector3Of<T>{-k * omega[0], -k * omega[1], -k * omega[2]};
                    }),
                    body);
    return scene;
}

/// The model of a scene as a run has it.
inline std::shared_ptr<const PointsModel> model_of(const Scene& scene) { return make_plan(scene.frozen()).model; }

/// The hand-written model of a kind whose scene is without an effect.
inline std::unique_ptr<HybridModel> bare_of(const Kind& kind, const std::string& effect) {
    return kind.bare(model_of(scene_of(kind, effect, Variant::without)), effect != "gravity");
}

/// One integration, as every run of simulate() makes; local tolerance 1e-12.
inline constexpr double tolerance = 1e-12;
inline Record integrated(const HybridModel& model, const std::vector<double>& x, double until) {
    TaylorEngine engine(tolerance);
    Driver driver(model, engine, 100'000'000, {}, {}, tolerance * until);
    return driver.run(0.0, x, until);
}

}  // namespace rbdyn::proof
