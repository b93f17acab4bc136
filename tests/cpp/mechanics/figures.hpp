// Reference motions of bodies joined to bodies, from files of tests/reference: scenes made of what they give, and how
// far a run is from their figures.
//
// The figures have 25 digits, from two formulations each that agree; each file states its conventions. Errors are
// measured as a run's are: positions of centres of mass by the extent of their motion, velocities, reactions and the
// forces of closures by the largest magnitude, attitudes and angles in rad.
#pragma once

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "rbdyn/simulate.hpp"
#include "support.hpp"

namespace rbdyn::test::figures {

using nlohmann::json;

inline double number(const json& text) { return std::strtod(text.get_ref<const std::string&>().c_str(), nullptr); }
/// Of two components the third is zero.
inline Vector3 vector(const json& list) {
    Vector3 v = Vector3::Zero();
    for (std::size_t i = 0; i < list.size(); ++i) v[static_cast<Eigen::Index>(i)] = number(list[i]);
    return v;
}
inline Quaternion quaternion_of(const json& list) {
    return {number(list[0]), number(list[1]), number(list[2]), number(list[3])};
}

/// The angle between two attitudes [rad]; they may differ in sign.
inline double turn_between(const Quaternion& a, const Quaternion& b) {
    double plus = 0.0, minus = 0.0;
    const double one[4] = {a.w, a.x, a.y, a.z}, other[4] = {b.w, b.x, b.y, b.z};
    for (int k = 0; k < 4; ++k) {
        plus += std::pow(one[k] - other[k], 2);
        minus += std::pow(one[k] + other[k], 2);
    }
    return 2.0 * std::sqrt(std::min(plus, minus));
}

inline json file_of(const std::string& name) {
    std::ifstream in(std::string(RBDYN_TEST_REFERENCE) + "/" + name + ".json");
    if (!in) throw std::runtime_error("no reference file " + name);
    return json::parse(in);
}
/// The value of something given, with its unit or without.
inline double given(const json& file, const std::string& name) {
    const json& p = file["parameters"][name];
    return number(p.is_object() ? p["value"] : p);
}
/// A rectangle in the plane of x and y.
inline RigidBody rectangle(double mass, double half_width, double half_height) {
    const double moment = mass * (half_width * half_width + half_height * half_height) / 3.0;
    return RigidBody(mass, {moment / 2, moment / 2, moment});
}

class Case {
public:
    explicit Case(const std::string& name) : id(name), file(file_of(name)) {
        for (const json& s : samples()) until = std::max(until, number(s["t"]));
        if (!file["parameters"].contains("bodies")) return;
        scene.set_gravity(vector(given("gravity")));
        for (const json& b : file["parameters"]["bodies"]) add(b);
        if (file["parameters"].contains("springs")) connect();
        if (file["parameters"].contains("loops")) close();
        if (file["parameters"].contains("joint_torque")) drive();
    }

    const json& samples() const { return file["values"]["samples"]; }
    const json& given(const std::string& name) const {
        const json& p = file["parameters"][name];
        return p.is_object() && p.contains("value") ? p["value"] : p;
    }
    double parameter(const std::string& name) const { return number(given(name)); }

    /// How much of an error of the start is left at each sample.
    double growth(std::size_t sample) const {
        for (const auto& [name, list] : file["conditioning"].items())
            if (name.rfind("growth", 0) == 0) return number(list[sample]);
        return 1.0;
    }

    std::string id;
    json file;
    Scene scene;
    std::map<std::string, BodyHandle> body;
    std::vector<BodyHandle> kept;
    std::vector<ConstraintHandle> loops;
    double until = 0.0, moved = 0.0;  // by closing the loops

private:
    void add(const json& b) {
        const std::string name = b["name"], parent_name = b["parent"];
        Matrix3 inertia;
        for (int i = 0; i < 3; ++i) inertia.row(i) = vector(b["I"][static_cast<std::size_t>(i)]).transpose();
        const RigidBody rigid(number(b["mass"]), inertia, {.com = vector(b["com"])});
        const BodyHandle parent = parent_name == "ground" ? BodyHandle{} : body.at(parent_name);
        const json &joint = b["joint"], &start = b["initial"];
        const std::string type = joint["type"];
        const auto of = [&](const json& from, const char* key) {
            return from.contains(key) ? vector(from[key]) : Vector3(Vector3::Zero());
        };
        const auto at = [&](const char* key) { return number(start[key]); };
        const Vector3 place = of(joint, "at"), point = of(joint, "point"), axis = of(joint, "axis");
        BodyHandle& handle = body[name];
        if (type == "revolute")
            handle = scene.add(rigid, Revolute{.axis = axis, .at = place, .point = point},
                               {.angle = at("angle"), .rate = at("rate"), .parent = parent}, name);
        else if (type == "prismatic")
            handle = scene.add(rigid, Prismatic{.axis = axis, .at = place, .point = point},
                               {.displacement = at("displacement"), .rate = at("rate"), .parent = parent}, name);
        else if (type == "universal")
            handle = scene.add(
                rigid, Universal{.first = axis, .second = of(joint, "axis2"), .at = place, .point = point},
                {.angles = {at("angle1"), at("angle2")}, .rates = {at("rate1"), at("rate2")}, .parent = parent}, name);
        else if (type == "spherical")
            handle = scene.add(rigid, Spherical{.at = place, .point = point},
                               {.attitude = quaternion_of(start["quaternion"]),
                                .angular_velocity = vector(start["angular_velocity"]),
                                .parent = parent},
                               name);
        else if (type == "free")
            handle = scene.add(rigid,
                               BodyStart{.position = vector(start["position"]),
                                         .velocity = vector(start["velocity"]),
                                         .attitude = quaternion_of(start["quaternion"]),
                                         .angular_velocity = vector(start["angular_velocity"]),
                                         .parent = parent},
                               name);
        else
            throw std::runtime_error("no joint " + type);
        if (start.contains("given") && start["given"].get<bool>()) kept.push_back(handle);
    }
    End end(const std::string& on, const json& point) const {
        if (on == "ground") return vector(point);
        return body.at(on).point(vector(point));
    }
    void connect() {
        for (const json& s : file["parameters"]["springs"])
            scene.connect(Spring{.stiffness = number(s["stiffness"]),
                                 .rest_length = number(s["rest_length"]),
                                 .damping = number(s["damping"])},
                          end(s["a"], s["pa"]), end(s["b"], s["pb"]));
    }
    /// Torques along hinges of the ground: their opposites act on nothing.
    void drive() {
        for (const json& t : file["parameters"]["joint_torque"]) {
            const BodyHandle b = body.at(t["joint_of"]);
            const auto& hinge = std::get<Revolute>(scene.bodies()[static_cast<std::size_t>(b.index)].joint);
            scene.apply(Torque(Vector3(hinge.axis.normalized() * number(t["value"])), Frame::world), b);
        }
    }
    /// Pins: their bodies are in a plane.
    void close() {
        for (const json& l : file["parameters"]["loops"])
            loops.push_back(scene.constrain(Ball{}, end(l["a"], l["pa"]), end(l["b"], l["pb"])));
        moved = scene.assemble(kept);
    }
};

/// What is seen of a motion: values of a kind that share a scale.
enum class Kind { place, speed, attitude, turning, angle, rate, force, torque, count };
inline const char* const names[] = {"com", "velocity", "attitude", "omega", "angle", "rate", "force", "torque"};

/// The error of a run at each sample, over its scales, as the largest of each kind.
class Comparison {
public:
    Comparison(const Case& of, const Trajectory& run) : case_(of), run_(run) {
        constexpr int times = 400;
        for (int k = 0; k <= times; ++k) widen(std::min(run.end(), run.end() * k / times));
        for (auto& [what, s] : sizes_) s.scale = what.second == Kind::place ? (s.high - s.low).norm() : s.size;
        for (auto& [what, s] : sizes_) {
            double& most = largest_[static_cast<std::size_t>(what.second)];
            most = std::max(most, s.scale);
        }
        // moments are forces at an arm
        double& torque = largest_[static_cast<std::size_t>(Kind::torque)];
        torque = std::max(torque, 0.1 * largest_[static_cast<std::size_t>(Kind::force)]);
        for (const json& s : case_.samples())
            if (number(s["t"]) <= run.end()) errors_.push_back(see(s, number(s["t"])));
        if (case_.file["values"].contains("initial")) start_ = see(case_.file["values"]["initial"], 0.0);
    }

    /// As it starts.
    double start() const { return start_.second; }

    /// Of the sample: the largest of all kinds.
    double at(std::size_t sample) const { return errors_[sample].second; }
    std::size_t count() const { return errors_.size(); }
    double worst() const {
        double most = 0.0;
        for (const auto& e : errors_) most = std::max(most, e.second);
        return most;
    }
    /// Where the largest error is.
    const std::string& where(std::size_t sample) const { return errors_[sample].first; }

private:
    struct Size {
        Vector3 low = Vector3::Constant(1e300), high = -low;
        double size = 0.0, scale = 0.0;
    };

    void take(const std::string& body, Kind kind, const Vector3& v) {
        Size& s = sizes_[{body, kind}];
        s.low = s.low.cwiseMin(v);
        s.high = s.high.cwiseMax(v);
        s.size = std::max(s.size, v.norm());
    }
    void widen(double t) {
        for (const auto& [name, handle] : case_.body) {
            const BodyMotion m = run_[handle];
            take(name, Kind::place, m.center_of_mass(t));
            take(name, Kind::speed, m.center_of_mass_velocity(t));
            take(name, Kind::turning, m.angular_velocity_world(t));
            if (std::holds_alternative<Free>(case_.scene.bodies()[static_cast<std::size_t>(handle.index)].joint))
                continue;
            take(name, Kind::force, m.reaction(t));
            take(name, Kind::torque, m.reaction_torque(t));
        }
        for (std::size_t k = 0; k < case_.loops.size(); ++k)
            take("loop " + std::to_string(k), Kind::force, run_[case_.loops[k]].force(t));
    }
    /// Of what hardly is there beside its kind, the scale is that of the kind.
    double scale(const std::string& body, Kind kind) const {
        const auto found = sizes_.find({body, kind});
        const double own = found == sizes_.end() ? 0.0 : found->second.scale,
                     most = largest_[static_cast<std::size_t>(kind)];
        return own > 1e-6 * most ? own : most;
    }

    /// Where the largest error of a sample is, and it.
    std::pair<std::string, double> see(const json& s, double t) const {
        std::pair<std::string, double> worst{"nothing", 0.0};
        const auto compare = [&](const std::string& name, Kind kind, double error, double over) {
            const double e = relative(error, over);
            if (!(e <= worst.second)) worst = {name + " " + names[static_cast<std::size_t>(kind)], e};
        };
        const auto vectors = [&](const std::string& name, Kind kind, const Vector3& value, const json& right) {
            // what is printed of planar motions lies in the plane
            Vector3 seen = value;
            if (right.size() == 2) seen[2] = 0.0;
            compare(name, kind, (seen - vector(right)).norm(), scale(name, kind));
        };
        for (const auto& [key_of_body, values] : s["bodies"].items()) {
            // clang 14 takes no structured binding into a lambda
            const auto& name = key_of_body;
            const auto& b = values;
            const BodyMotion m = run_[case_.body.at(name)];
            if (b.contains("com")) vectors(name, Kind::place, m.center_of_mass(t), b["com"]);
            if (b.contains("com_velocity")) vectors(name, Kind::speed, m.center_of_mass_velocity(t), b["com_velocity"]);
            if (b.contains("position"))
                compare(name, Kind::place, (m.position(t) - vector(b["position"])).norm(), scale(name, Kind::place));
            if (b.contains("velocity"))
                compare(name, Kind::speed, (m.velocity(t) - vector(b["velocity"])).norm(), scale(name, Kind::speed));
            if (b.contains("quaternion"))
                compare(name, Kind::attitude, turn_between(m.quaternion(t), quaternion_of(b["quaternion"])), 1.0);
            if (b.contains("angular_velocity_world"))
                vectors(name, Kind::turning, m.angular_velocity_world(t), b["angular_velocity_world"]);
            if (b.contains("angular_velocity"))
                compare(name, Kind::turning, (m.angular_velocity(t) - vector(b["angular_velocity"])).norm(),
                        scale(name, Kind::turning));
            if (b.contains("reaction_force")) vectors(name, Kind::force, m.reaction(t), b["reaction_force"]);
            if (b.contains("reaction_torque")) vectors(name, Kind::torque, m.reaction_torque(t), b["reaction_torque"]);
            if (b.contains("reaction_torque_z"))
                compare(name, Kind::torque, std::abs(m.reaction_torque(t)[2] - number(b["reaction_torque_z"])),
                        scale(name, Kind::torque));
            // coordinates are differences of what two bodies do
            const auto coordinate = [&](Kind kind, double value, const char* key, double size) {
                compare(name, kind, 0.5 * std::abs(value - number(b[key])), size);
            };
            if (b.contains("angle")) {
                coordinate(Kind::angle, m.angle(t), "angle", 1.0);
                coordinate(Kind::rate, m.rate(t), "rate", largest_[static_cast<std::size_t>(Kind::turning)]);
            }
            if (b.contains("displacement")) {
                coordinate(Kind::place, m.displacement(t), "displacement", scale(name, Kind::place));
                coordinate(Kind::speed, m.rate(t), "rate", scale(name, Kind::speed));
            }
            if (b.contains("angle1")) {
                const auto [first, second] = m.angles(t);
                const auto [first_rate, second_rate] = m.rates(t);
                const double fastest = largest_[static_cast<std::size_t>(Kind::turning)];
                coordinate(Kind::angle, first, "angle1", 1.0);
                coordinate(Kind::angle, second, "angle2", 1.0);
                coordinate(Kind::rate, first_rate, "rate1", fastest);
                coordinate(Kind::rate, second_rate, "rate2", fastest);
            }
        }
        if (s.contains("closure_force"))
            for (std::size_t k = 0; k < case_.loops.size(); ++k) {
                const std::string name = "loop " + std::to_string(k);
                vectors(name, Kind::force, run_[case_.loops[k]].force(t), s["closure_force"][k]);
            }
        return worst;
    }

    const Case& case_;
    const Trajectory& run_;
    std::map<std::pair<std::string, Kind>, Size> sizes_;
    double largest_[static_cast<std::size_t>(Kind::count)] = {};
    std::vector<std::pair<std::string, double>> errors_;
    std::pair<std::string, double> start_{"nothing", 0.0};
};

/// What rounding of the start and of each of some steps may come to at a sample.
inline double roundings(const Case& of, std::size_t sample) { return 1e-16 * 20.0 * std::max(1.0, of.growth(sample)); }

}  // namespace rbdyn::test::figures
