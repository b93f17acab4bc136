// Mistakes in functors of one's own. It does not compile: for each mistake a compiler says one line of an error, that
// of the comment behind it (check.cmake).
#include <rbdyn/rbdyn.hpp>

#include <cmath>
#include <span>
#include <vector>

using rbdyn::Vector3, rbdyn::Vector3Of;

struct Model {
    void operator()(double, std::span<const double>, std::span<double>) const {}
};

int main() {
    // what is returned
    rbdyn::Force([](const auto& t, const auto&, const auto&) { return 2.0 * t; });    // says: three components
    rbdyn::Torque([](const auto&, const auto&, const auto& w) { return w.norm(); });  // says: three components
    rbdyn::PairForce([](const auto&, const auto& ra, const auto&, const auto&, const auto&) {
        ra.norm();
    });                                                                                     // says: three components
    rbdyn::Curve([](const auto& u) { return u; });                                          // says: three components
    rbdyn::RigidMotion::translation([](const auto& t) { return t; });                       // says: three components
    rbdyn::Pole([](const auto& t) { return t; });                                           // says: three components
    rbdyn::Potential([](const auto& r) { return r; });                                      // says: one number
    rbdyn::JointTorque([](const auto&, const auto&, const auto&) {});                       // says: one number
    rbdyn::Central([](const auto&) { return "1 N"; });                                      // says: one number
    rbdyn::RigidMotion::rotation([](const auto&) { return Vector3(0, 0, 1); }, {0, 0, 1});  // says: one number
    rbdyn::TimeFunction([](const auto&) { return Vector3(0, 0, 1); });                      // says: one number
    rbdyn::WatchFunction([](const rbdyn::Now& now) { return "late"; });                     // says: one number

    // what is taken
    rbdyn::Force([](double, Vector3 r, Vector3) -> Vector3 { return -r; });  // says: f(t, position, velocity)
    rbdyn::Torque([](double, Vector3) { return Vector3(); });  // says: f(t, rotation_matrix, angular_velocity)
    rbdyn::Potential([](double x, double y, double z) { return x * y * z; });    // says: f(position)
    rbdyn::JointForce([](double t) { return t; });                               // says: f(t, q, rate)
    rbdyn::Central([](double r) { return r; });                                  // says: f(distance)
    rbdyn::PairForce([](Vector3 a, Vector3) { return a; });                      // says: f(t, r_a, r_b, v_a, v_b)
    rbdyn::Curve([](double u) { return Vector3(u, 0, 0); });                     // says: f(u)
    rbdyn::RigidMotion::translation([](double t) { return Vector3(t, 0, 0); });  // says: f(t),
    rbdyn::RigidMotion::rotation([](double t) { return t; }, {0, 0, 1});         // says: angle(t)
    rbdyn::System([](double, std::span<const double>, std::span<double>) {},
                  {1.0})                                      // says: f(t, x, rate), a number and two spans
        .watch("w", [](double t) { return t; });              // says: f(t, x)
    rbdyn::simulate(Model{}, {1.0}, {.until = 1.0});          // says: model(t, x, rate)
    rbdyn::RailOptions{.drive = [](double t) { return t; }};  // says: f(t), with
    rbdyn::Scene().watch("late", [](const rbdyn::Now& now, int) { return now.time(); });  // says: f(now)
    rbdyn::Force(static_cast<double (*)(double, Vector3, Vector3)>(nullptr));  // says: f(t, position, velocity)

    // what is done: errors in the user's own line
    rbdyn::Force([](const auto& t, const auto&, const auto&) {
        return Vector3Of<rbdyn::Expression>{std::sin(t), 0.0, 0.0};  // here: sin
    });
    rbdyn::JointTorque([](const auto&, const auto& q, const auto&) {
        double number = q;  // here: double
        return number;
    });
    rbdyn::TimeFunction([](const auto& t) {
        return t > 0.0 ? t : -t;  // here: bool
    });
}
