// Definitions of rbdyn/closed_form/waves.hpp.
#pragma once

#include "rbdyn/closed_form/waves.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "rbdyn/basics/double_double.hpp"
#include "rbdyn/basics/double_double_functions.hpp"
#include "rbdyn/closed_form/linear_system.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Waves::Waves(const DoubleDouble& constant) { add(Wave{.cosine = constant}); }

RBDYN_INLINE Waves Waves::time() {
    Waves t;
    t.add(Wave{.power = 1, .cosine = 1.0});
    return t;
}

RBDYN_INLINE std::optional<DoubleDouble> Waves::constant() const {
    if (all_.empty()) return DoubleDouble(0.0);
    const Wave& w = all_.front();
    const bool stays = all_.size() == 1 && w.growth.hi == 0.0 && w.pace.hi == 0.0 && w.power == 0;
    return stays ? std::optional(w.cosine) : std::nullopt;
}

RBDYN_INLINE void Waves::add(Wave wave) {
    if (wave.pace.hi < 0.0) {
        wave.pace = -wave.pace;
        wave.sine = -wave.sine;
    }
    if (wave.pace.hi == 0.0) wave.sine = 0.0;
    if (wave.cosine.hi == 0.0 && wave.sine.hi == 0.0) return;
    const auto known = std::find_if(all_.begin(), all_.end(), [&](const Wave& w) {
        return w.growth == wave.growth && w.pace == wave.pace && w.power == wave.power;
    });
    if (known == all_.end()) {
        all_.push_back(wave);
        return;
    }
    known->cosine += wave.cosine;
    known->sine += wave.sine;
    if (known->cosine.hi == 0.0 && known->sine.hi == 0.0) all_.erase(known);
}

RBDYN_INLINE void Waves::add(const Waves& other, const DoubleDouble& factor) {
    for (Wave w : other.all_) {
        w.cosine *= factor;
        w.sine *= factor;
        add(w);
    }
}

RBDYN_INLINE std::optional<Waves> Waves::product(const Waves& a, const Waves& b) {
    Waves result;
    for (const Wave& x : a.all_)
        for (const Wave& y : b.all_) {
            Wave sum{.growth = x.growth + y.growth, .pace = x.pace + y.pace, .power = x.power + y.power};
            if (sum.power > most_power) return std::nullopt;
            Wave difference = sum;
            difference.pace = x.pace - y.pace;
            sum.cosine = 0.5 * (x.cosine * y.cosine - x.sine * y.sine);
            sum.sine = 0.5 * (x.sine * y.cosine + x.cosine * y.sine);
            difference.cosine = 0.5 * (x.cosine * y.cosine + x.sine * y.sine);
            difference.sine = 0.5 * (x.sine * y.cosine - x.cosine * y.sine);
            result.add(sum);
            result.add(difference);
            if (result.all_.size() > most_waves) return std::nullopt;
        }
    return result;
}

RBDYN_INLINE std::optional<Waves::Line> Waves::line() const {
    Line result{0.0, 0.0};
    for (const Wave& w : all_) {
        if (w.growth.hi != 0.0 || w.pace.hi != 0.0 || w.power > 1) return std::nullopt;
        (w.power == 1 ? result.rate : result.start) = w.cosine;
    }
    return result;
}

RBDYN_INLINE std::optional<Waves> Waves::sine(const Waves& line) {
    const std::optional<Line> l = line.line();
    if (!l) return std::nullopt;
    // sin(w t + p) = sin p cos(w t) + cos p sin(w t)
    const auto [s, c] = sine_cosine(l->start);
    Waves result;
    result.add(Wave{.pace = l->rate, .cosine = s, .sine = c});
    return result;
}

RBDYN_INLINE std::optional<Waves> Waves::cosine(const Waves& line) {
    const std::optional<Line> l = line.line();
    if (!l) return std::nullopt;
    const auto [s, c] = sine_cosine(l->start);
    Waves result;
    result.add(Wave{.pace = l->rate, .cosine = c, .sine = -s});
    return result;
}

RBDYN_INLINE std::optional<Waves> Waves::exponential(const Waves& line) {
    const std::optional<Line> l = line.line();
    if (!l) return std::nullopt;
    Waves result;
    result.add(Wave{.growth = l->rate, .cosine = exp(l->start)});
    return result;
}

RBDYN_INLINE ForcedSystem::ForcedSystem(LinearSystem system, const std::vector<Waves>& forcing)
    : system_(std::move(system)), own_(system_.size()) {
    // where the variable of a wave is; that of t^0 is 1 itself, -1
    const auto place = [&](const Wave& wanted, int power, bool is_sine) {
        if (wanted.growth.hi == 0.0 && wanted.pace.hi == 0.0 && power == 0) return -1;
        for (std::size_t i = 0; i < behind_.size(); ++i) {
            const Wave& w = behind_[i];
            if (w.growth == wanted.growth && w.pace == wanted.pace && w.power == power && (w.sine.hi != 0.0) == is_sine)
                return own_ + static_cast<int>(i);
        }
        behind_.push_back({wanted.growth, wanted.pace, power, is_sine ? 0.0 : 1.0, is_sine ? 1.0 : 0.0});
        return own_ + static_cast<int>(behind_.size()) - 1;
    };
    // those that one depends on come with it
    for (const Waves& waves : forcing)
        for (const Wave& w : waves.all())
            for (int power = w.power; power >= 0; --power) {
                place(w, power, false);
                if (w.pace.hi != 0.0) place(w, power, true);
            }
    system_.rows.resize(system_.rows.size() + behind_.size());
    system_.constants.resize(system_.rows.size());
    const auto add = [&](int row, const Wave& wave, int power, bool is_sine, const DoubleDouble& value) {
        if (value.hi == 0.0) return;
        const int column = place(wave, power, is_sine);
        const auto at = static_cast<std::size_t>(row);
        if (column < 0)
            system_.constants[at] += value;
        else
            system_.rows[at].push_back({column, value});
    };
    for (int i = 0; i < own_; ++i)
        for (const Wave& w : forcing[static_cast<std::size_t>(i)].all()) {
            add(i, w, w.power, false, w.cosine);
            if (w.pace.hi != 0.0) add(i, w, w.power, true, w.sine);
        }
    for (std::size_t i = 0; i < behind_.size(); ++i) {
        const Wave w = behind_[i];
        const bool is_sine = w.sine.hi != 0.0;
        const int row = own_ + static_cast<int>(i);
        add(row, w, w.power, is_sine, w.growth);
        if (w.pace.hi != 0.0) add(row, w, w.power, !is_sine, is_sine ? w.pace : -w.pace);
        if (w.power > 0) add(row, w, w.power - 1, is_sine, static_cast<double>(w.power));
    }
}

RBDYN_INLINE LinearSystem ForcedSystem::begun(const DoubleDouble& time) const {
    LinearSystem result = system_;
    for (const Wave& w : behind_) {
        DoubleDouble value = w.growth.hi != 0.0 ? exp(w.growth * time) : DoubleDouble(1.0);
        for (int k = 0; k < w.power; ++k) value *= time;
        if (w.pace.hi != 0.0) {
            const auto [s, c] = sine_cosine(w.pace * time);
            value *= w.sine.hi != 0.0 ? s : c;
        }
        result.start.push_back(value);
    }
    return result;
}

}  // namespace rbdyn::inline RBDYN_FORM
