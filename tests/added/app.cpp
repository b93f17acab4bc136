#include <rbdyn/rbdyn.hpp>
int main() { return rbdyn::Scene().bodies().empty() ? 0 : 1; }
