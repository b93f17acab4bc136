#include "rbdyn/basics/error.hpp"
#include "target.hpp"

namespace rbdyn::fuzz {

void give(const Target& target, std::string_view input) {
    try {
        target.run(input);
    } catch (const Error& refused) {
        require(std::string_view(refused.what()).size() > 10, "a refusal says nothing: " + std::string(refused.what()));
    }
}

}  // namespace rbdyn::fuzz
