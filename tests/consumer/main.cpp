// A user's program, built against an installed rbdyn.
#include <iostream>
#include <rbdyn/rbdyn.hpp>

int main() { std::cout << "rbdyn " << rbdyn::version << '\n'; }
