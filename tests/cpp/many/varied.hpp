// Scenes of many kinds, and starts that are drawn for them.
#pragma once

#include <optional>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "random.hpp"
#include "rbdyn/rbdyn.hpp"

namespace rbdyn::test::varied {

using Number = Expression;
using Vector = Vector3Of<Expression>;

inline const Vector3 down(0.0, 0.0, -9.81);
inline const Circle hoop{.radius = 1.0, .start = {0, 0, -1}, .toward = {1, 0, 0}};
inline const RigidBody brick = shapes::box(1.0, {0.1, 0.2, 0.3});
inline const RigidBody bar(1.0, Inertia{0.5, 0.5, 0.25}, {.com = {0, 0, -0.5}});

/// A number for a start: often one of those that make a plan another.
inline double drawn(Random& random, double before) {
    switch (random.whole(0, 5)) {
        case 0: return 0.0;
        case 1: return before;
        case 2: return -before;
        case 3: return 0.5;
        default: return random.uniform(-1.0, 1.0);
    }
}

/// Another start in the same words.
inline Start drawn(Random& random, Start start) {
    const auto change = [&](auto&... parts) { ((parts = drawn(random, parts)), ...); };
    const auto change_vector = [&](Vector3& v) {
        for (int i = 0; i < 3; ++i) v[i] = drawn(random, v[i]);
    };
    const auto change_turning = [&](auto& s) {
        if (random.chance(0.3))
            s.attitude = EulerAngles{random.uniform(0.1, 3.0), random.uniform(-3, 3), drawn(random, 0.2)};
        Vector3 omega = s.angular_velocity.value_or(Vector3::Zero());
        change_vector(omega);
        s.angular_velocity.reset();
        s.angular_velocity_world.reset();
        (random.chance(0.7) ? s.angular_velocity : s.angular_velocity_world) = omega;
    };
    std::visit(
        [&]<class S>(S& s) {
            if constexpr (std::is_same_v<S, FreeStart> || std::is_same_v<S, BodyStart>) {
                change_vector(s.position);
                change_vector(s.velocity);
            }
            if constexpr (requires { s.attitude; } && !std::is_same_v<S, Started>) change_turning(s);
            if constexpr (std::is_same_v<S, RailStart>) {
                if (random.chance(0.5)) change(*s.parameter);
                change(s.speed);
            }
            if constexpr (std::is_same_v<S, RevoluteStart>) change(s.angle, s.rate);
            if constexpr (std::is_same_v<S, PrismaticStart>) change(s.displacement, s.rate);
            if constexpr (std::is_same_v<S, UniversalStart>) change(s.angles[0], s.angles[1], s.rates[0], s.rates[1]);
            if constexpr (std::is_same_v<S, CylindricalStart>)
                change(s.angle, s.rate, s.displacement, s.displacement_rate);
            if constexpr (std::is_same_v<S, PlanarStart>)
                change(s.position[0], s.position[1], s.velocity[0], s.velocity[1], s.angle, s.rate);
        },
        start);
    return start;
}

inline Scene with_drag() {
    Scene scene(down);
    scene.apply(Drag{0.1, 0.05}, scene.add(Particle{1.0}, FreeStart{{0, 0, 1}, {1, 0, 0.5}}));
    return scene;
}

inline Scene with_spring() {
    Scene scene(down);
    const BodyHandle a = scene.add(Particle{1.0}, FreeStart{{1, 0, 0.5}, {0, 0.5, 0}});
    const BodyHandle b = scene.add(Particle{2.0}, FreeStart{{0, 0.5, 0}, {0.5, 0, 0}});
    scene.connect(Spring{.stiffness = 4.0, .rest_length = 0.5}, a, b);
    return scene;
}

inline Scene on_rail(const Curve& curve, std::optional<Coulomb> friction = std::nullopt,
                     const RailOptions& options = {}, RailStart start = {.parameter = 0.3, .speed = 0.5}) {
    Scene scene(down);
    scene.add(Particle{1.0}, Rail(curve, friction, options), start);
    return scene;
}

inline Scene with_cases() {
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0.3, 0, 0.2}, {0.5, 0, 1}});
    scene.apply(Force([](const Number&, const Vector& r, const Vector& v) {
                    return Vector(where(r[0] > 0.1, -3.0 * r[0], 0.5 - v[0]), -abs(r[1]), max(-20.0 * r[2], 0.0));
                }),
                ball);
    scene.watch("x", WatchFunction([=](const Now& now) { return now[ball].position()[0] - 0.2; }));
    return scene;
}

inline Scene of_body(const Load& load) {
    Scene scene(down);
    scene.apply(load, scene.add(brick, BodyStart{.velocity = {1, 0, 0}, .angular_velocity = Vector3(1, 2, 3)}));
    return scene;
}

template <class Joint, class S>
inline Scene on_joint(const RigidBody& body, const Joint& joint, const S& start, bool drags = false) {
    Scene scene(down);
    const BodyHandle added = scene.add(body, joint, start);
    if (drags) scene.apply(Drag{0.1, 0.0}, added, Vector3(0, 0, -0.3));
    return scene;
}

inline Scene double_pendulum() {
    Scene scene(down);
    const BodyHandle upper = scene.add(bar, Revolute{.axis = {0, 1, 0}}, RevoluteStart{.angle = 0.5});
    scene.add(bar, Revolute{.axis = {0, 1, 0}, .at = {0, 0, -1}}, RevoluteStart{.angle = 0.25, .parent = upper});
    return scene;
}

inline Scene swung_by_a_point() {
    Scene scene(down);
    const BodyHandle body = scene.add(brick, BodyStart{.position = {0.5, 0, 0}});
    scene.constrain(Ball{}, body.point({-0.5, 0, 0}), Vector3(0, 0, 0));
    return scene;
}

inline Scene bouncing() {
    Scene scene(down);
    const BodyHandle ball = scene.add(Particle{1.0}, FreeStart{{0, 0, 1}, {0.5, 0, 0}});
    scene.contact(ball, Plane{.normal = {0, 0, 1}}, {.restitution = 0.5});
    return scene;
}

inline Scene in_parts() {
    Scene scene = with_drag();
    scene.add(Particle{1.0}, Rail(hoop, Coulomb{0.3, 0.2}), RailStart{.parameter = 0.3, .speed = 1.0});
    scene.add(bar, Revolute{.axis = {0, 1, 0}}, RevoluteStart{.angle = 0.5});
    return scene;
}

struct Kind {
    const char* name;
    Scene scene;
    bool shares = true;  // whether most starts share a plan
};

inline std::vector<Kind> kinds() {
    const auto wave = Curve([](const auto& u) { return Vector3Of<std::decay_t<decltype(u)>>(u, sin(u), 0.1 * u * u); },
                            Domain{-3.0, 3.0});
    const Spline spline{.points = {{-2, 0, 0.5}, {-1, 0.2, 0}, {0, 0, -0.2}, {1, 0.1, 0.3}, {2, 0, 1}}};
    return {
        {"a particle with drag", with_drag()},
        {"two particles and a spring", with_spring()},
        {"a smooth hoop", on_rail(hoop)},
        {"a rough hoop", on_rail(hoop, Coulomb{0.3, 0.2})},
        {"a rough hoop that drives", on_rail(hoop, Coulomb{0.3, 0.2}, {.drive = 0.3})},
        {"a rough parabola", on_rail(Parabola{.a = 1.0, .x = {1, 0, 0}, .y = {0, 0, 1}}, Coulomb{0.3, 0.2})},
        {"a hoop that only pushes", on_rail(hoop, std::nullopt, {.side = RailSide::plus, .up = Vector3(0, 0, 1)})},
        {"a curve of one's own", on_rail(wave)},
        {"a spline", on_rail(spline, std::nullopt, {}, {.parameter = 1.7, .speed = 0.5})},
        {"a force with cases", with_cases()},
        {"a body with a torque",
         of_body(Torque([](const Number&, const auto&, const Vector& w) { return Vector(Vector(w * -0.1)); })), false},
        {"a body with a force", of_body(Force(Vector3(0.5, 0, 0))), false},
        {"a top", on_joint(bar, Spherical{}, SphericalStart{.angular_velocity = Vector3(0.5, 0, 3)}), false},
        {"a top with drag", on_joint(bar, Spherical{}, SphericalStart{.angular_velocity = Vector3(0.5, 0, 3)}, true),
         false},
        {"a pendulum", on_joint(bar, Revolute{.axis = {0, 1, 0}}, RevoluteStart{.angle = 0.5})},
        {"a pendulum with drag", on_joint(bar, Revolute{.axis = {0, 1, 0}}, RevoluteStart{.angle = 0.5}, true)},
        {"a slide", on_joint(bar, Prismatic{.axis = {1, 0, 1}}, PrismaticStart{.rate = 0.5}, true)},
        {"a universal joint", on_joint(brick, Universal{.point = {0, 0, 0.2}}, UniversalStart{.rates = {0.5, 0.3}})},
        {"a cylindrical joint", on_joint(brick, Cylindrical{.axis = {0, 1, 0}, .point = {0, 0, 0.2}},
                                         CylindricalStart{.rate = 0.5, .displacement_rate = 0.2})},
        {"a planar joint", on_joint(brick, Planar{.x = {1, 0, 0}, .y = {0, 0, 1}}, PlanarStart{.rate = 0.5})},
        {"a double pendulum", double_pendulum()},
        {"a ball that bounces", bouncing()},
        {"parts", in_parts(), false},
    };
}

/// The scene with starts of its bodies drawn.
inline Scene started_elsewhere(Random& random, const Scene& before) {
    Scene scene = before;
    for (std::size_t k = 0; k < scene.bodies().size(); ++k) {
        const BodyHandle body{static_cast<int>(k)};
        try {
            scene.replace(body, drawn(random, scene.start(body)));
        } catch (const InvalidInput&) {  // beyond the end of its rail: it stays where it was
        }
    }
    return scene;
}

}  // namespace rbdyn::test::varied
