// Models whose equations are recorded: one structure for each kind of mode and each side of every case distinction.
//
// A mode's equations are recorded at the state it begins in, which says on which side of every choice they are; where
// it says nothing (a choice that starts on its edge) the way the motion leaves the edge does. What an event did not
// change stays as it was, whatever rounding makes of it. Where the motion comes straight back to the surface of a
// distinction from both of its sides, it slides along it (sliding.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/model/hybrid.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What of the distinctions in equations is settled, whatever the state says.
struct Decisions {
    std::map<std::uint64_t, long> forced = {};  // choices, by id
    std::map<std::uint64_t, long> sides = {};   // +1 or -1, of the surfaces that were just left
    std::set<std::uint64_t> sliding = {};       // the surfaces that motion slides along
};

/// A state that equations are recorded for: it says which side of every choice they are on, but for those decided.
struct RecordedFor {
    double t = 0.0;
    std::span<const double> x;
    Decisions decided = {};
};

class RecordedModel : public HybridModel {
public:
    /// Whether any equations so far are those of one side of a case distinction.
    bool distinguishes() const;

    /// Finds the equations of a mode whose kind, choices and parameters are known, at a state. Returns whether there
    /// are such.
    [[gnu::cold]] bool restore(Mode& mode, double t, std::span<const double> x, const Decisions& decided) const;

protected:
    RecordedModel() = default;
    explicit RecordedModel(GivenNumbers given) : given_(std::move(given)) {}
    /// With what another one has recorded, for other numbers of the user's; `elsewhere`: and for another start.
    RecordedModel(const RecordedModel& other, GivenNumbers given, bool elsewhere = false);

    /// The numbers of the user's that it is for.
    const GivenNumbers& given() const { return given_; }

    /// What the equations depend on beside the choices: modes of one kind share them.
    virtual std::vector<signed char> kind_of(const Mode& mode) const = 0;
    /// The equations for a mode of a kind, at a state; none if it cannot slide as decided.
    virtual std::unique_ptr<Structure> record(const Mode& mode, const RecordedFor& state) const = 0;
    /// The same structure, recorded by a model that starts elsewhere, with what is this one's own; none if that is the
    /// same, too.
    virtual std::unique_ptr<Structure> adapted(const Structure& /*recorded*/) const { return nullptr; }
    /// Sets the parameters that are no signs of switches.
    virtual void own_parameters(Mode& /*mode*/, std::span<const double> /*x*/) const;

    /// A distinction switches whose guard fired: it is among `flipped`, a variable that it goes by is zero, exactly, if
    /// it is to be, and it happens, if it has a name and none of this name and surface has: of np.sign both sides of
    /// zero are watched, and pass it together.
    static void flip(const Mode& mode, int fired, bool is_zero, std::span<double> x, std::vector<int>& flipped,
                     std::vector<Happening>& happenings);

    /// Whether an event came to nothing: a surface left or met by rounding alone, and motion goes on as before. A
    /// length that passes zero has no sides, so its event always came to something.
    static bool same_motion(const Mode& a, const Mode& b, std::span<const int> flipped);

    /// The structure for a state, recorded anew only if no earlier one makes the same choices, and holds for the same
    /// numbers of the user's; none if there is none.
    const Structure* structure(const Mode& mode, double t, std::span<const double> x, const Decisions& decided) const;

    /// Takes what another one has recorded: the equations are the same.
    void share(const RecordedModel& other) { recordings_ = other.recordings_; }
    bool shares(const RecordedModel& other) const { return recordings_ == other.recordings_; }

    /// Completes a mode: its equations and their parameters. `flipped`: guards whose switch or choice changed; the
    /// others stay as they are, unless the state is a new one.
    void choose(Mode& mode, double t, std::span<const double> x, std::span<const int> flipped,
                bool is_new = false) const;

private:
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    /// What a mode comes from.
    struct Change {
        const Equations* before;
        std::vector<double> parameters;
        std::span<const int> flipped;
        bool is_new;
        std::map<std::uint64_t, int> passed;  // surfaces, and the side they were passed to, +1 or -1
    };

    /// The equations and parameters for what is decided. Returns whether there are any.
    bool complete(Mode& mode, double t, std::span<const double> x, const Change& change, Decisions& decided) const;

    /// Whether no guard of a mode asks for another one at once.
    static bool holds(const Mode& mode, double t, std::span<const double> x);

    /// The surface that a guard stands for, if motion may slide along it.
    static std::optional<std::uint64_t> surface_of(const Equations& e, const Guard& guard);

    /// The side of its surface that the switch or the choice of a guard is on after it fired, +1 or -1.
    static int side_after(const Equations& e, std::span<const double> parameters, const Guard& guard);

    /// Looks whether a mode goes on as decided: not along a surface that it is pulled off, not back to one of `passed`
    /// (none: of those it is on) that it came to from the other side. Returns whether that changed a decision.
    bool revise(const Mode& mode, double t, std::span<const double> x, const std::map<std::uint64_t, int>* passed,
                const std::set<std::uint64_t>& refused, Decisions& decided) const;

    void set_parameters(Mode& mode, double t, std::span<const double> x, const Change& change,
                        const Decisions& decided) const;

    using Key = std::pair<std::vector<signed char>, std::set<std::uint64_t>>;  // kind, and what it slides along
    struct Recordings {
        std::mutex mutex;
        std::map<Key, std::vector<std::unique_ptr<Structure>>> structures;
    };

    /// A structure of those recorded, as this model has it; the recordings are locked.
    const Structure* own(const Structure& recorded) const;

    GivenNumbers given_;
    std::shared_ptr<Recordings> recordings_ = std::make_shared<Recordings>();
    bool is_elsewhere_ = false;
    mutable std::map<const Structure*, std::unique_ptr<const Structure>> own_;  // those that are adapted, or none
};

}  // namespace rbdyn::inline RBDYN_FORM
