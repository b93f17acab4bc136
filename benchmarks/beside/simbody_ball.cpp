// The bouncing ball of benchmarks/siconos.py in Simbody, by rigid contact (its time stepper of semi-explicit Euler
// steps with Newton's restitution) and by compliant contact (Hunt and Crossley's, on a half space). Built and run by
// benchmarks/siconos.py where Simbody is found. Prints: name; steps; place; velocity; seconds of processor time.
#include <Simbody.h>

#include <cstdio>
#include <ctime>

using namespace SimTK;

namespace {

constexpr double height = 10.0, g = 9.81, restitution = 0.9, until = 20.0, radius = 0.1;

double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void tell(const char* name, long steps, double place, double velocity, double seconds) {
    std::printf("%s;%ld;%.17g;%.17g;%.17g\n", name, steps, place, velocity, seconds);
    std::fflush(stdout);
}

void rigid(double h) {
    MultibodySystem system;
    SimbodyMatterSubsystem matter(system);
    GeneralForceSubsystem forces(system);
    Force::Gravity gravity(forces, matter, Vec3(0, 0, -g));
    MobilizedBody::Translation ball(matter.Ground(),
                                    Body::Rigid(MassProperties(1.0, Vec3(0), UnitInertia::sphere(radius))));
    matter.adoptUnilateralContact(
        new PointPlaneFrictionlessContact(matter.Ground(), UnitVec3(0, 0, 1), 0.0, ball, Vec3(0), restitution));
    State state = system.realizeTopology();
    ball.setQ(state, Vec3(0, 0, height));
    SemiExplicitEulerTimeStepper stepper(system);
    stepper.setRestitutionModel(SemiExplicitEulerTimeStepper::Newton);
    // no speed is so low that it is taken for rest
    stepper.setDefaultImpactCaptureVelocity(1e-9);
    stepper.setDefaultImpactMinCORVelocity(1e-8);
    stepper.initialize(state);
    const double begin = processor_time();
    const long steps = static_cast<long>(until / h + 0.5);
    for (long k = 1; k <= steps; ++k) stepper.stepTo(static_cast<double>(k) * h);
    const double seconds = processor_time() - begin;
    const State& end = stepper.getState();
    char name[80];
    std::snprintf(name, sizeof name, "Simbody, rigid, steps of %g s", h);
    tell(name, steps, ball.getQ(end)[2], ball.getU(end)[2], seconds);
}

void compliant(double stiffness, double accuracy) {
    MultibodySystem system;
    SimbodyMatterSubsystem matter(system);
    GeneralForceSubsystem forces(system);
    Force::Gravity gravity(forces, matter, Vec3(0, 0, -g));
    MobilizedBody::Translation ball(matter.Ground(),
                                    Body::Rigid(MassProperties(1.0, Vec3(0), UnitInertia::sphere(radius))));
    GeneralContactSubsystem contacts(system);
    const ContactSetIndex set = contacts.createContactSet();
    contacts.addBody(set, ball, ContactGeometry::Sphere(radius), Transform());
    // a half space is x > 0 of its own
    contacts.addBody(set, matter.updGround(), ContactGeometry::HalfSpace(),
                     Transform(Rotation(Pi / 2, YAxis), Vec3(0, 0, -radius)));
    HuntCrossleyForce contact(forces, contacts, set);
    // dissipation c with e = 1 - c v for slow impacts (its manual): at the first speed
    const double c = (1.0 - restitution) / std::sqrt(2.0 * g * height);
    contact.setBodyParameters(ContactSurfaceIndex(0), stiffness, c, 0, 0, 0);
    contact.setBodyParameters(ContactSurfaceIndex(1), stiffness, c, 0, 0, 0);
    State state = system.realizeTopology();
    ball.setQ(state, Vec3(0, 0, height));
    RungeKuttaMersonIntegrator integrator(system);
    integrator.setAccuracy(accuracy);
    TimeStepper stepper(system, integrator);
    stepper.initialize(state);
    const double begin = processor_time();
    stepper.stepTo(until);
    const double seconds = processor_time() - begin;
    const State& end = stepper.getState();
    char name[80];
    std::snprintf(name, sizeof name, "Simbody, compliant, %.0e N/m^1.5 a side, accuracy %.0e", stiffness, accuracy);
    tell(name, integrator.getNumStepsTaken(), ball.getQ(end)[2], ball.getU(end)[2], seconds);
}

}  // namespace

int main() {
    try {
        for (const double h : {1e-2, 1e-3, 1e-4}) rigid(h);
        for (const double stiffness : {1e6, 1e9}) compliant(stiffness, 1e-6);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
