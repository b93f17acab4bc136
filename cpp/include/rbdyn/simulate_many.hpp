// simulate_many(): one scene, thousands of starts and numbers.
//
// Members are runs of their own: each is, bit for bit, what simulate() makes of its scene, whatever the number of
// threads and whatever became of the others. Plans are kept from one to the next (plan/kept_plan.hpp); each thread has
// several members on their way, whose Taylor series are expanded side by side (member_abreast.hpp).
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/parameter.hpp"
#include "rbdyn/options.hpp"
#include "rbdyn/scene/handles.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/starts.hpp"
#include "rbdyn/simulate.hpp"
#include "rbdyn/trajectory/trajectory.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What one member has of its own: where bodies start, and values of numbers.
struct Variation {
    std::vector<std::pair<BodyHandle, Start>> starts = {};
    BoundParameters::Values numbers = {};
};

/// What became of one member.
struct Member {
    std::optional<Attempt> attempt = std::nullopt;  // its run, whole or partial; none of one that did not begin
    std::exception_ptr refused = nullptr;           // why it did not: null of one that an interruption came before

    bool is_good() const { return attempt && attempt->outcome == simulating::Outcome::good; }
    /// Its run. Throws what simulate() would have thrown, and Error for one that was not begun.
    const Trajectory& run() const;
};

struct ManyOptions {
    SimulateOptions run = {};  // of each member; its monitor is not called
    int threads = 0;           // 0: one for each processor
    bool lanes = true;         // several members side by side where that is quicker, to the same bits
    std::function<bool(double)> monitor = nullptr;  // called now and then with the fraction that is done, in the thread
                                                    // that waits; false stops all that is not done
};

/// Runs a scene once for each variation; the scene and the numbers stay as they are. A member that fails or is refused
/// does not stop the others. Throws InvalidInput for options, starts and numbers that break a rule, before any of them
/// runs. Functions that are called back are called on all threads at once.
std::vector<Member> simulate_many(const Scene& scene, const std::vector<Variation>& members,
                                  const ManyOptions& options);

/// The same for `count` members, each with the scene that a function of its number makes; it is called on all threads
/// at once. What it throws is why the member is refused. Copies of one scene that start elsewhere (Scene::replace)
/// share their plans.
std::vector<Member> simulate_many(std::size_t count, const std::function<Scene(std::size_t)>& scene,
                                  const ManyOptions& options);

}  // namespace rbdyn::inline RBDYN_FORM
