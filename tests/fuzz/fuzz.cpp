// libFuzzer's entry: the environment variable RBDYN_FUZZ names the target.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>

#include "target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const rbdyn::fuzz::Target* const target = [] {
        const char* const wanted = std::getenv("RBDYN_FUZZ");
        for (const rbdyn::fuzz::Target& one : rbdyn::fuzz::targets)
            if (wanted != nullptr && one.name == wanted) return &one;
        std::fputs("RBDYN_FUZZ names no target\n", stderr);
        std::exit(2);
    }();
    try {
        rbdyn::fuzz::give(*target, {reinterpret_cast<const char*>(data), size});
    } catch (const std::exception& e) {
        std::fprintf(stderr, "find: %s\n", e.what());
        std::abort();
    }
    return 0;
}
