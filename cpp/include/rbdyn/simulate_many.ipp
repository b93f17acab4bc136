// Definitions of rbdyn/simulate_many.hpp.
#pragma once

#include "rbdyn/simulate_many.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/event/abreast.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/parameter.hpp"
#include "rbdyn/member_abreast.hpp"
#include "rbdyn/options.hpp"
#include "rbdyn/plan/kept_plan.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/scene/starts.hpp"
#include "rbdyn/simulate.hpp"
#include "rbdyn/trajectory/trajectory.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE const Trajectory& Member::run() const {
    if (refused) std::rethrow_exception(refused);
    if (!attempt) throw Error("simulate_many: this member was not begun, for all were stopped before");
    require_good(*attempt);
    return attempt->run;
}

}  // namespace rbdyn::inline RBDYN_FORM

namespace rbdyn::inline RBDYN_FORM::simulating {

// far below the second within which an interruption is obeyed
inline constexpr auto looks = std::chrono::milliseconds(50);

/// Members in their order, taken one by one by several threads.
class Members {
public:
    /// The scene of a member, which is `own` or outlives it.
    using SceneOf = std::function<const Scene&(std::size_t, std::optional<Scene>& own)>;
    using NumbersOf = std::function<const BoundParameters::Values&(std::size_t)>;

    /// `numbers`: those of a member; `now`: of all of them, what is not their own.
    Members(std::size_t count, SceneOf scene, NumbersOf numbers, const BoundParameters::Values& now,
            const ManyOptions& options)
        : scene_of_(std::move(scene)), numbers_of_(std::move(numbers)), now_(now), options_(options), members_(count) {
        validate(options_.run);
        require_engine("simulate_many", options_.run.engine);
        require(options_.threads >= 0, "simulate_many", "threads", options_.threads,
                "it is positive, or 0 for one on each processor");
    }

    std::vector<Member> run() {
        const std::size_t wanted = options_.threads > 0 ? static_cast<std::size_t>(options_.threads)
                                                        : std::max(1U, std::thread::hardware_concurrency());
        const std::size_t threads = std::max<std::size_t>(std::min(wanted, members_.size()), 1);
        // each thread has its share
        const bool is_endless = options_.run.until == std::numeric_limits<double>::infinity();
        if (options_.lanes && !is_endless) room_ = std::min(Abreast::room(), (members_.size() + threads - 1) / threads);
        if (threads <= 1)
            here();
        else
            apart(threads);
        return std::move(members_);
    }

private:
    using Clock = std::chrono::steady_clock;

    /// Takes members until there are none left; `look` is asked now and then whether to go on.
    void work(const std::function<void()>& look) {
        SimulateOptions options = options_.run;
        options.monitor = [&](double) {
            look();
            return goes_on_.load();
        };
        const BoundParameters as_they_are(now_);
        if (room_ > 1)
            side_by_side(options, look);
        else
            one_by_one(options, look);
    }

    /// The next member that none has taken; none if there is none.
    std::optional<std::size_t> taken() {
        if (!goes_on_) return std::nullopt;
        const std::size_t i = next_++;
        return i < members_.size() ? std::optional(i) : std::nullopt;
    }

    /// What becomes of a member, by a function that may throw; then `look`.
    template <class Made>
    void settle(std::size_t i, const Made& made, const std::function<void()>& look) {
        try {
            members_[i].attempt = made();
        } catch (...) {
            members_[i].refused = std::current_exception();
        }
        ++done_;
        look();
    }

    void one_by_one(const SimulateOptions& options, const std::function<void()>& look) {
        while (const auto i = taken())
            settle(
                *i,
                [&] {
                    const BoundParameters own(numbers_of_(*i));
                    std::optional<Scene> scene;
                    return attempt(scene_of_(*i, scene), options);
                },
                look);
    }

    /// Several on their way at once.
    void side_by_side(const SimulateOptions& options, const std::function<void()>& look) {
        struct OnItsWay {
            std::size_t index;
            std::unique_ptr<MemberAbreast> member;
        };
        std::vector<OnItsWay> all;
        Abreast abreast;
        std::vector<RunAbreast*> runs;
        for (;;) {
            while (all.size() < room_) {
                const auto i = taken();
                if (!i) break;
                std::unique_ptr<MemberAbreast> member;
                try {
                    const BoundParameters own(numbers_of_(*i));
                    std::optional<Scene> scene;
                    member = std::make_unique<MemberAbreast>(scene_of_(*i, scene), options, numbers_of_(*i));
                } catch (...) {
                    settle(
                        *i, [&]() -> Attempt { throw; }, look);
                    continue;
                }
                all.push_back({*i, std::move(member)});
            }
            if (all.empty()) return;
            // those that wait for others go on before they are finished
            std::erase_if(all, [&](OnItsWay& one) {
                while (one.member->run() != nullptr && one.member->run()->is_over()) one.member->go_on();
                if (one.member->run() != nullptr) return false;
                settle(
                    one.index, [&] { return one.member->attempt(); }, look);
                return true;
            });
            runs.clear();
            for (const OnItsWay& one : all) runs.push_back(one.member->run());
            if (runs.size() == room_ || next_ >= members_.size() || !goes_on_) {
                // until one is over
                const auto is_over = [](const RunAbreast* run) { return run->is_over(); };
                while (!runs.empty() && std::none_of(runs.begin(), runs.end(), is_over)) abreast.turn(runs);
            }
        }
    }

    void ask() {
        if (!options_.monitor || !goes_on_) return;
        if (!options_.monitor(static_cast<double>(done_) / static_cast<double>(members_.size()))) goes_on_ = false;
    }

    /// All in this thread.
    void here() {
        Clock::time_point last = Clock::now();
        std::exception_ptr thrown;
        work([&] {
            if (thrown || Clock::now() - last < looks) return;
            try {
                ask();
            } catch (...) {
                thrown = std::current_exception();
                goes_on_ = false;
            }
            last = Clock::now();
        });
        if (thrown) std::rethrow_exception(thrown);
    }

    /// On threads of their own, while this one waits.
    void apart(std::size_t threads) {
        std::mutex mutex;
        std::condition_variable ended;
        std::size_t working = threads;
        const auto body = [&] {
            work([] {});
            const std::lock_guard lock(mutex);
            if (--working == 0) ended.notify_one();
        };
        struct Stop {  // before the threads are waited for
            std::atomic<bool>& goes_on;
            ~Stop() { goes_on = false; }
        };
        std::vector<std::jthread> all;
        const Stop stop{goes_on_};
        for (std::size_t k = 0; k < threads; ++k) all.emplace_back(body);
        std::unique_lock lock(mutex);
        while (!ended.wait_for(lock, looks, [&] { return working == 0; })) {
            lock.unlock();
            ask();
            lock.lock();
        }
    }

    SceneOf scene_of_;
    NumbersOf numbers_of_;
    const BoundParameters::Values& now_;
    const ManyOptions& options_;
    std::size_t room_ = 0;  // members that a thread has on their way; up to 1: one after the other
    std::vector<Member> members_;
    std::atomic<std::size_t> next_{0}, done_{0};
    std::atomic<bool> goes_on_{true};
};

/// What a member has of its own, checked.
struct Checked {
    std::vector<std::pair<BodyHandle, Started>> starts;
    BoundParameters::Values numbers;
};

RBDYN_INLINE std::vector<Checked> checked(const Scene& scene, const std::vector<Variation>& members) {
    std::vector<Checked> all;
    all.reserve(members.size());
    Scene tried = scene;
    for (const Variation& v : members) {
        try {
            Checked& own = all.emplace_back();
            for (const auto& [body, start] : v.starts) {
                tried.replace(body, start);
                own.starts.emplace_back(body, tried.bodies()[static_cast<std::size_t>(body.index)]);
            }
            own.numbers = v.numbers;
            const BoundParameters bound(own.numbers);
        } catch (const InvalidInput& e) {
            throw InvalidInput("simulate_many, member " + std::to_string(all.size() - 1) + ": " + e.what());
        }
    }
    return all;
}

}  // namespace rbdyn::inline RBDYN_FORM::simulating

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::vector<Member> simulate_many(const Scene& scene, const std::vector<Variation>& members,
                                               const ManyOptions& options) {
    const std::vector<simulating::Checked> all = simulating::checked(scene, members);
    // all numbers as they are now, whatever other threads make of them meanwhile
    const GivenNumbers given = planning::numbers_of(scene);
    BoundParameters::Values now;
    for (std::size_t k = 0; k < given.cells.size(); ++k) now.emplace_back(given.cells[k], given.values[k]);
    const auto scene_of = [&](std::size_t i, std::optional<Scene>& own) -> const Scene& {
        if (all[i].starts.empty()) return scene;
        own = scene;
        for (const auto& [body, start] : all[i].starts) own->replace(body, start);
        return *own;
    };
    const auto numbers_of = [&](std::size_t i) -> const BoundParameters::Values& { return all[i].numbers; };
    return simulating::Members(members.size(), scene_of, numbers_of, now, options).run();
}

RBDYN_INLINE std::vector<Member> simulate_many(std::size_t count, const std::function<Scene(std::size_t)>& scene,
                                               const ManyOptions& options) {
    const auto scene_of = [&](std::size_t i, std::optional<Scene>& own) -> const Scene& {
        return own.emplace(scene(i));
    };
    const BoundParameters::Values none;
    const auto numbers_of = [&](std::size_t) -> const BoundParameters::Values& { return none; };
    return simulating::Members(count, scene_of, numbers_of, none, options).run();
}

}  // namespace rbdyn::inline RBDYN_FORM
