// How a scene is priced: runs that keep to a budget, what they are held against, and who has which turn.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/cost.hpp"
#include "rbdyn/event/course.hpp"
#include "rbdyn/event/record.hpp"
#include "rbdyn/integrate.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/options.hpp"
#include "rbdyn/price.hpp"

namespace rbdyn::inline RBDYN_FORM::pricing {

/// The time there is, by the clock.
class Purse {
public:
    Purse(double budget, Monitor monitor) : budget_(budget), monitor_(std::move(monitor)) {}

    double budget() const { return budget_; }
    double spent() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }
    double left() const { return budget_ - spent(); }
    /// By whoever watches.
    bool is_closed() const { return is_closed_; }
    /// Asks whoever watches whether to go on.
    bool goes_on();

private:
    using Clock = std::chrono::steady_clock;
    double budget_;
    Monitor monitor_;
    Clock::time_point began_ = Clock::now();
    bool is_closed_ = false;
};

/// Bodies that something joins, by themselves, or a system of equations.
struct Part {
    const HybridModel& model;
    std::vector<double> start;                           // state
    std::shared_ptr<const ClosedForm> closed = nullptr;  // its motion, if there is one
    bool calls_back = false;
    /// The engine that one of a name is for it; throws InvalidInput where that cannot do it.
    std::function<std::string(const std::string&)> engine_for;
    /// Its closed form, set up anew.
    std::function<std::shared_ptr<const ClosedForm>()> close = {};
};

/// simulate() of all parts.
struct Whole {
    /// Whether it comes to what it is asked for.
    std::function<bool(const SimulateOptions&)> reaches;
    /// Throws what simulate() throws.
    std::function<void(const SimulateOptions&)> require;
};

/// What came of all parts once.
struct Measured {
    std::vector<Record> records;                     // one a part; none of a closed form
    double seconds = 0.0;                            // processor time of the integrations
    double spent = 0.0;                              // by the clock
    std::optional<double> projected = std::nullopt;  // s; it was given up, and would have taken that: no records
    std::string broken = {};                         // why the motion broke off
    bool is_too_large = false;                       // to be kept whole
};

/// One integration of each part, none of them longer than `allowed` [s] together.
class Runner {
public:
    Runner(const std::vector<Part>& parts, const SimulateOptions& base, Purse& purse);

    /// By the engines of the parts; "closed form" sets it up and asks for one state, and for the events.
    /// `keep`: all, or what is compared. `is_auto`: series leave to BDF what is stiff.
    Measured run(const std::vector<std::string>& engines, double tolerance, double allowed, Keep::What keep,
                 bool is_auto = false);
    /// One that others are held against: closed forms have pieces of motion, and steps that come near to a loss of rank
    /// go on.
    Measured run_reference(const std::vector<std::string>& engines, double tolerance, double allowed,
                           const simulating::Manner& manner);
    /// simulate() of the whole scene with this error, in processor time; none if it does not reach it or not in time.
    std::optional<double> whole(const Whole& whole, const std::string& engine, double error, double allowed,
                                Keep::What keep);

    const std::vector<Part>& parts() const { return parts_; }
    const SimulateOptions& options() const { return base_; }
    /// Where runs are compared.
    const Keep& compared() const { return compared_; }
    /// Has a look at the motion, so that its short and quick phases are compared, too.
    void look(double allowed);
    /// The end of the motion is an event of one of the parts.
    void end_at(double until);

private:
    /// Integrates one part after the other, each by `integrated`, which leaves its record behind.
    template <class Integrated>
    Measured measured(double allowed, SimulateOptions& options, const Integrated& integrated);

    const std::vector<Part>& parts_;
    SimulateOptions base_;
    Keep compared_;
    Purse& purse_;
};

/// What errors are measured against.
class Reference {
public:
    /// Runs it if something is to be held against it. Throws what simulate() throws if the motion does not go to its
    /// end.
    Reference(Runner& runner, const Whole& whole, Purse& purse, bool is_wanted);

    /// Whether there is one at all.
    bool is_any() const { return !first_.records.empty(); }
    /// Whether it tells the errors of an engine at a tolerance, which it is tighter than.
    bool reaches(const std::string& engine, double tolerance) const;
    /// Sets the errors, events and steps of a row, from a run by these engines of the parts. `about`: its error, as far
    /// as that is known.
    void judge(const Measured& run, const std::vector<std::string>& engines, double about, CostRow& row) const;
    /// What it is, and how near the best row of another engine comes to it.
    std::string said(const Price& price) const;

private:
    Runner& runner_;
    Measured first_, second_;                   // the second: for rows of the engine of the first
    std::string first_engine_, second_engine_;  // none in long double
    double first_tolerance_ = 0.0, second_tolerance_ = 0.0;
    bool is_extended_ = false;
    std::vector<bool> is_closed_;  // by part
};

/// What rounding makes of a motion in closed form.
double rounding_of(const Part& part, const SimulateOptions& base);

/// The list of what has these parts. `natural`: the engine that simulate() takes by itself.
Price priced(const std::vector<Part>& parts, const std::string& natural, const Whole& whole, const CostOptions& options,
             Purse& purse);

}  // namespace rbdyn::inline RBDYN_FORM::pricing
