// Targets that are texts: scenes' files, and functions as these have them. And functions as they are pickled.
#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bytes.hpp"
#include "rbdyn/file/functions.hpp"
#include "rbdyn/file/place.hpp"
#include "rbdyn/file/scene_file.hpp"
#include "target.hpp"
#include "use.hpp"

namespace rbdyn::fuzz {

namespace {

void use(const Function& f) {
    const std::vector<double> at(static_cast<std::size_t>(f.inputs()), 0.5);
    f(std::span<const double>(at));
    if (f.inputs() > 0) f.derivative(f.inputs() - 1)(std::span<const double>(at));
    f.distinctions();
    require(!f.text().empty() || f.size() == 0, "a function has no text");
    file::Writing writing;
    const file::Json json = file::function_to(f, writing);
    file::Reading reading{"function"};
    require(file::function_from(file::Place(json, "function", reading)) == f, "a function comes back changed");
    if (f.outputs() != f.inputs() - 1) return;
    const System system(OwnFunction(f, "f"), std::vector<double>(static_cast<std::size_t>(f.outputs()), 0.5));
    simulate(system, {.until = 0.2, .rtol = 1e-4, .max_steps = 40});
}

}  // namespace

void scene_file(std::string_view text) {
    const Scene scene = scene_from(text);
    const std::string written = text_of(scene);
    const Scene again = scene_from(written);
    require(again == scene, "a scene comes back changed");
    require(text_of(again) == written, "the text of a scene comes back changed");
    use(scene);
}

void function(std::string_view text) {
    const file::Json json = file::parsed(text, "function");
    file::Reading reading{"function"};
    const Function f = file::function_from(file::Place(json, "function", reading));
    if (f.inputs() <= 1000) use(f);
}

void program(std::string_view input) {
    Bytes bytes(input);
    const int inputs = bytes.choice(6), results = bytes.choice(6);
    const auto index = [&] { return static_cast<std::int32_t>(bytes.byte()) - 2; };
    std::vector<std::int32_t> outputs;
    for (int i = 0; i < results; ++i) outputs.push_back(index());
    std::vector<Node> nodes;
    while (!bytes.is_over() && nodes.size() < 60) {
        Node n{static_cast<Operation>(bytes.choice(24))};
        n.a = index();
        if (bytes.choice(2) == 1) n.b = index();
        if (bytes.choice(2) == 1) n.c = index();
        const bool may_have_name =
            n.operation == Operation::sign || n.operation == Operation::whole || n.operation == Operation::select;
        if (may_have_name && bytes.choice(4) == 1) n.d = index();
        n.value = bytes.number();
        n.is_wide = bytes.choice(8) == 1;
        if (n.is_wide) n.rest = 1e-17 * bytes.number();
        nodes.push_back(n);
    }
    const bool has_name = std::any_of(nodes.begin(), nodes.end(), [](const Node& n) { return n.d >= 0; });
    use(Function::from_data(inputs, nodes, outputs,
                            has_name ? std::vector<std::string>{"a name"} : std::vector<std::string>(), {}));
}

}  // namespace rbdyn::fuzz
