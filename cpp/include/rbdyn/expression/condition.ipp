// Definitions of rbdyn/expression/condition.hpp.
#pragma once

#include "rbdyn/expression/condition.hpp"

#include <compare>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/expression/elementary.hpp"
#include "rbdyn/expression/expression.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/recorder.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE Condition Condition::positive(const Expression& margin) {
    if (margin.is_constant()) return margin.is_positive();
    Condition c(true);
    c.kind_ = Kind::positive;
    c.margin_ = margin;
    return c;
}

RBDYN_INLINE Condition::~Condition() {
    std::vector<std::shared_ptr<Condition>> parts;
    const auto take = [&](Condition& c) {
        if (c.a_ != nullptr) parts.push_back(std::move(c.a_));
        if (c.b_ != nullptr) parts.push_back(std::move(c.b_));
    };
    for (take(*this); !parts.empty();) {
        const std::shared_ptr<Condition> part = std::move(parts.back());
        parts.pop_back();
        if (part.use_count() == 1) take(*part);
    }
}

RBDYN_INLINE Recorder* Condition::recorder() const {
    const Condition* c = this;
    // what is known is never joined
    while (c->kind_ != Kind::positive && c->a_ != nullptr) c = c->a_.get();
    return c->kind_ == Kind::positive ? c->margin_.recorder() : nullptr;
}

/// The ways to an answer: what is asked, and by which way to go on from either answer to that. Each is there once.
class Condition::Ways {
public:
    // those that are at their end
    static constexpr int yes = 0, no = 1;

    int to(const Condition* asked, int if_so, int if_not) {
        const auto [known, is_new] = places_.try_emplace({asked, if_so, if_not}, static_cast<int>(ways_.size()));
        if (is_new) ways_.push_back({asked, if_so, if_not});
        return known->second;
    }
    /// The same way, to a comparison first or at its end.
    int resolved(int way) {
        while (way > no) {
            const auto [c, if_so, if_not] = ways_[static_cast<std::size_t>(way)];
            switch (c->kind_) {
                case Kind::positive: return way;
                case Kind::always: way = if_so; break;
                case Kind::never: way = if_not; break;
                case Kind::negation: way = to(c->a_.get(), if_not, if_so); break;
                case Kind::both: way = to(c->a_.get(), to(c->b_.get(), if_so, if_not), if_not); break;
                case Kind::differ:
                    way = to(c->a_.get(), to(c->b_.get(), if_not, if_so), to(c->b_.get(), if_so, if_not));
                    break;
            }
        }
        return way;
    }
    const Expression& margin(int way) const { return ways_[static_cast<std::size_t>(way)].asked->margin_; }
    int after(int way, bool holds) const {
        const Way& w = ways_[static_cast<std::size_t>(way)];
        return holds ? w.if_so : w.if_not;
    }

private:
    struct Way {
        const Condition* asked;
        int if_so, if_not;
        auto operator<=>(const Way&) const = default;
    };
    std::vector<Way> ways_{{nullptr, yes, yes}, {nullptr, no, no}};
    std::map<Way, int> places_;
};

RBDYN_INLINE bool Condition::holds(const std::function<bool(const Expression&)>& positive) const {
    Ways ways;
    int way = ways.resolved(ways.to(this, Ways::yes, Ways::no));
    while (way > Ways::no) way = ways.resolved(ways.after(way, positive(ways.margin(way))));
    return way == Ways::yes;
}

RBDYN_INLINE Expression Condition::choose_joined(const std::function<Expression()>& b,
                                                 const std::function<Expression()>& c, const std::string& name) const {
    Ways ways;
    std::map<int, Expression> found;
    /// The answers that a comparison is to be followed by, in the order in which they are recorded.
    const auto needed = [&](const Expression& x) -> std::vector<bool> {
        Recorder* r = x.recorder();
        if (r->purpose() != Recorder::Purpose::model) return {true, false};
        const auto weight = r->weight(x, name);
        if (!weight) return {r->side(x, name) > 0};
        if (weight->is_constant() && weight->value() == 1.0) return {true};
        return weight->is_zero() ? std::vector<bool>{false} : std::vector<bool>{false, true};
    };
    const int first = ways.to(this, Ways::yes, Ways::no);
    std::vector<int> open{first};
    while (!open.empty()) {
        const int way = open.back(), at = ways.resolved(way);
        const auto next = [&]() -> std::optional<int> {
            if (at != way) return at;
            if (way <= Ways::no) return std::nullopt;
            for (const bool answer : needed(ways.margin(way)))
                if (!found.contains(ways.after(way, answer))) return ways.after(way, answer);
            return std::nullopt;
        }();
        if (next && !found.contains(*next)) {
            open.push_back(*next);
            continue;
        }
        open.pop_back();
        if (found.contains(way)) continue;
        if (next)
            found.emplace(way, found.at(*next));
        else if (way <= Ways::no)
            found.emplace(way, way == Ways::yes ? b() : c());
        else
            found.emplace(way, select(
                                   ways.margin(way), [&] { return found.at(ways.after(way, true)); },
                                   [&] { return found.at(ways.after(way, false)); }, name));
    }
    return found.at(first);
}

RBDYN_INLINE Condition Condition::joined(Kind kind, const Condition& a, const Condition& b) {
    Condition c(true);
    c.kind_ = kind;
    c.a_ = std::make_shared<Condition>(a);
    if (kind != Kind::negation) c.b_ = std::make_shared<Condition>(b);
    return c;
}

RBDYN_INLINE Expression where(const Condition& condition, const Expression& b, const Expression& c) {
    return condition.choose([&] { return b; }, [&] { return c; });
}

RBDYN_INLINE Expression max(const Expression& a, const Expression& b) {
    return (a > b).choose([&] { return a; }, [&] { return b; }, "maximum");
}

RBDYN_INLINE Expression min(const Expression& a, const Expression& b) {
    return (a < b).choose([&] { return a; }, [&] { return b; }, "minimum");
}

}  // namespace rbdyn::inline RBDYN_FORM
