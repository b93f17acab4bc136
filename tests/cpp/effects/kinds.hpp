// Kinds of motion, and scenes of each with an effect, without it, and with one that is zero.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "by_hand.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/special/special_model.hpp"

namespace rbdyn::proof {

enum class Variant { without, zero, on };

/// One kind of motion.
struct Kind {
    std::string name;
    double until;
    std::vector<std::string> effects;  // those that can be absent from it
    /// The body, in a scene with gravity or not; `rail`: what its rail has besides, if it is on one.
    BodyHandle (*add)(Scene& scene, const RailOptions& more, std::optional<Coulomb> friction);
    std::unique_ptr<HybridModel> (*bare)(std::shared_ptr<const SpecialModel> holder, bool gravity);
};

inline Circle hoop() { return {.radius = 1.0, .start = {0, 0, -1}, .toward = {1, 0, 0}}; }

template <template <bool> class Written>
std::unique_ptr<HybridModel> bare(std::shared_ptr<const SpecialModel> holder, bool gravity) {
    if (gravity) return std::make_unique<Bare<Written<true>>>(std::move(holder));
    return std::make_unique<Bare<Written<false>>>(std::move(holder));
}

/// `height`: a number, or one of the user's.
template <class Number>
RigidMotion shaken(const Number& height) {
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
             moving.motion = shaken(0.25);
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
    if (effect == "spring")
        scene.connect(Spring{.stiffness = amount(stiffness), .rest_length = rest_length}, body, anchor);
    if (effect == "damper") scene.connect(Spring{.damping = amount(0.25)}, body, anchor);
    if (effect == "drag") scene.apply(Drag{.linear = amount(linear_drag), .quadratic = amount(quadratic_drag)}, body);
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

}  // namespace rbdyn::proof
