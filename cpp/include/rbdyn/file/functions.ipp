// Definitions of rbdyn/file/functions.hpp.
#pragma once

#include "rbdyn/file/functions.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rbdyn/expression/function.hpp"
#include "rbdyn/expression/node.hpp"
#include "rbdyn/expression/parameter.hpp"

namespace rbdyn::inline RBDYN_FORM::file {

RBDYN_INLINE int Writing::index_of(const Parameter& parameter, double value) {
    std::size_t i = 0;
    while (i < parameters.cells.size() && !(parameters.cells[i].is(parameter) && parameters.values[i] == value)) ++i;
    if (i == parameters.cells.size()) {
        parameters.cells.push_back(parameter);
        parameters.values.push_back(value);
    }
    return static_cast<int>(i);
}

namespace lines {

/// Operations of one argument, of two between which their sign stands, and of several behind their word.
inline constexpr std::array<std::pair<Operation, std::string_view>, 12> of_one = {
    {{Operation::square_root, "sqrt"},
     {Operation::sine, "sin"},
     {Operation::cosine, "cos"},
     {Operation::hyperbolic_sine, "sinh"},
     {Operation::hyperbolic_cosine, "cosh"},
     {Operation::hyperbolic_tangent, "tanh"},
     {Operation::exponential, "exp"},
     {Operation::logarithm, "log"},
     {Operation::expm1, "expm1"},
     {Operation::log1p, "log1p"},
     {Operation::arsinh, "arcsinh"},
     {Operation::artanh, "arctanh"}}};
inline constexpr std::array<std::pair<Operation, std::string_view>, 3> between = {
    {{Operation::add, "+"}, {Operation::multiply, "*"}, {Operation::divide, "/"}}};
inline constexpr std::array<std::pair<Operation, std::string_view>, 2> named = {
    {{Operation::sign, "sign"}, {Operation::whole, "floor"}}};

template <class Table>
std::string_view word_of(const Table& table, Operation operation) {
    for (const auto& [known, word] : table)
        if (known == operation) return word;
    return {};
}

/// A double as a text that reads back as itself.
RBDYN_INLINE std::string digits(double x) {
    if (std::isnan(x)) return "nan";
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, x).ptr};
}

RBDYN_INLINE std::string line_of(const Function& f, std::int32_t index, const std::vector<int>& cells) {
    const Node& n = f.node(index);
    const auto operand = [](std::int32_t k) { return "n" + std::to_string(k); };
    const auto with_name = [&](const std::string& text) {
        const std::string& name = f.names()[static_cast<std::size_t>(n.d)];
        return name.empty() ? text : text + "  (" + name + ")";
    };
    switch (n.operation) {
        case Operation::constant: return digits(n.value) + (n.is_wide ? " rest " + digits(n.rest) : "");
        case Operation::input: return "input " + std::to_string(n.a);
        case Operation::cell: return "parameter " + std::to_string(cells[static_cast<std::size_t>(n.a)]);
        case Operation::power: return operand(n.a) + " ^ " + digits(n.value);
        case Operation::raise: return operand(n.a) + " ^ " + operand(n.b);
        case Operation::angle: return "arctan2 " + operand(n.a) + " " + operand(n.b);
        case Operation::norm: return "norm " + operand(n.a) + " " + operand(n.b) + " " + operand(n.c);
        case Operation::select:
            return with_name(operand(n.b) + " where " + operand(n.a) + " > 0, else " + operand(n.c));
        default: break;
    }
    if (const auto word = word_of(between, n.operation); !word.empty())
        return operand(n.a) + " " + std::string(word) + " " + operand(n.b);
    if (const auto word = word_of(named, n.operation); !word.empty())
        return with_name(std::string(word) + " " + operand(n.a));
    return std::string(word_of(of_one, n.operation)) + " " + operand(n.a);
}

/// A line, read word by word.
class Words {
public:
    Words(const Place& place, std::int32_t index) : place_(place), rest_(place.text()), index_(index) {
        const std::string begin = "n" + std::to_string(index) + " = ";
        if (rest_.substr(0, begin.size()) != begin) place_.refuse("it begins with \"" + begin + "\"");
        rest_.remove_prefix(begin.size());
        // a name stands at the end, whatever is in it
        if (const auto open = rest_.find("  ("); open != std::string_view::npos && rest_.back() == ')') {
            name_ = rest_.substr(open + 3, rest_.size() - open - 4);
            rest_ = rest_.substr(0, open);
        }
    }

    std::string_view next() {
        const std::size_t end = std::min(rest_.find(' '), rest_.size());
        const std::string_view word = rest_.substr(0, end);
        rest_.remove_prefix(std::min(end + 1, rest_.size()));
        return word;
    }
    bool is_over() const { return rest_.empty(); }
    void expect(std::string_view word) {
        if (next() != word) refuse();
    }
    double number(std::string_view word) const {
        double x = 0.0;
        if (!is_all_read(word, x)) refuse();
        return x;
    }
    std::int32_t whole(std::string_view word, std::int32_t below) const {
        std::int32_t x = 0;
        if (!is_all_read(word, x) || x < 0 || x >= below) refuse();
        return x;
    }
    /// An earlier line.
    std::int32_t line(std::string_view word) const {
        if (word.empty() || word.front() != 'n') refuse();
        return whole(word.substr(1), index_);
    }
    const std::string& name() const { return name_; }
    [[noreturn]] void refuse() const {
        place_.refuse("it is an operation on earlier lines, inputs, parameters of the file and numbers");
    }

private:
    template <class T>
    static bool is_all_read(std::string_view word, T& x) {
        const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), x);
        return problem == std::errc() && end == word.data() + word.size() && !word.empty();
    }

    const Place& place_;
    std::string_view rest_;
    std::string name_;
    std::int32_t index_;
};

/// What is read so far of a function.
struct Read {
    int inputs = 0;
    std::vector<Node> nodes;
    std::vector<std::string> names;
    std::vector<int> parameters;  // by their index in the file

    template <class T>
    static std::int32_t index_in(std::vector<T>& all, const T& thing) {
        const auto found = std::find(all.begin(), all.end(), thing);
        const auto index = static_cast<std::int32_t>(found - all.begin());
        if (found == all.end()) all.push_back(thing);
        return index;
    }
};

RBDYN_INLINE Node node_from(const Place& place, Read& f) {
    Words words(place, static_cast<std::int32_t>(f.nodes.size()));
    const std::string_view first = words.next();
    Node n{Operation::constant};
    const auto take_name = [&] { n.d = Read::index_in(f.names, words.name()); };
    if (first == "input") {
        n = {Operation::input, words.whole(words.next(), f.inputs)};
    } else if (first == "parameter") {
        const auto count = static_cast<std::int32_t>(place.reading().parameters.size());
        n = {Operation::cell, Read::index_in(f.parameters, static_cast<int>(words.whole(words.next(), count)))};
    } else if (first == "arctan2" || first == "norm") {
        n.operation = first == "norm" ? Operation::norm : Operation::angle;
        n.a = words.line(words.next());
        n.b = words.line(words.next());
        if (first == "norm") n.c = words.line(words.next());
    } else if (!first.empty() && first.front() == 'n' && first != "nan") {
        const std::int32_t a = words.line(first);
        const std::string_view sign = words.next();
        const auto* const found =
            std::find_if(between.begin(), between.end(), [&](const auto& p) { return p.second == sign; });
        if (found != between.end()) {
            n = {found->first, a, words.line(words.next())};
        } else if (sign == "^") {
            const std::string_view exponent = words.next();
            if (!exponent.empty() && exponent.front() == 'n' && exponent != "nan")
                n = {Operation::raise, a, words.line(exponent)};
            else
                n = {Operation::power, a, -1, -1, -1, words.number(exponent)};
        } else if (sign == "where") {
            n = {Operation::select, words.line(words.next()), a};
            words.expect(">");
            words.expect("0,");
            words.expect("else");
            n.c = words.line(words.next());
            take_name();
        } else {
            words.refuse();
        }
    } else if (!first.empty() && std::isalpha(static_cast<unsigned char>(first.front())) != 0 && first != "inf" &&
               first != "nan") {
        const auto same = [&](const auto& p) { return p.second == first; };
        const auto* const one = std::find_if(of_one.begin(), of_one.end(), same);
        const auto* const other = std::find_if(named.begin(), named.end(), same);
        if (one == of_one.end() && other == named.end()) words.refuse();
        n = {one != of_one.end() ? one->first : other->first, words.line(words.next())};
        if (one == of_one.end()) take_name();
    } else {
        n.value = words.number(first);
        if (!words.is_over()) {
            words.expect("rest");
            n.rest = words.number(words.next());
            n.is_wide = true;
        }
    }
    if (!words.is_over() || (n.d < 0 && !words.name().empty())) words.refuse();
    return n;
}

}  // namespace lines

RBDYN_INLINE Json function_to(const Function& given, Writing& writing) {
    const Function f = given.canonical();
    GivenNumbers numbers;
    given.give(numbers);
    std::vector<int> cells;
    for (const Parameter& p : f.parameters())
        for (std::size_t i = 0; i < numbers.cells.size(); ++i)
            if (numbers.cells[i].is(p)) cells.push_back(writing.index_of(p, numbers.values[i]));
    Json operations = Json::array(), results = Json::array();
    for (std::int32_t i = 0; i < f.size(); ++i)
        operations.push_back("n" + std::to_string(i) + " = " + lines::line_of(f, i, cells));
    for (const std::int32_t out : f.output_nodes()) results.push_back("n" + std::to_string(out));
    Json json = {{"inputs", f.inputs()}, {"operations", std::move(operations)}, {"results", std::move(results)}};
    return json;
}

RBDYN_INLINE Function function_from(const Place& place) {
    place.require_known({"inputs", "operations", "results"});
    lines::Read f;
    f.inputs = static_cast<int>(place.at("inputs").integer(0, 1'000'000));
    const Place operations = place.at("operations"), results = place.at("results");
    for (std::size_t i = 0; i < operations.size(); ++i) f.nodes.push_back(lines::node_from(operations.at(i), f));
    std::vector<std::int32_t> outputs;
    for (std::size_t i = 0; i < results.size(); ++i) {
        const Place at = results.at(i);
        const std::string& text = at.text();
        std::int32_t line = -1;
        const char* end = text.data() + text.size();
        if (text.size() < 2 || text.front() != 'n' || std::from_chars(text.data() + 1, end, line).ptr != end ||
            line < 0 || static_cast<std::size_t>(line) >= f.nodes.size())
            at.refuse("it is the name of an operation, as \"n0\"");
        outputs.push_back(line);
    }
    std::vector<Parameter> parameters;
    for (const int index : f.parameters)
        parameters.push_back(place.reading().parameters[static_cast<std::size_t>(index)]);
    return place.located([&] { return Function::from_data(f.inputs, f.nodes, outputs, f.names, parameters); });
}

}  // namespace rbdyn::inline RBDYN_FORM::file
