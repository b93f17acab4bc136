// As if it were compiled for rbdyn::header_only.
#include <rbdyn/scene/scene.hpp>

double height_of(const rbdyn::Scene& scene);
double height_of(const rbdyn::Scene& scene) { return scene.gravity()[2]; }
