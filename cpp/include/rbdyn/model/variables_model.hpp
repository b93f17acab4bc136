// A recorded model whose variables are the user's own: what is said of them where a motion breaks off.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/model/equations.hpp"
#include "rbdyn/model/recorded_model.hpp"

namespace rbdyn::inline RBDYN_FORM {

class VariablesModel : public RecordedModel {
public:
    std::string not_finite(const Mode& mode, double t, std::span<const double> x) const override;
    std::string rate_name(int variable) const override;
    /// The rate that changes fastest with a variable there, where that is without bounds or has grown beyond measure.
    std::string grown(const Mode& before, double t0, std::span<const double> x0, const Mode& mode, double t,
                      std::span<const double> x) const override;

    /// x' in a mode.
    virtual std::vector<double> rate(const Mode& mode, double t, std::span<const double> x) const;

protected:
    using RecordedModel::RecordedModel;

private:
    /// "x[2]", if nothing else is known of it.
    virtual std::string variable_name(int variable) const;
    /// A variable with its value, "x[0] = 0.5".
    std::string valued(int variable, double value) const;
    /// The largest derivative of a rate by a variable at a state: of which, by which; an infinite one is.
    struct Steepest {
        int rate = -1, variable = -1;
        double slope = 0.0;
    };
    Steepest steepest(const Mode& mode, double t, std::span<const double> x) const;
};

}  // namespace rbdyn::inline RBDYN_FORM
