// Links the library; the function it calls is compiled with definitions of its own.
#include <rbdyn/scene/scene.hpp>

double height_of(const rbdyn::Scene& scene);

int main() { return height_of(rbdyn::Scene()) == 0.0 ? 0 : 1; }
