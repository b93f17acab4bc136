// Where a motion starts, keyword by keyword.
#include "starts.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace binding {

using rbdyn::BodyStart, rbdyn::Cylindrical, rbdyn::Fixed, rbdyn::Free, rbdyn::FreeStart, rbdyn::Joint, rbdyn::Particle,
    rbdyn::Planar, rbdyn::Prismatic, rbdyn::Rail, rbdyn::RailStart, rbdyn::Revolute, rbdyn::RigidBody, rbdyn::Spherical,
    rbdyn::Start, rbdyn::Universal;

namespace {

/// Reads words into a start that has those which are not given.
class Reader {
public:
    explicit Reader(const StartWords& words) : words_(words) {}

    /// Throws for a word that is not among `allowed`.
    void require_words(const std::vector<std::string>& allowed, const std::string& who) const {
        for (const auto& item : words_.given) {
            const auto key = item.first.cast<std::string>();
            if (std::find(allowed.begin(), allowed.end(), key) != allowed.end()) continue;
            std::string list;
            for (const std::string& a : allowed) list += (list.empty() ? "" : ", ") + a;
            const std::string known = "; " + who + " starts with " + (list.empty() ? "nothing" : list);
            if (words_.are_keywords) throw py::type_error(words_.verb + ": unexpected keyword \"" + key + "\"" + known);
            throw InvalidInput(words_.verb + ": " + words_.object + " has no \"" + key + "\"" + known);
        }
    }
    bool has(const char* key) const { return words_.given.contains(key) && !words_.given[key].is_none(); }

    void read(const char* key, double& value) const {
        if (has(key)) value = number(words_.given[key], words_.object, key);
    }
    void read(const char* key, Vector3& value) const {
        if (has(key)) value = vector3(words_.given[key], words_.object, key);
    }
    template <class T>
    void read(const char* key, std::optional<T>& value) const {
        if (has(key)) read(key, value.emplace());
    }
    void read(const char* key, std::array<double, 2>& value) const {
        if (has(key)) value = pair_of(words_.given[key], words_.object, key);
    }
    void read(const char* key, rbdyn::Attitude& value) const {
        if (has(key)) value = binding::attitude(words_.given[key], words_.object);
    }
    /// Of two words that say the same either takes the place of what was there.
    template <class T>
    void read_either(const char* one, std::optional<T>& first, const char* other, std::optional<T>& second) const {
        if (!has(one) && !has(other)) return;
        first.reset();
        second.reset();
        read(one, first);
        read(other, second);
    }

private:
    const StartWords& words_;
};

// --- what each pair of body and joint starts with; `start` has the words that are not given ---

FreeStart start_on(const Particle&, const Free&, const Reader& words, FreeStart start) {
    words.require_words({"position", "velocity"}, "a particle that is free");
    words.read("position", start.position);
    words.read("velocity", start.velocity);
    return start;
}
RailStart start_on(const Particle&, const Rail&, const Reader& words, RailStart start) {
    words.require_words({"parameter", "arc_length", "speed"}, "a particle on a rail");
    words.read_either("parameter", start.parameter, "arc_length", start.arc_length);
    words.read("speed", start.speed);
    return start;
}
template <class S>
void read_turning(const Reader& words, S& start) {
    words.read("attitude", start.attitude);
    words.read_either("angular_velocity", start.angular_velocity, "angular_velocity_world",
                      start.angular_velocity_world);
}
BodyStart start_on(const RigidBody&, const Free&, const Reader& words, BodyStart start) {
    words.require_words({"position", "velocity", "attitude", "angular_velocity", "angular_velocity_world"},
                        "a body that is free");
    words.read("position", start.position);
    words.read("velocity", start.velocity);
    read_turning(words, start);
    return start;
}
rbdyn::SphericalStart start_on(const RigidBody&, const Spherical&, const Reader& words, rbdyn::SphericalStart start) {
    words.require_words({"attitude", "angular_velocity", "angular_velocity_world"}, "a body on a ball joint");
    read_turning(words, start);
    return start;
}
rbdyn::RevoluteStart start_on(const RigidBody&, const Revolute&, const Reader& words, rbdyn::RevoluteStart start) {
    words.require_words({"angle", "rate"}, "a body on a hinge");
    words.read("angle", start.angle);
    words.read("rate", start.rate);
    return start;
}
rbdyn::PrismaticStart start_on(const RigidBody&, const Prismatic&, const Reader& words, rbdyn::PrismaticStart start) {
    words.require_words({"displacement", "rate"}, "a body on a slide");
    words.read("displacement", start.displacement);
    words.read("rate", start.rate);
    return start;
}
rbdyn::UniversalStart start_on(const RigidBody&, const Universal&, const Reader& words, rbdyn::UniversalStart start) {
    words.require_words({"angles", "rates"}, "a body on a universal joint");
    words.read("angles", start.angles);
    words.read("rates", start.rates);
    return start;
}
rbdyn::CylindricalStart start_on(const RigidBody&, const Cylindrical&, const Reader& words,
                                 rbdyn::CylindricalStart start) {
    words.require_words({"angle", "rate", "displacement", "displacement_rate"}, "a body on a hinge that slides");
    words.read("angle", start.angle);
    words.read("rate", start.rate);
    words.read("displacement", start.displacement);
    words.read("displacement_rate", start.displacement_rate);
    return start;
}
rbdyn::PlanarStart start_on(const RigidBody&, const Planar&, const Reader& words, rbdyn::PlanarStart start) {
    words.require_words({"position", "velocity", "angle", "rate"}, "a body in a plane");
    words.read("position", start.position);
    words.read("velocity", start.velocity);
    words.read("angle", start.angle);
    words.read("rate", start.rate);
    return start;
}
rbdyn::FixedStart start_on(const RigidBody&, const Fixed&, const Reader& words, rbdyn::FixedStart start) {
    words.require_words({}, "a body that is welded");
    return start;
}

/// The start that words make of another, or of none.
std::optional<Start> start_from(const AnyBody& body, const Joint& joint, const StartWords& words, const Start* before) {
    const Reader reader(words);
    return std::visit(
        [&](const auto& b, const auto& j) -> std::optional<Start> {
            const auto of = [&]<class S>(const S*) -> std::optional<Start> {
                if constexpr (requires { start_on(b, j, reader, S()); })
                    return Start(start_on(b, j, reader, before != nullptr ? std::get<S>(*before) : S()));
                else
                    return std::nullopt;
            };
            std::optional<Start> result;
            const auto try_all = [&]<class... S>(const std::variant<S...>*) {
                (void)((result = of(static_cast<const S*>(nullptr)), result.has_value()) || ...);
            };
            try_all(static_cast<const Start*>(nullptr));
            return result;
        },
        body, joint);
}

}  // namespace

std::optional<Start> start_of(const AnyBody& body, const Joint& joint, const StartWords& words) {
    return start_from(body, joint, words, nullptr);
}

void restart(rbdyn::Scene& scene, rbdyn::BodyHandle body, const StartWords& words) {
    const rbdyn::Scene::Body& b = scene.bodies()[static_cast<std::size_t>(body.index)];
    const rbdyn::Started before = b;
    const Start now = scene.start(body);
    scene.replace(body, start_from(b.body, b.joint, words, &now).value());
    // what is not given stays as it is, in all its digits
    const Reader reader(words);
    const bool turns_anew = reader.has("angular_velocity") || reader.has("angular_velocity_world") ||
                            (reader.has("attitude") && before.angular_velocity_world);
    rbdyn::Started after = scene.bodies()[static_cast<std::size_t>(body.index)];
    if (!turns_anew) after.angular_velocity = before.angular_velocity;
    if (!reader.has("parameter") && !reader.has("arc_length")) after.parameter_rest = before.parameter_rest;
    scene.replace(body, after);
}

std::pair<rbdyn::BodyHandle, std::string> word_of(const Handles& handles, const py::handle& key,
                                                  const std::string& verb) {
    const bool is_pair = py::isinstance<py::tuple>(key) && py::len(key) == 2;
    const auto pair = is_pair ? py::reinterpret_borrow<py::tuple>(key) : py::tuple(2);
    const bool is_named = is_pair && py::isinstance<py::str>(pair[0]);
    if (!is_pair || !(is_named || py::isinstance<Handle>(pair[0])) || !py::isinstance<py::str>(pair[1]))
        throw InvalidInput(verb + ": a key is " + shown(key) +
                           "; it is a handle or a name, and a word of add(), as in (ball, \"position\")");
    const py::object handle = is_named ? handles.find(plain(pair[0]), verb) : py::object(pair[0]);
    return {handles.body(handle.cast<const Handle&>(), verb), pair[1].cast<std::string>()};
}

void restart(rbdyn::Scene& scene, const Handles& handles, const py::dict& initial, const std::string& verb) {
    std::vector<std::pair<int, py::dict>> by_body;
    for (const auto& [key, value] : initial) {
        const auto [body, word] = word_of(handles, key, verb);
        auto place = std::find_if(by_body.begin(), by_body.end(),
                                  [index = body.index](const auto& one) { return one.first == index; });
        if (place == by_body.end()) place = by_body.insert(by_body.end(), {body.index, py::dict()});
        place->second[py::str(word)] = value;
    }
    for (const auto& [body, words] : by_body)
        restart(scene, rbdyn::BodyHandle{body},
                {words, scene.bodies()[static_cast<std::size_t>(body)].name, verb, false});
}

}  // namespace binding
