// What a guard does on a stretch of a piece where rounding of its polynomial hides it.
//
// The polynomial of a high power that is expanded far from its root has terms that cancel there to many digits more
// than doubles have: ((t - 1/2) / w)^16 - 1 from t = 0 on is (1 / 2w)^16 times rounding, and its roots are w apart. Its
// values are known far better, and so are its series from nearer by: it is expanded anew where the stretch begins, and
// where what that hides begins, until its polynomials hide no more than its values do.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/event/passages.hpp"
#include "rbdyn/expression/hidden_terms.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/series_evaluator.hpp"
#include "rbdyn/series/piece.hpp"

namespace rbdyn::inline RBDYN_FORM {

class CloserLook {
public:
    /// In the length of the stretch.
    struct Found {
        int side;                                    // it ends on
        std::vector<Passages::Stretch> hidden = {};  // what is rounding still
        bool is_between = false;                     // a place of it is between two parts, not known any better
        std::vector<Passages::Place> places = {};
    };

    enum class Told { all, not_so_far, nothing };
    /// `side`: the guard begins on. `find(lo, hi, side, passages)`: looks for where it passes zero on a part, and
    /// returns whether that can be told, or on a shorter part only. `rounding(x)`: of the guard's values. None: it
    /// cannot be told.
    template <class Find, class Rounding, class Value>
    std::optional<Found> operator()(int side, int deeper, double finest, const Find& find, const Rounding& rounding,
                                    const Value& value) {
        finest_ = finest;
        Found found{side};
        parts_ = most_parts;
        if (!look(found, 0.0, 1.0, deeper, find, rounding)) return std::nullopt;
        const auto is_lobe = [&](double x) { return std::abs(value(x)) > 16.0 * rounding(x); };
        join(found.places, is_lobe);
        return found;
    }

    /// How deep to look where series are expanded anew.
    static constexpr int deepest = 52;

    void set_looseness(double looseness) { passages_.set_looseness(looseness); }

private:
    static constexpr int most_parts = 4000;

    /// Places that no time can tell apart are one, of a power that rounding has split, if their number is odd; else
    /// none, unless each of them is known better than that, or something is seen between them.
    template <class IsLobe>
    void join(std::vector<Passages::Place>& places, const IsLobe& is_lobe) const {
        std::ranges::sort(places, {}, &Passages::Place::x);
        std::size_t kept = 0;
        for (std::size_t i = 0, end = 0; i < places.size(); i = end) {
            bool are_apart = true;
            for (end = i + 1; end < places.size(); ++end) {
                const Passages::Place &a = places[end - 1], &b = places[end];
                const double doubt = std::max(a.doubt, b.doubt), gap = b.x - a.x;
                if (gap > std::max(finest_, doubt)) break;
                are_apart = are_apart && (gap > doubt || (gap > finest_ && is_lobe(0.5 * (a.x + b.x))));
            }
            const std::size_t count = end - i;
            if (count % 2 == 1 && !(count > 1 && are_apart)) {
                places[kept++] = places[i + count / 2];
            } else if (are_apart) {
                for (std::size_t k = i; k < end; ++k) places[kept++] = places[k];
            }
        }
        places.resize(kept);
    }

    template <class Find, class Rounding>
    bool look(Found& found, double lo, double hi, int deeper, const Find& find, const Rounding& rounding) {
        if (--parts_ < 0) return false;
        const double width = hi - lo;
        const Found before = found;
        const auto in_halves = [&] {
            found = before;
            const double middle = lo + 0.5 * width;
            return look(found, lo, middle, deeper - 1, find, rounding) &&
                   look(found, middle, hi, deeper - 1, find, rounding);
        };
        const Told told = find(lo, hi, found.side, passages_);
        if (told == Told::nothing) return false;
        if (told == Told::not_so_far && deeper > 0 && width > finest_) return in_halves();
        const auto is_known_better = [&](double a, double b) {
            const double x = 0.5 * (a + b);
            return deeper > 0 && (b - a) * width > finest_ && rounding(lo + x * width) < 0.25 * passages_.rounding(x);
        };
        const auto hide = [&](double a, double b) { found.hidden.push_back({lo + a * width, lo + b * width}); };
        if (passages_.leaves() == 0) {
            if (is_known_better(0.0, 1.0)) return in_halves();
            hide(0.0, 1.0);
            return true;
        }
        std::vector<Passages::Stretch> hidden;
        for (const Passages::Stretch& s : passages_.hidden()) {
            if (!is_known_better(s.lo, s.hi)) {
                hide(s.lo, s.hi);
                continue;
            }
            if (s.hi - s.lo > 0.5) return in_halves();
            hidden.push_back(s);
        }
        if (passages_.leaves() != found.side) {
            if (lo == 0.0) return false;
            // between two parts, how near to there is not known
            found.is_between = true;
            found.places.push_back({lo, width, width});
            found.side = -found.side;
        }
        const std::vector<Passages::Place> places = passages_.places();
        auto place = places.begin();
        const auto take_until = [&](double x) {
            for (; place != places.end() && place->x < x; ++place) {
                found.places.push_back({lo + place->x * width, place->doubt * width, place->near * width});
                found.side = -found.side;
            }
        };
        for (const Passages::Stretch& s : hidden) {
            take_until(s.lo);
            int side = found.side;
            for (; place != places.end() && place->x <= s.hi; ++place) side = -side;
            if (!look(found, lo + s.lo * width, lo + s.hi * width, deeper - 1, find, rounding)) return false;
            // beyond it is on the side it is known to be on, unless it ends first
            if (s.hi < 1.0 && found.side != side) return in_halves();
        }
        take_until(2.0);
        return true;
    }

    Passages passages_;
    double finest_ = 0.0;
    int parts_ = 0;
};

/// Guards that are outputs of a program, expanded anywhere on the polynomials of a piece.
class SeriesOnPiece {
public:
    /// Coefficients 0 .. order.
    SeriesOnPiece(const Program& program, int order);

    const Program& program() const { return series_.program(); }
    void expand(const Piece& piece, double tau, double length, std::span<const double> parameters);
    /// Whether that tells all of an output: it is not cut off before its end, nor hides terms.
    bool tells(int output) const;
    /// Of an output, in powers of (t - t(tau)) / (length units of the piece).
    const double* coefficients(int output) const { return series_.output(output); }
    /// Of the terms that these are made of.
    void sizes(int output, double* s) const;

private:
    SeriesEvaluator series_;
    HiddenTerms hidden_;
    int order_;
};

}  // namespace rbdyn::inline RBDYN_FORM
