// Random beads, none of whose numbers is dyadic, against their motion in more digits than doubles have
// (bead_truth.hpp): the true error is at most what was asked for in every run that returns, and at most what is told.
//
// RBDYN_RANDOM_BEADS: how many (default 200); RBDYN_RANDOM_FIRST: number of the first; RBDYN_TEST_TABLE=1 prints the
// distribution of true over told errors.
#include <gtest/gtest.h>

#include <iomanip>
#include <iostream>
#include <map>

#include "points/bead_truth.hpp"

namespace rbdyn::test::test_beads {
namespace {

using beads::Bead;
using beads::Real;

/// A few are driven faster and faster; a run of one round in a million is no question of digits.
constexpr std::int64_t most_steps = 300000;

/// What is found of one run.
struct Found {
    enum class Outcome { good, refused, unknown, other_events };
    Outcome outcome = Outcome::good;
    double asked = 0.0, told = 0.0, truth = 0.0;
    const char* what = "";
    std::string bead = {};  // in words
};

Found examined(std::uint64_t number) {
    Random random(0x5eed0000u + number);
    Bead bead(random);
    Found found;
    found.bead = bead.text();
    found.asked = std::pow(10.0, -random.uniform(6.0, 13.0));
    Scene scene;
    const BodyHandle b = bead.add_to(scene);
    const Attempt attempted = attempt(scene, {.until = bead.until, .error = found.asked, .max_steps = most_steps});
    if (attempted.outcome != simulating::Outcome::good) {
        found.outcome = Found::Outcome::refused;
        found.what = attempted.outcome == simulating::Outcome::inaccurate ? "inaccurate" : "broken";
        found.bead += ". " + attempted.message;
        return found;
    }
    const Trajectory& run = attempted.run;
    if (!run.error()) {
        found.outcome = Found::Outcome::refused;
        found.what = "too many steps";
        return found;
    }
    found.told = *run.error();
    for (const Event& e : run.events())
        if (e.kind == EventKind::normal_zero) {
            // friction has a corner there, which the truth does not look for
            found.outcome = Found::Outcome::unknown;
            found.what = "a reaction through zero";
            return found;
        }

    // the truth at times of no pattern, twice
    constexpr int count = 12;
    std::vector<double> times;
    for (int k = 1; k < count; ++k) times.push_back(run.end() * (k - random.uniform(0.0, 1.0)) / count);
    times.push_back(run.end());
    struct Sample {
        double time;
        beads::Seen seen;
    };
    std::vector<Sample> samples[2];
    double unknown = 0.0;
    Bead other = bead;
    Bead* both[] = {&bead, &other};
    for (int i = 0; i < 2; ++i) {
        both[i]->begin(i == 0 ? 0.1 : 0.037);
        for (const double t : times) {
            both[i]->advance(t);
            if (both[i]->end != Bead::End::reached) break;
            samples[i].push_back({t, both[i]->seen()});
        }
    }
    if (bead.end == Bead::End::lost || other.end != bead.end || samples[0].size() != samples[1].size() ||
        bead.reversals.size() != other.reversals.size() || bead.margin < 1e-6) {
        found.outcome = Found::Outcome::unknown;
        found.what = bead.end == Bead::End::lost ? "truth lost" : "truth undecided";
        return found;
    }

    found.bead += bead.end == Bead::End::stuck ? ", sticks" : bead.end == Bead::End::rail_end ? ", to the end" : "";
    const Scales s = scales(run, b, 300);
    const auto take = [&](double error, const char* what) {
        if (!(error <= found.truth)) {
            found.truth = error;
            found.what = what;
        }
    };
    double effort = 0.0, surface = 0.0;
    for (const Sample& sample : samples[0])
        surface = std::max(surface, std::abs(run[b].report(sample.time).rail_speed));
    for (const Sample& sample : samples[0]) effort = std::max(effort, sample.seen.effort);
    for (std::size_t k = 0; k < samples[0].size(); ++k) {
        const beads::Seen &p = samples[0][k].seen, &q = samples[1][k].seen;
        // velocities go by those of the rail's surface, too; a reaction that is rounding of the forces is none
        const double place = s.extent, speed = std::max(s.speed, surface),
                     reaction = std::max(s.reaction, 1e-3 * effort);
        unknown = std::max({unknown, static_cast<double>(beads::norm(p.position - q.position)) / place,
                            static_cast<double>(beads::norm(p.velocity - q.velocity)) / speed,
                            static_cast<double>(beads::norm(p.reaction - q.reaction)) / reaction});
        const PointReport r = run[b].report(samples[0][k].time);
        take(beads::distance(r.position, p.position) / place, "position");
        take(beads::distance(r.velocity, p.velocity) / speed, "velocity");
        if (s.reaction > 1e-12 * effort) take(beads::distance(r.reaction, p.reaction) / reaction, "reaction");
    }
    std::vector<Real> expected = bead.reversals;
    if (bead.end != Bead::End::reached) expected.push_back(bead.time());
    std::vector<double> reached;
    std::vector<EventKind> kinds;
    for (const Event& e : run.events()) {
        if (e.kind != EventKind::reverse && e.kind != EventKind::stick && e.kind != EventKind::rail_end) continue;
        reached.push_back(e.time);
        kinds.push_back(e.kind);
        if (e.kind == EventKind::stick) break;
    }
    if (reached.size() != expected.size()) {
        found.bead += ", events";
        for (const double t : reached) found.bead += " " + text(t);
        found.bead += " for";
        for (const Real t : expected) found.bead += " " + text(static_cast<double>(t));
        // what happens at the end itself is on one side of it or the other
        const std::size_t most = std::max(reached.size(), expected.size());
        const double last = reached.size() == most ? reached.back() : static_cast<double>(expected.back());
        if (most - std::min(reached.size(), expected.size()) > 1 || last < run.end() * (1.0 - found.asked))
            found.outcome = Found::Outcome::other_events;
    }
    for (std::size_t k = 0; k < std::min(reached.size(), expected.size()); ++k)
        take(static_cast<double>(beads::size_of(Real(reached[k]) - expected[k]) / expected[k]), "time of an event");
    // where the truth is not known to a hundredth of what is asked
    if (unknown > 1e-2 * std::min(found.asked, found.told)) {
        found.outcome = Found::Outcome::unknown;
        found.what = "truth known to few digits";
    }
    return found;
}

TEST(Beads, no_true_error_exceeds_what_was_asked_or_what_is_told) {
    const int count = setting("RBDYN_RANDOM_BEADS", 200), first = setting("RBDYN_RANDOM_FIRST", 0);
    const bool prints = setting("RBDYN_TEST_TABLE", 0) > 0;
    std::map<std::string, int> outcomes;
    std::map<int, std::vector<double>> ratios;
    double worst_asked = 0.0;
    int above_asked = 0, above_told = 0;
    for (int i = first; i < first + count; ++i) {
        Found f;
        try {
            f = examined(static_cast<std::uint64_t>(i));
        } catch (const Error& e) {
            if (prints) std::cout << "bead " << i << ": " << e.what() << '\n';
            ++outcomes["thrown"];
            continue;
        }
        switch (f.outcome) {
            case Found::Outcome::refused:
            case Found::Outcome::unknown:
                ++outcomes[f.what];
                if (prints) std::cout << "bead " << i << ": " << f.what << ", " << f.bead << '\n';
                continue;
            case Found::Outcome::other_events:
                ++outcomes["other events"];
                ADD_FAILURE() << "bead " << i << ", " << f.bead;
                continue;
            case Found::Outcome::good: ++outcomes["returned"]; break;
        }
        ratios[static_cast<int>(std::floor(-std::log10(f.asked)))].push_back(f.truth / f.told);
        worst_asked = std::max(worst_asked, f.truth / f.asked);
        above_asked += f.truth > f.asked;
        above_told += f.truth > f.told;
        EXPECT_LE(f.truth, f.asked) << "bead " << i << ", " << f.what << ", told " << f.told << ": " << f.bead;
        EXPECT_LE(f.truth, f.told) << "bead " << i << ", " << f.what << ", asked " << f.asked << ": " << f.bead;
    }
    EXPECT_GT(outcomes["returned"], count / 2);
    if (!prints) return;
    for (const auto& [what, n] : outcomes) std::cout << what << ": " << n << '\n';
    std::cout << "true above asked: " << above_asked << ", above told: " << above_told
              << ", largest true over asked: " << worst_asked << '\n';
    for (auto& [decade, all] : ratios) {
        std::sort(all.begin(), all.end());
        const auto at = [&all = all](double part) {
            return all[static_cast<std::size_t>(part * static_cast<double>(all.size() - 1))];
        };
        std::cout << "asked 1e-" << decade << " to 1e-" << decade + 1 << ", " << all.size()
                  << " runs, true over told: median " << at(0.5) << ", 0.9 " << at(0.9) << ", 0.99 " << at(0.99)
                  << ", largest " << at(1.0) << '\n';
    }
}

}  // namespace
}  // namespace rbdyn::test::test_beads
