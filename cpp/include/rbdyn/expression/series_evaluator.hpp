// Runs a program in truncated Taylor series, order by order (see series/coefficients.hpp).
//
// Time is measured in units of `unit` seconds from the start of the series, so that coefficients stay near the size
// of what they describe however fast or slow the motion is; powers of two leave every digit unchanged.
#pragma once

#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "rbdyn/expression/program.hpp"
#include "rbdyn/series/coefficients.hpp"

namespace rbdyn {

class SeriesEvaluator {
public:
    /// Room for series of orders 0 .. max_order.
    SeriesEvaluator(const Program& program, int max_order)
        : program_(&program),
          top_(max_order),
          stride_(2 * (max_order + 1)),
          storage_(static_cast<std::size_t>(program.slots() * stride_), 0.0),
          valuations_(static_cast<std::size_t>(program.states()), -1) {}

    const Program& program() const { return *program_; }

    void set_parameters(std::span<const double> parameters) { program_->set_parameters(parameters, scalars_); }

    /// Starts at time t with a unit of time; state coefficients are given with set_input().
    void begin(double t, double unit) {
        for (int& m : valuations_) m = -1;
        if (program_->uses_time()) {
            const series::View time = slot(program_->time_slot());
            time.set(0, t);
            if (top_ >= 1) time.set(1, unit);
            for (int k = 2; k <= top_; ++k) time.set(k, 0.0);
        }
    }

    void set_input(int variable, int order, double value) { slot(variable).set(order, value); }

    /// Computes coefficient k of every slot from coefficients 0..k of the inputs.
    void advance(int k) {
        const double* w = scalars_.data();
        for (const Instruction& i : program_->instructions()) {
            const series::View out = slot(i.out);
            switch (i.code) {
                case Code::combine: {
                    double sum = k == 0 && i.weight >= 0 ? w[i.weight] : 0.0;
                    const Term* term = program_->terms(i);
                    for (int j = 0; j < i.terms; ++j) sum += w[term[j].weight] * slot(term[j].slot)[k];
                    const ProductTerm* product = program_->products(i);
                    for (int j = 0; j < i.products; ++j) {
                        const auto [a, b, weight] = product[j];
                        sum += w[weight] * (a == b ? series::square(slot(a), k) : series::product(slot(a), slot(b), k));
                    }
                    out.set(k, sum);
                    break;
                }
                case Code::divide: out.set(k, series::quotient(slot(i.a), slot(i.b), out, k)); break;
                case Code::square_root: {
                    const double a_k = slot(i.a)[k];
                    out.set(k, k == 0 ? std::sqrt(a_k) : series::square_root(a_k, out, k));
                    break;
                }
                case Code::norm: norm(i, out, k); break;
                case Code::sine_cosine: {
                    const series::View a = slot(i.a), cosine = slot(i.out2);
                    if (k == 0) {
                        out.set(0, std::sin(a[0]));
                        cosine.set(0, std::cos(a[0]));
                        break;
                    }
                    double* slope = slot(i.extra).forward;
                    slope[k] = k * a[k];
                    const double s_k = series::integral_of_slope(slope, cosine, k);
                    cosine.set(k, -series::integral_of_slope(slope, out, k));
                    out.set(k, s_k);
                    break;
                }
                case Code::exponential: {
                    const series::View a = slot(i.a);
                    double* slope = slot(i.extra).forward;
                    slope[k] = k * a[k];
                    out.set(k, k == 0 ? std::exp(a[0]) : series::integral_of_slope(slope, out, k));
                    break;
                }
                case Code::logarithm: {
                    // a l' = a'
                    const series::View a = slot(i.a);
                    double* slope = slot(i.extra).forward;
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
                    const series::View a = slot(i.a);
                    double* slope = slot(i.extra).forward;
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
    series::View slot(int index) {
        double* start = storage_.data() + static_cast<std::ptrdiff_t>(index) * stride_;
        return {start, start + top_ + 1, top_};
    }

    /// |v| for v = t^m d(t), d(0) not zero: t^m |d(t)|, so that a motion may start from v = 0.
    void norm(const Instruction& i, const series::View& out, int k) {
        int& m = valuations_[static_cast<std::size_t>(i.extra)];
        const series::View part[3] = {slot(i.a), slot(i.b), slot(i.c)};
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

    const Program* program_;
    int top_, stride_;
    std::vector<double> storage_;
    std::vector<double> scalars_;
    std::vector<int> valuations_;
};

}  // namespace rbdyn
