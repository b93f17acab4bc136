// Definitions of rbdyn/file/place.hpp.
#pragma once

#include "rbdyn/file/place.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/interruption.hpp"

namespace rbdyn::inline RBDYN_FORM::file {

RBDYN_INLINE std::optional<Place> Place::find(std::string_view key) const {
    if (!value_->is_object()) refuse("it is an object, { ... }");
    const auto found = value_->find(std::string(key));
    if (found == value_->end()) return std::nullopt;
    return Place(*found, path_.empty() ? std::string(key) : path_ + "." + std::string(key), *reading_);
}

RBDYN_INLINE Place Place::at(std::string_view key) const {
    if (auto found = find(key)) return *std::move(found);
    complain("it has no \"" + std::string(key) + "\"");
}

RBDYN_INLINE void Place::require_known(const std::vector<std::string_view>& known) const {
    if (!value_->is_object()) refuse("it is an object, { ... }");
    for (const auto& [key, value] : value_->items()) {
        if (std::find(known.begin(), known.end(), key) != known.end()) continue;
        std::string list;
        for (const std::string_view k : known) list += (list.empty() ? "" : ", ") + std::string(k);
        complain("there is a \"" + key.substr(0, 40) + "\", and what there may be is " + list);
    }
}

RBDYN_INLINE Place Place::at(std::size_t index) const {
    return {(*value_)[index], path_ + "[" + std::to_string(index) + "]", *reading_};
}

RBDYN_INLINE std::size_t Place::size() const {
    if (!value_->is_array()) refuse("it is a list, [ ... ]");
    return value_->size();
}

RBDYN_INLINE void Place::require_size(std::size_t size) const {
    if (this->size() != size) refuse("it has " + std::to_string(size) + " elements");
}

RBDYN_INLINE double Place::number() const {
    if (value_->is_number()) return value_->get<double>();
    if (value_->is_string()) {
        const std::string& word = value_->get_ref<const std::string&>();
        constexpr double infinity = std::numeric_limits<double>::infinity();
        if (word == "inf") return infinity;
        if (word == "-inf") return -infinity;
        if (word == "nan") return std::numeric_limits<double>::quiet_NaN();
    }
    refuse("it is a number");
}

RBDYN_INLINE long Place::integer(long lowest, long highest) const {
    if (value_->is_number_integer()) {
        // beyond what a long holds it is beyond the limits, too
        const double x = value_->get<double>();
        if (x >= static_cast<double>(lowest) && x <= static_cast<double>(highest)) return value_->get<long>();
    }
    if (highest < lowest) refuse("it is a whole number, and here there is none that it may be");
    refuse("it is a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest));
}

RBDYN_INLINE bool Place::flag() const {
    if (!value_->is_boolean()) refuse("it is true or false");
    return value_->get<bool>();
}

RBDYN_INLINE const std::string& Place::text() const {
    if (!value_->is_string()) refuse("it is a text");
    return value_->get_ref<const std::string&>();
}

RBDYN_INLINE void Place::refuse(std::string_view rule) const {
    constexpr std::size_t longest = 60;
    std::string shown = value_->dump(-1, ' ', false, Json::error_handler_t::replace);
    if (shown.size() > longest) shown = shown.substr(0, longest - 3) + "...";
    throw Refusal(reading_->document + ": " + (path_.empty() ? "all of it" : path_) + " is " + shown + "; " +
                  std::string(rule));
}

RBDYN_INLINE void Place::complain(std::string_view message) const {
    throw Refusal(reading_->document + ": " + (path_.empty() ? "" : path_ + ": ") + std::string(message));
}

namespace reading {

/// The objects and lists that are open where a text is read, with the keys so far: a key that is there twice is
/// refused, since one of its values would go unread.
class Open {
public:
    void key(const std::string& name, const std::string& document) {
        if (!levels_.back().keys.insert(name).second) {
            const std::string within = path();
            throw InvalidInput(document + ": " + (within.empty() ? "" : within + ": ") + "the key \"" +
                               name.substr(0, 40) + "\" is there twice; give it once");
        }
        levels_.back().last = name;
    }
    /// An object, a list or a value begins.
    void next() {
        if (!levels_.empty() && levels_.back().is_list) ++levels_.back().index;
    }
    void begin(bool is_list) {
        next();
        levels_.push_back({is_list, {}, {}, -1});
    }
    void end() { levels_.pop_back(); }

private:
    struct Level {
        bool is_list;
        std::unordered_set<std::string> keys;
        std::string last;
        long index;
    };
    /// Of the innermost.
    std::string path() const {
        std::string result;
        for (std::size_t i = 0; i + 1 < levels_.size(); ++i)
            result += levels_[i].is_list ? "[" + std::to_string(levels_[i].index) + "]"
                                         : (result.empty() ? "" : ".") + levels_[i].last;
        return result;
    }
    std::vector<Level> levels_;
};

}  // namespace reading

RBDYN_INLINE Json parsed(std::string_view text, const std::string& document) {
    // far more than any scene has
    constexpr int deepest = 64;
    bool is_too_deep = false;
    reading::Open open;
    const auto watch = [&](int depth, Json::parse_event_t event, Json& value) {
        Interruption::point();
        is_too_deep = is_too_deep || depth > deepest;
        if (is_too_deep) return false;
        switch (event) {
            case Json::parse_event_t::object_start:
            case Json::parse_event_t::array_start: open.begin(event == Json::parse_event_t::array_start); break;
            case Json::parse_event_t::object_end:
            case Json::parse_event_t::array_end: open.end(); break;
            case Json::parse_event_t::key: open.key(value.get_ref<const std::string&>(), document); break;
            case Json::parse_event_t::value: open.next();
        }
        return true;
    };
    try {
        Json json = Json::parse(text, watch);
        if (!is_too_deep) return json;
    } catch (const Json::exception& e) {
        std::string what = e.what();
        // without the name that the parser has for it
        if (const auto end = what.find("] "); what.rfind("[json.", 0) == 0 && end != std::string::npos)
            what.erase(0, end + 2);
        throw InvalidInput(document + ": it is no JSON text: " + what);
    }
    throw InvalidInput(document + ": its objects and lists lie within each other more than " + std::to_string(deepest) +
                       " deep");
}

namespace printing {

/// Appends a value; `column`: where on its line it begins.
RBDYN_INLINE void print(const Json& json, std::size_t indent, std::size_t column, std::string& out) {
    constexpr std::size_t width = 100;
    const std::string line = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    // with the spaces that are still to come
    const auto spaces =
        static_cast<std::size_t>(std::count_if(line.begin(), line.end(), [](char c) { return c == ',' || c == ':'; }));
    const bool is_short = column + line.size() + spaces <= width;
    if (!json.is_structured() || json.empty()) {
        out += line;
        return;
    }
    const std::string step(is_short ? 0 : indent + 2, ' ');
    out += json.is_object() ? '{' : '[';
    bool is_first = true;
    for (const auto& [key, value] : json.items()) {
        if (!is_first) out += is_short ? ", " : ",";
        is_first = false;
        if (!is_short) out += '\n' + step;
        std::size_t at = is_short ? column : step.size();
        if (json.is_object()) {
            const std::string name = Json(key).dump(-1, ' ', false, Json::error_handler_t::replace) + ": ";
            out += name;
            at += name.size();
        }
        // what is part of a short line is short itself
        print(value, is_short ? indent : indent + 2, is_short ? 0 : at, out);
    }
    if (!is_short) out += '\n' + std::string(indent, ' ');
    out += json.is_object() ? '}' : ']';
}

}  // namespace printing

namespace printing {

/// Refuses texts that are none, which JSON cannot have, by their place.
RBDYN_INLINE void require_texts(const Json& json, const std::string& place) {
    if (json.is_string()) {
        std::string shown;
        try {
            json.dump();
            return;
        } catch (const Json::exception&) {
            // as what of it can be written
            shown = json.dump(-1, ' ', false, Json::error_handler_t::replace);
        }
        throw InvalidInput("save: " + place + " is " + shown + ", which is no UTF-8, and files have no other text; " +
                           "give another name");
    }
    if (json.is_object())
        for (const auto& [key, value] : json.items()) require_texts(value, place.empty() ? key : place + "." + key);
    if (json.is_array())
        for (std::size_t i = 0; i < json.size(); ++i) require_texts(json[i], place + "[" + std::to_string(i) + "]");
}

}  // namespace printing

RBDYN_INLINE std::string printed(const Json& json) {
    printing::require_texts(json, "");
    std::string out;
    printing::print(json, 0, 0, out);
    return out + '\n';
}

}  // namespace rbdyn::inline RBDYN_FORM::file
