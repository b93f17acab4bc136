// Targets that are runs: their bytes, changed behind a checksum that is right.
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "bytes.hpp"
#include "rbdyn/file/scene_file.hpp"
#include "rbdyn/model/euler_top.hpp"
#include "rbdyn/own_motion.hpp"
#include "rbdyn/trajectory/run_bytes.hpp"
#include "target.hpp"
#include "use.hpp"

namespace rbdyn::fuzz {

namespace {

using Options = SimulateOptions;

/// A run and what is written of it behind its head.
struct Written {
    Trajectory run;
    std::string text, payload;

    Written(const Scene& scene, const Options& options)
        : run(simulate(scene, options)), text(text_of(run.scene())), payload([this] {
              run_bytes::Writer w;
              run_bytes::put(w, *run.data());
              return w.bytes;
          }()) {}
};

/// Every kind of run: integrated with events, in closed form, in parts, with what sticks, of a mechanism, kept at
/// times.
std::vector<Written> runs() {
    std::vector<Written> all;
    Scene hoop({0, 0, -9.81}), top({0, 0, -9.81}), parts, pendulum({0, 0, -9.81}), ball({0, 0, -9.81});
    const Circle circle{.radius = 0.5, .start = {0, 0, -1}, .toward = {1, 0, 0}};
    hoop.add(Particle{0.5}, Rail(circle, Coulomb{0.4, 0.1}), {.parameter = 0.5, .speed = 1.0});
    all.emplace_back(hoop, Options{.until = 1.0, .rtol = 1e-4});
    all.emplace_back(hoop, Options{.until = 1.0, .error = 1e-6, .keep = {.what = Keep::What::times, .times = {0.5}}});
    top.add(RigidBody(0.5, Vector3(0.002, 0.002, 0.001)), Spherical{.point = {0, 0, -0.05}},
            {.attitude = EulerAngles{0.3, 0.0, 0.0}, .angular_velocity = Vector3(0, 0, 30)});
    all.emplace_back(top, Options{.until = 0.1});
    const BodyHandle one = parts.add(Particle{1.0}, FreeStart{{1, 0, 0}, {0, 1, 0}});
    parts.add(Particle{2.0}, FreeStart{{3, 0, 0}, {0, 1, 0}});
    parts.apply(Force([](const auto&, const auto& r, const auto&) {
                    return Vector3Of<std::decay_t<decltype(r[0])>>{-r[0] * r[0], -r[1], r[2]};
                }),
                one);
    parts.watch("half", [=](const Now& now) { return now[one].position()[0] - 0.9; });
    all.emplace_back(parts, Options{.until = 0.5, .rtol = 1e-4});
    const RigidBody rod(1.0, Vector3(0.1, 0.2, 0.2), {.com = {0, 0, -0.3}});
    const BodyHandle upper = pendulum.add(rod, Revolute{.axis = {1, 0, 0}}, {.angle = 0.7});
    pendulum.add(rod, Revolute{.axis = {1, 0, 0}, .at = {0, 0, -0.6}}, {.angle = 0.2, .parent = upper});
    all.emplace_back(pendulum, Options{.until = 0.3, .rtol = 1e-4});
    const BodyHandle bouncing = ball.add(RigidBody(1.0, Vector3(0.1, 0.1, 0.1)), BodyStart{.position = {0, 0, 0.6}});
    ball.contact(bouncing.sphere(0.5), Plane{}, {.friction = Coulomb{0.3}, .restitution = 0.5});
    all.emplace_back(ball, Options{.until = 0.5, .rtol = 1e-4});
    return all;
}

/// Bytes with changes to them, as an input says: a number in the place of one, a bit, a cut.
std::string changed(std::string payload, Bytes& bytes) {
    for (int k = 0; !bytes.is_over() && k < 40 && !payload.empty(); ++k) {
        const int what = bytes.choice(8);
        const std::size_t at = bytes.place(payload.size());
        const auto put = [&](const auto& value) {
            if (at + sizeof value <= payload.size()) std::memcpy(payload.data() + at, &value, sizeof value);
        };
        switch (what) {
            case 0: payload.resize(at); break;
            case 1: put(bytes.number()); break;
            case 2: put(static_cast<std::int64_t>(bytes.byte()) - 3); break;
            case 3: put(static_cast<std::int64_t>(bytes.byte()) << bytes.choice(56)); break;
            case 4: payload.insert(at, 8, static_cast<char>(bytes.byte())); break;
            case 5: payload.erase(at, 8); break;
            case 6: put(static_cast<std::int32_t>(bytes.byte()) - 3); break;
            default: payload[at] = static_cast<char>(bytes.byte()); break;
        }
    }
    return payload;
}

}  // namespace

void run_file(std::string_view input) {
    static const std::vector<Written> all = runs();
    Bytes bytes(input);
    const Written& one = all[static_cast<std::size_t>(bytes.choice(static_cast<int>(all.size())))];
    const std::string payload = changed(one.payload, bytes);
    const Trajectory run(run_from(one.run.scene(), run_bytes::sealed(run_bytes::head, one.text, payload)));
    if (payload == one.payload) require(bytes_of(*run.data()) == bytes_of(*one.run.data()), "a run comes back changed");
    for (int i = 0; i < static_cast<int>(run.scene().bodies().size()); ++i) try {
            run[BodyHandle{i}].position(0.5 * (run.start() + run.end()));
            run[BodyHandle{i}].force(run.end());
        } catch (const Error&) {
            // numbers that were changed are no motion
        }
    simulate(run, {.until = run.end() + 0.1, .max_steps = 40});
}

void state_run(std::string_view input) {
    static const std::string known = [] {
        const EulerTop top(RigidBody(1.0, Vector3(1, 1, 0.5)), 9.81, Vector3(0, 0, -0.5));
        return bytes_of(simulate(top, {0.1, 1.0, 0.2, 0.0, 0.3, 5.0}, {.until = 0.2, .rtol = 1e-4}));
    }();
    static const std::string payload = [] {
        run_bytes::Reader r = run_bytes::opened(run_bytes::state_head, {}, known);
        return std::string(r.rest());
    }();
    Bytes bytes(input);
    const std::string given = changed(payload, bytes);
    const StateRun run = state_run_from(run_bytes::sealed(run_bytes::state_head, {}, given));
    if (given == payload) require(bytes_of(run) == known, "a run comes back changed");
    run.state(0.5 * (run.start() + run.end()));
    bytes_of(run);
}

}  // namespace rbdyn::fuzz
