// Runs a program in truncated Taylor series, order by order (see series/coefficients.hpp).
//
// Time is measured in units of `unit` seconds from the start of the series, so that coefficients stay near the size
// of what they describe however fast or slow the motion is; powers of two leave every digit unchanged.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "rbdyn/expression/program.hpp"
#include "rbdyn/series/coefficients.hpp"
#include "rbdyn/series/packed_products.hpp"

namespace rbdyn {

class SeriesEvaluator {
public:
    /// Room for series of orders 0 .. max_order. Throws Error above series::most_packed.
    SeriesEvaluator(const Program& program, int max_order)
        : program_(&program),
          top_(max_order),
          stride_(2 * (max_order + 1)),
          storage_(static_cast<std::size_t>(program.slots() * stride_), 0.0),
          valuations_(static_cast<std::size_t>(program.states()), -1) {
        if (max_order > series::most_packed) throw Error("SeriesEvaluator: there is no code for series of this order");
        resolve();
    }
    SeriesEvaluator(const SeriesEvaluator&) = delete;
    SeriesEvaluator& operator=(const SeriesEvaluator&) = delete;

    const Program& program() const { return *program_; }
    /// Doubles from one slot's coefficients to the next one's.
    int stride() const { return stride_; }

    void set_parameters(std::span<const double> parameters, Program::Rounding rounding = Program::Rounding::nearest) {
        program_->set_parameters(parameters, scalars_, rounding);
        for (std::size_t i = 0; i < packed_.size(); ++i) {
            const auto& [first, second] = lane_weights_[i];
            packed_[i].weight = series::Pair{first.factor * scalars_[static_cast<std::size_t>(first.scalar)],
                                             second.factor * scalars_[static_cast<std::size_t>(second.scalar)]};
        }
    }

    /// Starts at time t with a unit of time; state coefficients are given with set_input().
    void begin(double t, double unit) {
        unit_ = unit;
        for (int& m : valuations_) m = -1;
        if (program_->uses_time()) {
            const series::View time = slot(program_->time_slot());
            time.set(0, t);
            if (top_ >= 1) time.set(1, unit);
            for (int k = 2; k <= top_; ++k) time.set(k, 0.0);
        }
    }

    void set_input(int variable, int order, double value) { slot(variable).set(order, value); }

    /// Gives the inputs their coefficient k + 1 if output i is the derivative of input i; false if a derivative is not
    /// finite.
    bool integrate(int k) {
        const double factor = unit_ / (k + 1);
        double check = 0.0;
        for (const auto& [input, rate] : motion_) {
            check += 0.0 * rate[k];
            input.set(k + 1, rate[k] * factor);
        }
        return check == 0.0;
    }

    /// Computes coefficient k of every slot from coefficients 0..k of the inputs.
    void advance(int k) {
        const double* w = scalars_.data();
        const series::PackedSum packed_sum = series::packed_sums[static_cast<std::size_t>(k)];
        for (const Step& i : steps_) {
            const series::View& out = i.out;
            switch (i.code) {
                case Code::combine: {
                    double sum = k == 0 && i.weight >= 0 ? w[i.weight] : 0.0;
                    for (const ResolvedTerm *t = i.terms, *end = t + i.term_count; t != end; ++t)
                        sum += w[t->weight] * t->series[k];
                    if (i.packed != i.packed_end)
                        sum = k > 0 ? packed_sum(sum, i.packed, i.packed_end) : sum + products(i);
                    out.set(k, sum);
                    break;
                }
                case Code::divide: out.set(k, series::quotient(i.a, i.b, out, k)); break;
                case Code::square_root: {
                    const double a_k = i.a[k];
                    out.set(k, k == 0 ? std::sqrt(a_k) : series::square_root(a_k, out, k));
                    break;
                }
                case Code::norm: norm(i, out, k); break;
                case Code::sine_cosine: {
                    const series::View &a = i.a, &cosine = i.out2;
                    if (k == 0) {
                        out.set(0, std::sin(a[0]));
                        cosine.set(0, std::cos(a[0]));
                        break;
                    }
                    double* slope = i.slope;
                    slope[k] = k * a[k];
                    const double s_k = series::integral_of_slope(slope, cosine, k);
                    cosine.set(k, -series::integral_of_slope(slope, out, k));
                    out.set(k, s_k);
                    break;
                }
                case Code::hyperbolic: {
                    const series::View &a = i.a, &cosine = i.out2;
                    double* slope = i.slope;
                    slope[k] = k * a[k];
                    if (k == 0) {
                        out.set(0, std::sinh(a[0]));
                        cosine.set(0, std::cosh(a[0]));
                        break;
                    }
                    const double s_k = series::integral_of_slope(slope, cosine, k);
                    cosine.set(k, series::integral_of_slope(slope, out, k));
                    out.set(k, s_k);
                    break;
                }
                case Code::tangent: {
                    // t' = (1 - t^2) a'
                    const series::View &a = i.a, &rest = i.out2;
                    double* slope = i.slope;
                    slope[k] = k * a[k];
                    if (k == 0) {
                        const double t = std::tanh(a[0]), c = std::cosh(a[0]);
                        out.set(0, t);
                        rest.set(0, 1.0 / (c * c));
                        break;
                    }
                    out.set(k, series::integral_of_slope(slope, rest, k));
                    rest.set(k, -series::square(out, k));
                    break;
                }
                case Code::angle: {
                    // (x^2 + y^2) p' = x y' - y x'
                    const series::View &y = i.a, &x = i.b, &square = i.c;
                    double* slope = i.slope;
                    if (k == 0) {
                        out.set(0, std::atan2(y[0], x[0]));
                        break;
                    }
                    double turn = 0.0;
                    for (int j = 1; j <= k; ++j) turn += j * (y[j] * x[k - j] - x[j] * y[k - j]);
                    const double sum = series::dot(slope + 1, square.from(k - 1), k - 1);
                    slope[k] = (turn - sum) / square[0];
                    out.set(k, slope[k] / k);
                    break;
                }
                case Code::call: call(*i.call, k); break;
                case Code::exponential: {
                    const series::View& a = i.a;
                    double* slope = i.slope;
                    slope[k] = k * a[k];
                    out.set(k, k == 0 ? std::exp(a[0]) : series::integral_of_slope(slope, out, k));
                    break;
                }
                case Code::logarithm: {
                    // a l' = a'
                    const series::View& a = i.a;
                    double* slope = i.slope;
                    if (k == 0) {
                        out.set(0, std::log(a[0]));
                        break;
                    }
                    const double sum = series::dot(slope + 1, a.from(k - 1), k - 1);
                    out.set(k, (a[k] - sum / k) / a[0]);
                    slope[k] = k * out[k];
                    break;
                }
                case Code::power: {
                    // a p' = r a' p
                    const series::View& a = i.a;
                    double* slope = i.slope;
                    slope[k] = k * a[k];
                    if (k == 0) {
                        out.set(0, std::pow(a[0], i.value));
                        break;
                    }
                    const double weighted = series::dot(slope + 1, out.from(k - 1), k) / k;
                    const double plain = series::dot(a.forward + 1, out.from(k - 1), k);
                    out.set(k, ((i.value + 1.0) * weighted - plain) / a[0]);
                    break;
                }
            }
        }
    }

    /// Coefficients of an output, of a switch, of any slot.
    const double* output(int index) const { return coefficients(program_->output(index)); }
    const double* switch_value(int index) const { return coefficients(program_->switch_output(index)); }
    const double* coefficients(int slot_index) const {
        return storage_.data() + static_cast<std::ptrdiff_t>(slot_index) * stride_;
    }

private:
    // instructions with their series found once
    struct ResolvedTerm {
        const double* series;
        int weight;
    };
    // a lane of a packed product: factor times a scalar
    struct LaneWeight {
        int scalar;
        double factor;
    };
    struct Motion {
        series::View input;
        const double* rate;
    };
    struct Step {
        Code code;
        int weight;
        series::View out, out2, a, b, c;
        double* slope;
        int* valuation;
        double value;
        const ResolvedTerm* terms;
        series::PackedProduct *packed, *packed_end;
        int term_count;
        const Instruction* source;
        const Program::Call* call;
    };

    series::View slot(int index) {
        double* start = storage_.data() + static_cast<std::ptrdiff_t>(index) * stride_;
        return {start, start + top_ + 1, top_};
    }

    /// Coefficient 0 of the products of a combination.
    double products(const Step& i) {
        double sum = 0.0;
        const ProductTerm* p = program_->products(*i.source);
        for (const ProductTerm* end = p + i.source->products; p != end; ++p)
            sum += scalars_[static_cast<std::size_t>(p->weight)] * (coefficients(p->a)[0] * coefficients(p->b)[0]);
        for (series::PackedProduct* q = i.packed; q != i.packed_end; ++q) q->take(0);
        return sum;
    }

    /// A function of the user's has a value and no more.
    void call(const Program::Call& c, int k) {
        std::vector<double> x, y(c.results.size(), std::numeric_limits<double>::quiet_NaN());
        if (k == 0) {
            for (const int argument : c.arguments) x.push_back(slot(argument)[0]);
            (*c.function)(x.data(), y.data());
        }
        for (std::size_t i = 0; i < y.size(); ++i) slot(c.results[i]).set(k, y[i]);
    }

    /// |v| for v = t^m d(t), d(0) not zero: t^m |d(t)|, so that a motion may start from v = 0.
    void norm(const Step& i, const series::View& out, int k) {
        int& m = *i.valuation;
        const series::View part[3] = {i.a, i.b, i.c};
        if (m < 0) {
            const bool ignored = k == 0 && i.weight >= 0 && scalars_[static_cast<std::size_t>(i.weight)] != 0.0;
            const double x = part[0][k], y = part[1][k], z = part[2][k];
            if (ignored || (x == 0.0 && y == 0.0 && z == 0.0)) {
                out.set(k, 0.0);
            } else {
                m = k;
                out.set(k, std::sqrt(x * x + y * y + z * z));
            }
            return;
        }
        const int j = k - m;
        double square = 0.0;
        for (const series::View& v : part) square += series::dot(v.forward + m, v.from(k), j + 1);
        const double inner = series::dot(out.forward + m + 1, out.from(k - 1), j - 1);
        out.set(k, (square - inner) / (2.0 * out[m]));
    }

    void resolve() {
        const auto view = [&](int index) { return index >= 0 ? slot(index) : series::View{nullptr, nullptr, 0}; };
        std::size_t terms = 0, products = 0;
        for (const Instruction& i : program_->instructions()) {
            terms += static_cast<std::size_t>(i.terms);
            products += static_cast<std::size_t>(i.products);
        }
        terms_.reserve(terms);
        packed_.reserve(products);
        lanes_.resize(products * lanes_each());
        for (const Instruction& i : program_->instructions()) {
            Step s{i.code,
                   i.weight,
                   view(i.out),
                   view(i.out2),
                   view(i.a),
                   view(i.b),
                   view(i.c),
                   nullptr,
                   nullptr,
                   i.value,
                   terms_.data() + terms_.size(),
                   packed_.data() + packed_.size(),
                   nullptr,
                   i.terms,
                   &i,
                   i.code == Code::call ? &program_->calls()[static_cast<std::size_t>(i.extra)] : nullptr};
            if (i.code == Code::norm)
                s.valuation = &valuations_[static_cast<std::size_t>(i.extra)];
            else if (i.extra >= 0 && i.code != Code::call)
                s.slope = slot(i.extra).forward;
            for (int j = 0; j < i.terms; ++j) {
                const Term& t = program_->terms(i)[j];
                terms_.push_back({slot(t.slot).forward, t.weight});
            }
            pack(program_->products(i), program_->products(i) + i.products);
            s.packed_end = packed_.data() + packed_.size();
            steps_.push_back(s);
        }
        for (int i = 0; i < std::min(program_->inputs(), program_->outputs()); ++i)
            motion_.push_back({slot(i), output(i)});
    }

    std::size_t lanes_each() const { return static_cast<std::size_t>(top_ / 2 + 1 + top_ + 1); }

    /// Packs the products of a combination; a square without another one has a lane of zeros beside it.
    void pack(const ProductTerm* first, const ProductTerm* last) {
        const ProductTerm* square = nullptr;  // waits for another one
        for (const ProductTerm* p = first; p != last; ++p) {
            if (p->a != p->b) {
                pack({p->a, p->b}, {p->b, p->a}, {{{p->weight, 1.0}, {p->weight, 1.0}}});
            } else if (square == nullptr) {
                square = p;
            } else {
                pack({square->a, p->a}, {square->a, p->a}, {{{square->weight, 2.0}, {p->weight, 2.0}}});
                square = nullptr;
            }
        }
        if (square)
            pack({square->a, square->a}, {square->a, square->a}, {{{square->weight, 2.0}, {square->weight, 0.0}}});
    }

    void pack(std::array<int, 2> x, std::array<int, 2> y, const std::array<LaneWeight, 2>& weights) {
        series::Pair* low = lanes_.data() + packed_.size() * lanes_each();
        packed_.push_back({{coefficients(x[0]), coefficients(x[1])},
                           {coefficients(y[0]), coefficients(y[1])},
                           series::Pair{},
                           low,
                           low + top_ / 2 + 1,
                           top_ / 2});
        lane_weights_.push_back(weights);
    }

    const Program* program_;
    int top_, stride_;
    double unit_ = 1.0;
    std::vector<double> storage_;
    std::vector<double> scalars_;
    std::vector<int> valuations_;
    std::vector<Step> steps_;
    std::vector<Motion> motion_;
    std::vector<ResolvedTerm> terms_;
    std::vector<series::PackedProduct> packed_;
    std::vector<std::array<LaneWeight, 2>> lane_weights_;
    std::vector<series::Pair> lanes_;
};

}  // namespace rbdyn
