// Functions of time that solve linear equations themselves: sums of t^k exp(g t) (c cos(w t) + s sin(w t)).
//
// They are closed under sums and products, and each belongs to a few variables z with z' = C z + d: what forces a
// linear system by them makes a larger one that nothing forces. With C_k = t^k exp(g t) cos(w t) and S_k the like with
// sin,
//
//   C_k' = g C_k - w S_k + k C_(k-1),  S_k' = g S_k + w C_k + k S_(k-1)
#pragma once

#include <optional>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/closed_form/linear_system.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// t^power exp(growth t) (cosine cos(pace t) + sine sin(pace t)); pace not negative.
struct Wave {
    DoubleDouble growth = 0.0, pace = 0.0;  // [1/s]
    int power = 0;
    DoubleDouble cosine = 0.0, sine = 0.0;
};

class Waves {
public:
    Waves() = default;
    /// One that does not change.
    explicit Waves(const DoubleDouble& constant);
    /// Time itself.
    static Waves time();

    const std::vector<Wave>& all() const { return all_; }
    /// The value of one that does not change; none of one that does.
    std::optional<DoubleDouble> constant() const;

    void add(const Waves& other, const DoubleDouble& factor);
    /// None where powers or numbers of waves grow beyond what anyone writes.
    static std::optional<Waves> product(const Waves& a, const Waves& b);
    /// sin, cos and exp of a line in time; none of anything else.
    static std::optional<Waves> sine(const Waves& line);
    static std::optional<Waves> cosine(const Waves& line);
    static std::optional<Waves> exponential(const Waves& line);

private:
    static constexpr int most_waves = 32, most_power = 8;
    struct Line {
        DoubleDouble rate, start;
    };
    std::optional<Line> line() const;
    void add(Wave wave);

    std::vector<Wave> all_;
};

/// What forces the variables of a linear system, each by its waves: the same system with the variables of the waves
/// behind its own. Their values at the start are those of a time.
class ForcedSystem {
public:
    ForcedSystem(LinearSystem system, const std::vector<Waves>& forcing);

    /// How many variables there are without those of the waves.
    int own() const { return own_; }
    int size() const { return system_.size(); }
    /// With the start at a time [s].
    LinearSystem begun(const DoubleDouble& time) const;

private:
    LinearSystem system_;
    int own_;
    std::vector<Wave> behind_;  // what each further variable is
};

}  // namespace rbdyn::inline RBDYN_FORM
