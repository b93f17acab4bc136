// Which rbdyn is this?
#include <iostream>
#include <rbdyn/rbdyn.hpp>

int main() { std::cout << "rbdyn " << rbdyn::version << '\n'; }
