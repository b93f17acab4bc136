// A function of the user's: recorded, or called back where it cannot be.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/callback.hpp"
#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/numbers.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

class OwnFunction {
public:
    OwnFunction() = default;
    OwnFunction(Function function, std::string name);
    explicit OwnFunction(std::shared_ptr<const Callback> callback);

    /// Whether there is one.
    explicit operator bool() const { return function_ || callback_; }
    const Function& function() const { return function_; }
    const std::shared_ptr<const Callback>& callback() const { return callback_; }
    const std::string& name() const { return name_; }
    int inputs() const { return function_ ? function_.inputs() : callback_ ? callback_->inputs : 0; }
    int outputs() const { return function_ ? function_.outputs() : callback_ ? callback_->outputs : 0; }
    /// Nobody knows what one that is called back depends on.
    bool may_depend_on(int input) const { return callback_ || (function_ && function_.depends_on(input)); }
    /// Whether it is zero whatever its inputs are, with the numbers of the user's as they are now.
    bool is_zero() const;
    /// With the numbers of the user's as they are now.
    OwnFunction frozen() const;
    void give(GivenNumbers& numbers) const;

    template <class S>
    std::vector<S> operator()(std::span<const S> x) const {
        if (function_) return function_(x);
        if constexpr (std::is_same_v<S, Expression>) {
            std::vector<double> in;
            for (const Expression& e : x) {
                if (!e.is_constant()) return e.recorder()->call(callback_, x);
                in.push_back(e.value());
            }
            // of what does not change
            const std::vector<double> out = called(in);
            return {out.begin(), out.end()};
        } else {
            std::vector<double> in;
            for (const S& e : x) in.push_back(static_cast<double>(e));
            const std::vector<double> out = called(in);
            return {out.begin(), out.end()};
        }
    }

    bool operator==(const OwnFunction& other) const;

private:
    std::vector<double> called(const std::vector<double>& x) const;

    Function function_;
    std::shared_ptr<const Callback> callback_;
    std::string name_;
};

}  // namespace rbdyn::inline RBDYN_FORM
