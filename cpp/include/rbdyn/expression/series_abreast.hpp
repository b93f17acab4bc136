// Runs a program in truncated Taylor series for several motions abreast, each with its own numbers, time and unit.
//
// A motion's coefficients are those that SeriesEvaluator gives it, bit for bit. Rare motions are not taken so far:
// those with a norm that begins at zero, or with coefficients that are not finite (is_good()).
//
// There is code for processors with vectors of eight doubles (AVX-512), of four (AVX2), and for all others; which is
// chosen when it is made. After some expansions machine code of the program takes its place where the library makes
// any (abreast_code.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"

namespace rbdyn::inline RBDYN_FORM {

namespace abreast {
struct Tape;        // abreast_tape.hpp
class AbreastCode;  // abreast_code.hpp
}  // namespace abreast

class SeriesAbreast {
public:
    enum class Processor { any, four, eight };
    /// The widest of this one; none where nothing goes abreast.
    static Processor widest();
    /// Those that this one can do.
    static std::vector<Processor> processors();
    /// Whether there is anything for a program: what is called back has no series.
    static bool takes(const Program& program);

    static constexpr int most = 8;  // motions

    SeriesAbreast(const Program& program, int order, Processor processor = widest());
    ~SeriesAbreast();
    SeriesAbreast(const SeriesAbreast&) = delete;
    SeriesAbreast& operator=(const SeriesAbreast&) = delete;

    /// How many motions go abreast.
    int width() const { return width_; }
    /// Whether a program is computed by the same instructions; the numbers in it may be others.
    bool fits(const Program& program, int order) const;

    struct Motion {
        double t, unit;
        std::span<const double> state;
        std::span<const double> weights;  // SeriesEvaluator::weights()
    };
    /// Coefficients 0 .. order of the inputs of width() motions at most, 0 .. order - 1 of the other slots; `whole`: 0
    /// .. order of these too.
    void expand(std::span<const Motion> motions, bool whole);
    /// Whether the motion's coefficients are what it has alone.
    bool is_good(int motion) const;
    /// Hands a motion's to its evaluator: of rates what is_finite() looks at, and some slots.
    void give(int motion, SeriesEvaluator& series, std::span<const int> slots, bool whole) const;
    /// Those of all slots.
    void give_all(int motion, SeriesEvaluator& series, bool whole) const;

    /// The sizes of `count` inputs of a motion together (series::sizes()), from `first` on: those of all motions are
    /// computed when the first one asks.
    void sizes(int motion, int first, int count, double* out) const;

    /// Hands over the coefficients of all inputs, each motion's to its evaluator.
    void give_states(std::span<SeriesEvaluator* const> series) const;
    /// How long steps may be by these sizes, of all motions: series::log_step() of each motion's.
    void find_log_steps(int first, int count, std::span<const double> scales,
                        std::span<const double> log_tolerances) const;
    /// What was found of a motion; none where log_step() is to be asked.
    std::optional<double> log_step(int motion, int first, int count) const;

    /// What the inputs add up to from coefficient 1 on, of all motions, each at a place of its own.
    void find_increments(std::span<const double> places) const;
    double increment(int motion, int input) const;

    /// From now on by machine code at once, or not at all; else from when it pays. The same bits.
    void use_machine_code(bool is_used);
    bool has_machine_code() const { return code_ != nullptr; }

    /// Bytes that an expansion goes through again and again.
    std::size_t bytes() const;

private:
    /// The place of the sizes of these inputs among those of the tape.
    std::size_t sizes_of(int first, int count) const;
    void copy(int motion, int slot, std::size_t count, SeriesEvaluator& series) const;
    /// What is one or minus one in the program is so in all motions.
    bool has_its_ones(std::span<const double> weights) const;
    /// The machine code, made if it is time to.
    const abreast::AbreastCode* code();

    int order_, width_, stride_, inputs_, slots_;
    bool may_overflow_;
    std::vector<Instruction> instructions_;
    std::vector<Term> terms_;
    std::vector<ProductTerm> products_;
    std::unique_ptr<abreast::Tape> tape_;
    std::unique_ptr<const abreast::AbreastCode> code_;
    int expansions_ = 0;  // so far, until there is code
};

}  // namespace rbdyn::inline RBDYN_FORM
