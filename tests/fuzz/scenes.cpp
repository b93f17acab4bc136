// The target that builds scenes: each byte chooses a call, those behind it what is given.
#include <optional>
#include <string>

#include "bytes.hpp"
#include "target.hpp"
#include "use.hpp"

namespace rbdyn::fuzz {

namespace {

class Builder {
public:
    explicit Builder(Bytes bytes) : bytes_(bytes) {}

    Scene built() {
        if (bytes_.choice(2) == 1) scene_.set_gravity({0, 0, -9.81});
        for (int k = 0; k < 24 && !bytes_.is_over(); ++k) try {
                call();
            } catch (const InvalidInput&) {
                // the scene is as it was
            }
        return std::move(scene_);
    }

private:
    BodyHandle body() { return {bytes_.choice(static_cast<int>(scene_.bodies().size()) + 1) - 1}; }
    std::optional<Coulomb> friction() {
        if (bytes_.choice(2) == 0) return std::nullopt;
        Coulomb c{bytes_.positive()};
        if (bytes_.choice(2) == 1) c.mu_dynamic = bytes_.positive();
        if (bytes_.choice(4) == 1) c.rolling = 0.1 * bytes_.positive();
        return c;
    }
    RigidBody rigid() {
        const Vector3 moments = bytes_.choice(3) == 0 ? bytes_.vector() : Vector3(1.0, 1.5, 2.0);
        return RigidBody(bytes_.choice(3) == 0 ? bytes_.number() : 1.0, moments, {.com = bytes_.vector()});
    }
    Attitude attitude() {
        if (bytes_.choice(2) == 0) return {};
        const double theta = bytes_.number(), psi = bytes_.number();
        return EulerAngles{theta, psi, bytes_.number()};
    }
    Curve curve() {
        switch (bytes_.choice(6)) {
            case 0: return Line{.direction = bytes_.vector()};
            case 1: return Circle{.radius = bytes_.number(), .start = {0, 0, -1}, .toward = {1, 0, 0}};
            case 2: return Parabola{.a = bytes_.number(), .x = {1, 0, 0}, .y = {0, 0, 1}};
            case 3: return Helix{.radius = 1.0, .pitch = bytes_.number(), .start = {1, 0, 0}, .toward = {0, 1, 0}};
            case 4: {
                Polynomial p;
                for (int k = bytes_.choice(5); k >= 0; --k) p.coefficients.push_back(bytes_.vector());
                if (bytes_.choice(2) == 1) p.domain = {-1.0, bytes_.number()};
                return p;
            }
            default: {
                Spline s;
                for (int k = bytes_.choice(6); k >= 0; --k) s.points.push_back(bytes_.vector());
                s.closed = bytes_.choice(2) == 1;
                return s;
            }
        }
    }
    End end() {
        switch (bytes_.choice(3)) {
            case 0: return body();
            case 1: return body().point(bytes_.vector());
            default: return bytes_.vector();
        }
    }
    ContactPart part() {
        const BodyHandle b = body();
        switch (bytes_.choice(5)) {
            case 0: return b;
            case 1: return b.point(bytes_.vector());
            case 2: return b.sphere(bytes_.number());
            case 3: return b.disc(bytes_.number(), bytes_.vector());
            default: return b.ellipsoid(bytes_.vector());
        }
    }
    ContactSurface surface() {
        switch (bytes_.choice(4)) {
            case 0: return Plane{.normal = bytes_.vector()};
            case 1: return Sphere{bytes_.vector(), bytes_.number(), bytes_.choice(2) == 1};
            case 2: return body().plane(Plane{});
            default: return body().sphere(bytes_.number());
        }
    }
    Constraint constraint() {
        switch (bytes_.choice(6)) {
            case 0: return Ball{};
            case 1: return Rod{bytes_.number()};
            case 2: return Weld{};
            case 3: return Hinge{bytes_.vector()};
            case 4: return PointOnPlane{Plane{.normal = bytes_.vector()}};
            default: return PointOnCurve{curve()};
        }
    }
    std::optional<TimeFunction> motion() {
        if (bytes_.choice(4) != 0) return std::nullopt;
        const double a = bytes_.number();
        return TimeFunction([a](const auto& t) { return a * t; });
    }
    void add_rigid() {
        const BodyHandle parent = bytes_.choice(2) == 0 ? BodyHandle{} : body();
        const Vector3 axis = bytes_.choice(3) == 0 ? bytes_.vector() : Vector3(1, 0, 0);
        const double q = bytes_.number(), v = bytes_.number();
        switch (bytes_.choice(7)) {
            case 0:
                scene_.add(rigid(), BodyStart{.position = bytes_.vector(),
                                              .velocity = bytes_.vector(),
                                              .attitude = attitude(),
                                              .angular_velocity = bytes_.vector(),
                                              .parent = parent});
                break;
            case 1:
                scene_.add(rigid(), Spherical{.point = bytes_.vector()},
                           {.attitude = attitude(), .angular_velocity = bytes_.vector(), .parent = parent});
                break;
            case 2:
                scene_.add(rigid(),
                           Revolute{.axis = axis,
                                    .at = bytes_.vector(),
                                    .motion = motion(),
                                    .friction = friction(),
                                    .pin_radius = bytes_.number()},
                           {.angle = q, .rate = v, .parent = parent});
                break;
            case 3:
                scene_.add(rigid(), Prismatic{.axis = axis, .motion = motion(), .friction = friction()},
                           {.displacement = q, .rate = v, .parent = parent});
                break;
            case 4:
                scene_.add(rigid(), Universal{.first = axis, .second = {0, 1, 0}},
                           {.angles = {q, 0.5}, .rates = {v, 0.5}, .parent = parent});
                break;
            case 5: scene_.add(rigid(), Planar{}, {.position = {q, 0.5}, .rate = v, .parent = parent}); break;
            default: scene_.add(rigid(), Fixed{.attitude = attitude()}, {.parent = parent}); break;
        }
    }
    void add_load() {
        switch (bytes_.choice(5)) {
            case 0:
                scene_.apply(Force(bytes_.vector(), bytes_.choice(2) == 1 ? Frame::body : Frame::world), body());
                break;
            case 1: scene_.apply(Drag{.linear = bytes_.number(), .quadratic = bytes_.number()}, body()); break;
            case 2: scene_.apply(Lorentz{.strength = bytes_.number(), .field = bytes_.vector()}, body()); break;
            case 3:
                scene_.apply(TorsionSpring{.stiffness = bytes_.number(), .damping = bytes_.number()}, body());
                break;
            default: {
                const double a = bytes_.number();
                scene_.apply(Force([a](const auto& t, const auto& r, const auto& v) {
                                 using std::sqrt, std::abs;
                                 using S = std::decay_t<decltype(t)>;
                                 return Vector3Of<S>{a * sqrt(abs(r[0])), a / (r[1] + t), -v[2] * abs(v[2])};
                             }),
                             body());
            }
        }
    }
    void connect() {
        const End a = end(), b = end();
        switch (bytes_.choice(3)) {
            case 0: scene_.connect(Spring{bytes_.number(), bytes_.number(), bytes_.number()}, a, b); break;
            case 1: scene_.connect(Gravitation{bytes_.number()}, a, b); break;
            default: scene_.connect(Central([](const auto& r) { return -r * r; }), a, b); break;
        }
    }
    void watch() {
        const BodyHandle b = body();
        const double level = bytes_.number();
        const int what = bytes_.choice(4);
        WatchOptions options;
        options.direction = static_cast<Direction>(bytes_.choice(3));
        if (bytes_.choice(2) == 1) options.action.kind = WatchAction::Kind::stop;
        scene_.watch(
            std::to_string(scene_.watches().size()),
            [=](const Now& now) {
                using std::abs;
                if (what == 0) return now[b].position()[2] - level;
                if (what == 1) return abs(now[b].velocity()[0]) - level;
                if (what == 2) return now[b].reaction()[0] - level;
                return now[b].euler_angles().theta - level;
            },
            options);
    }
    void call() {
        switch (bytes_.choice(10)) {
            case 0: scene_.add(Particle{bytes_.number()}, FreeStart{bytes_.vector(), bytes_.vector()}); break;
            case 1:
            case 2: {
                RailOptions options;
                if (bytes_.choice(4) == 1) options.drive = bytes_.number();
                if (bytes_.choice(4) == 1) options.side = bytes_.choice(2) == 1 ? RailSide::plus : RailSide::minus;
                if (bytes_.choice(4) == 1) options.ends = RailEnds::release;
                scene_.add(Particle{1.0}, Rail(curve(), friction(), options),
                           {.parameter = bytes_.number(), .speed = bytes_.number()});
                break;
            }
            case 3:
            case 4: add_rigid(); break;
            case 5: add_load(); break;
            case 6: connect(); break;
            case 7: scene_.constrain(constraint(), end(), end()); break;
            case 8: scene_.contact(part(), surface(), {.friction = friction(), .restitution = bytes_.number()}); break;
            default: watch(); break;
        }
    }

    Bytes bytes_;
    Scene scene_;
};

}  // namespace

void scene(std::string_view bytes) { use(Builder(Bytes(bytes)).built()); }

}  // namespace rbdyn::fuzz
