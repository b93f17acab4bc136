// The equations of a System as a hybrid model: one structure for each side of every case distinction, and what is
// watched for.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/own_function.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/equations_writer.hpp"
#include "rbdyn/model/hybrid.hpp"
#include "rbdyn/model/variables_model.hpp"
#include "rbdyn/system/system.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// What a function of a System gives at a moment.
std::vector<double> value_of(const OwnFunction& f, double t, std::span<const double> x);

class SystemModel : public VariablesModel {
public:
    /// Of a system that is frozen.
    explicit SystemModel(System system);

    const System& system() const { return system_; }
    int variables() const override { return system_.variables(); }

    Mode begin(double t, std::span<double> x) const override;
    Mode next(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
              std::vector<Happening>& happenings) const override;
    void observe(const Mode& mode, double t, std::span<const double> x, std::vector<Observed>& observed) const override;
    double guard_value(const Guard& guard, const Mode& mode, double t, std::span<const double> x) const override;
    std::vector<double> rate(const Mode& mode, double t, std::span<const double> x) const override;

private:
    // none of the variables is followed to digits of its own far below the largest of them: what only reaches it
    // through many others grows from nothing
    static constexpr Alike whole = Alike::place;

    std::vector<signed char> kind_of(const Mode&) const override { return {}; }
    std::unique_ptr<Structure> record(const Mode& mode, const RecordedFor& state) const override;

    std::string variable_name(int variable) const override;

    void change(const System::Watch& watch, double t, std::span<double> x) const;

    System system_;
};

}  // namespace rbdyn::inline RBDYN_FORM
