// Nothing unused is paid: for each kind of motion and each effect four ways to the same motion.
//
//   without   the scene without the effect
//   zero      the effect is in the scene, and zero: a coefficient, a field, a traced function times a parameter of zero
//   by hand   the equations written out by hand (by_hand.hpp)
//   on        the effect is in the scene and acts
// The first three are the same: the same states bit for bit, the same work, the same instructions. Bodies that nothing
// joins have models of their own: the state is then that of all of them, the work the sum.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "kinds.hpp"
#include "rbdyn/engine/taylor.hpp"
#include "rbdyn/event/driver.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/model/own_model.hpp"

namespace rbdyn::proof {

/// Models that are integrated one after the other, each from its start.
struct Motions {
    std::vector<std::shared_ptr<const HybridModel>> models;
    std::vector<std::vector<double>> starts;
};

/// Those of a scene, as a run has them.
/// Of bodies that nothing joins.
inline std::vector<std::shared_ptr<const SpecialModel>> models_of(const Scene& scene) {
    const Plan plan = make_plan(scene.frozen());
    const auto points = [](const Plan& one) { return std::dynamic_pointer_cast<const SpecialModel>(one.model); };
    if (plan.parts.empty()) return {points(plan)};
    std::vector<std::shared_ptr<const SpecialModel>> models;
    for (const Plan& part : plan.parts) models.push_back(points(part));
    return models;
}
inline Motions motions_of(const Scene& scene) {
    Motions all;
    for (const auto& model : models_of(scene)) {
        all.models.push_back(model);
        all.starts.push_back(model->start());
    }
    return all;
}

/// One motion and one effect.
struct Row {
    std::string motion, effect;
    double until;
    Scene without, zero, on;
    Motions by_hand = {};
    bool is_named = true;    // by the plan of the scene where it acts, and not where it is zero
    bool can_go = true;      // without(effect) of the scene where it acts is the scene without
    bool is_noticed = true;  // it acts in this motion, and not only in others
};

/// Hand-written equations, a model for each part of a scene, from the state that scene starts in.
template <class... Written>
Motions by_hand(const Scene& scene) {
    Motions all = motions_of(scene);
    const auto holders = models_of(scene);
    std::size_t i = 0;
    ((all.models[i] = std::make_shared<Bare<Written>>(holders[i]), ++i), ...);
    return all;
}

/// The effects that each kind of motion may have or not.
inline void add_kinds(std::vector<Row>& rows) {
    for (const Kind& kind : kinds())
        for (const std::string& effect : kind.effects) {
            const auto scene = [&](Variant v) { return scene_of(kind, effect, v); };
            Row row{kind.name, effect, kind.until, scene(Variant::without), scene(Variant::zero), scene(Variant::on)};
            row.by_hand = motions_of(row.without);
            row.by_hand.models = {kind.bare(models_of(row.without).front(), effect != "gravity")};
            // while a bead slides one way its friction is the same whatever the drive
            row.is_noticed = effect != "drive";
            rows.push_back(std::move(row));
        }
}

inline const Vector3 place{0.0, 0.0, 1.0}, along_plane{thrown[0], 0.0, thrown[2]};
inline const Drag drag{.linear = linear_drag, .quadratic = quadratic_drag};
inline const Spring spring{.stiffness = stiffness, .rest_length = rest_length};

/// Rotation: a body pulled through its centre of mass, without spin a particle there.
inline void add_rotations(std::vector<Row>& rows) {
    const auto add = [&](const std::string& motion, const Vector3& I, auto&& load, auto&& written) {
        const auto body = [&](const Vector3& omega) {
            Scene scene(weight);
            const Vector3 com{0.25, 0.0, 0.125};
            load(scene,
                 scene.add(RigidBody(mass, I, {.com = com}), BodyStart{.position = place - com,
                                                                       .velocity = thrown - Vector3(omega.cross(com)),
                                                                       .angular_velocity = omega}));
            return scene;
        };
        Scene particle(weight);
        load(particle, particle.add(Particle{mass}, FreeStart{place, thrown}));
        rows.push_back(
            {motion, "rotation", 2.0, particle, body({0.0, 0.0, 0.0}), body({0.25, 3.0, 0.5}), written(particle)});
    };
    const auto nothing = [](Scene&, BodyHandle) {};
    const auto drags = [](Scene& s, BodyHandle b) { s.apply(drag, b); };
    const auto springs = [](Scene& s, BodyHandle b) { s.connect(spring, b, anchor); };
    const Vector3 symmetric{0.875, 0.875, 1.75};
    add("body without spin", moments, nothing, by_hand<FreeParticle<true>>);
    add("symmetric body without spin", symmetric, nothing, by_hand<FreeParticle<true>>);
    add("body without spin, drag", moments, drags, by_hand<LoadedFlight<Acting::drag, false>>);
    add("symmetric body without spin, drag", symmetric, drags, by_hand<LoadedFlight<Acting::drag, false>>);
    add("body without spin, spring", moments, springs, by_hand<LoadedFlight<Acting::spring, false>>);
}

/// Static friction beside dynamic friction: as much of it, against more.
inline void add_static_frictions(std::vector<Row>& rows) {
    const auto add = [&](const std::string& motion, double until, double dynamic, double more, double drive,
                         double speed, auto&& written) {
        const auto with = [&](Coulomb friction) {
            Scene s(weight);
            s.add(Particle{mass}, Rail(hoop(), friction, {.drive = drive}), {.speed = speed});
            return s;
        };
        const Scene one = with({dynamic});
        rows.push_back({motion, "static friction", until, one, with({dynamic, dynamic}), with({more, dynamic}),
                        written(one), false, true, false});
    };
    add("rough rail", 2.0, mu_dynamic, mu_static, 0.0, 16.0, by_hand<RoughHoop<true>>);
    add("rough rail, carried", 2.0, mu_hold, 2.0 * mu_hold, belt, belt, by_hand<CarriedBead>);
}

/// The third dimension: loads and starts in a plane, against a start out of it.
inline void add_planes(std::vector<Row>& rows) {
    const auto add = [&](const std::string& motion, auto&& load, auto&& written) {
        const auto ball = [&](double across, bool is_pushed) {
            Scene s(weight);
            const BodyHandle b = s.add(Particle{mass}, FreeStart{place, along_plane + Vector3(0.0, across, 0.0)});
            load(s, b);
            if (is_pushed) s.apply(Force(Vector3(0.0, 0.0, 0.0)), b);
            return s;
        };
        const Scene in_plane = ball(0.0, false);
        rows.push_back({motion, "third dimension", 2.0, in_plane, ball(0.0, true), ball(0.5, false), written(in_plane),
                        false, false});
    };
    add(
        "particle in a plane", [](Scene&, BodyHandle) {}, by_hand<PlaneFlight>);
    add(
        "particle in a plane, drag", [](Scene& s, BodyHandle b) { s.apply(drag, b); },
        by_hand<LoadedFlight<Acting::drag, true>>);
    add(
        "particle in a plane, spring", [](Scene& s, BodyHandle b) { s.connect(spring, b, anchor_in_plane); },
        by_hand<LoadedFlight<Acting::spring, true>>);
    const auto body = [](double wobble, bool is_twisted) {
        Scene s(weight);
        const BodyHandle b =
            s.add(RigidBody(mass, moments), BodyStart{.position = place,
                                                      .velocity = along_plane,
                                                      .angular_velocity = Vector3(wobble, plane_spin, 0.0)});
        if (is_twisted) s.apply(Torque(Vector3(0.0, 0.0, 0.0)), b);
        return s;
    };
    const Scene turning = body(0.0, false);
    rows.push_back({"body turning in a plane", "third dimension", 2.0, turning, body(0.0, true), body(0.25, false),
                    by_hand<PlaneBody>(turning), false, false});
}

/// Motion at all: a bead and a body that are held where they are, against one that swings.
inline void add_rests(std::vector<Row>& rows) {
    Scene bead(weight);
    bead.add(Particle{mass}, Rail(hoop()));
    const auto held = [](Scene s, const std::string& motion, const Scene& rest, const Scene& moving) {
        return Row{motion, "motion", 2.0, std::move(s), rest, moving, {}, false, false};
    };
    const auto ball_joint = [](const Vector3& omega) {
        Scene s(weight);
        s.add(RigidBody(mass, moments), Spherical{.point = {0.0, 0.0, arm}}, {.angular_velocity = omega});
        return s;
    };
    const auto hinge = [](double rate) {
        Scene s(weight);
        s.add(RigidBody(mass, moments), Revolute{.axis = {0, 1, 0}, .point = {0.0, 0.0, arm}}, {.rate = rate});
        return s;
    };
    rows.push_back(held(bead, "body at rest, spherical", ball_joint({0, 0, 0}), ball_joint({0.25, 3.0, 0.5})));
    rows.push_back(held(bead, "body at rest, revolute", hinge(0.0), hinge(1.0)));
    for (std::size_t i = rows.size() - 2; i < rows.size(); ++i) rows[i].by_hand = by_hand<Rest>(rows[i].without);
}

/// What joins two bodies: without it each is solved by itself.
inline void add_pairs(std::vector<Row>& rows) {
    const auto pair = [](const std::optional<Spring>& joint) {
        Scene s(weight);
        const BodyHandle ball = s.add(Particle{mass}, FreeStart{place, thrown});
        const BodyHandle pendulum = s.add(RigidBody(mass, moments), Revolute{.axis = {0, 1, 0}, .point = {0, 0, arm}},
                                          {.angle = 2.0, .rate = 1.0});
        if (joint) s.connect(*joint, ball, pendulum);
        return s;
    };
    const Scene apart = pair(std::nullopt);
    const auto add = [&](const std::string& effect, const Spring& none, const Spring& some) {
        rows.push_back({"particle beside a pendulum", effect, 2.0, apart, pair(none), pair(some),
                        by_hand<FreeParticle<true>, Pendulum<true>>(apart)});
    };
    add("spring", {.rest_length = rest_length}, spring);
    add("damper", {}, {.damping = 0.25});
}

/// All of them.
inline std::vector<Row> rows() {
    std::vector<Row> all;
    add_kinds(all);
    add_rotations(all);
    add_static_frictions(all);
    add_planes(all);
    add_rests(all);
    add_pairs(all);
    return all;
}

// --- a law of one's own ---

/// A law that is built in, and the same as a functor: nothing is paid for its being the user's.
struct OwnLaw {
    std::string law;
    double until;
    Motions built_in, functor, by_hand;
};

/// -(c1 + c2 |v|) v.
struct OwnDrag {
    template <class T>
    Vector3Of<T> operator()(const T&, const Vector3Of<T>&, const Vector3Of<T>& v) const {
        const T factor = linear_drag + quadratic_drag * length(v);
        return {-factor * v[0], -factor * v[1], -factor * v[2]};
    }
};

/// A bead on a hoop as a model of one's own: u, w.
struct OwnHoop {
    int variables() const { return 2; }
    int positions() const { return 1; }
    template <class T>
    void operator()(const T&, std::span<const T> x, std::span<T> rate) const {
        rate[0] = x[1];
        rate[1] = -g * sin(x[0]);
    }
};

inline std::vector<OwnLaw> own_laws() {
    const auto ball = [](const Load& load) {
        Scene s(weight);
        s.apply(load, s.add(Particle{mass}, FreeStart{place, thrown}));
        return s;
    };
    const Scene dragged = ball(drag);
    Scene bead(weight);
    bead.add(Particle{mass}, Rail(hoop()), {.parameter = 2.0, .speed = 1.0});
    Motions own = motions_of(bead);
    own.models = {std::make_shared<FunctorModel<OwnHoop>>(OwnHoop{})};
    return {{"drag on a particle", 2.0, motions_of(dragged), motions_of(ball(Force(OwnDrag{}))),
             by_hand<LoadedFlight<Acting::drag, false>>(dragged)},
            {"equations of a bead on a hoop", 10.0, motions_of(bead), own, by_hand<Hoop<true>>(bead)}};
}

/// One integration, as every run of simulate() makes; local tolerance 1e-12.
inline constexpr double tolerance = 1e-12;
inline Record integrated(const HybridModel& model, const std::vector<double>& x, double until) {
    TaylorEngine engine(tolerance);
    Driver driver(model, engine, 100'000'000, {}, {}, tolerance * until);
    return driver.run(0.0, x, until);
}
/// All of them.
inline std::vector<Record> integrated(const Motions& motions, double until) {
    std::vector<Record> records;
    for (std::size_t i = 0; i < motions.models.size(); ++i)
        records.push_back(integrated(*motions.models[i], motions.starts[i], until));
    return records;
}

}  // namespace rbdyn::proof
