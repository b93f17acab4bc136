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
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/parameter.hpp"
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
    using One = std::function<Attempt(std::size_t, const SimulateOptions&)>;

    Members(std::size_t count, const One& one, const ManyOptions& options)
        : one_(one), options_(options), members_(count) {
        validate(options_.run);
        require_engine("simulate_many", options_.run.engine);
        require(options_.threads >= 0, "simulate_many", "threads", options_.threads,
                "it is positive, or 0 for one on each processor");
    }

    std::vector<Member> run() {
        const std::size_t wanted = options_.threads > 0 ? static_cast<std::size_t>(options_.threads)
                                                        : std::max(1U, std::thread::hardware_concurrency());
        const std::size_t threads = std::min(wanted, members_.size());
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
        for (std::size_t i = next_++; i < members_.size() && goes_on_; i = next_++) {
            try {
                members_[i].attempt = one_(i, options);
            } catch (...) {
                members_[i].refused = std::current_exception();
            }
            ++done_;
            look();
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

    const One& one_;
    const ManyOptions& options_;
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
    const simulating::Members::One one = [&](std::size_t i, const SimulateOptions& run) {
        const BoundParameters as_they_are(now), own(all[i].numbers);
        if (all[i].starts.empty()) return attempt(scene, run);
        Scene member = scene;
        for (const auto& [body, start] : all[i].starts) member.replace(body, start);
        return attempt(member, run);
    };
    return simulating::Members(members.size(), one, options).run();
}

RBDYN_INLINE std::vector<Member> simulate_many(std::size_t count, const std::function<Scene(std::size_t)>& scene,
                                               const ManyOptions& options) {
    const simulating::Members::One one = [&](std::size_t i, const SimulateOptions& run) {
        return attempt(scene(i), run);
    };
    return simulating::Members(count, one, options).run();
}

}  // namespace rbdyn::inline RBDYN_FORM
