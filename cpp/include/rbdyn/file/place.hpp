// A value in a JSON document, and where it stands there: what is read is asked for by what it should be, and what is
// not that is refused by its path.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rbdyn/basics/error.hpp"
#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/parameter.hpp"

namespace rbdyn::inline RBDYN_FORM::file {

/// Its objects keep the order in which they were written.
using Json = nlohmann::ordered_json;

/// A refusal that names its place already.
struct Refusal : InvalidInput {
    using InvalidInput::InvalidInput;
};

/// What is known while a document is read: the numbers of the user's, by their index, and the names of bodies so far.
struct Reading {
    std::string document;  // what messages call it
    std::vector<Parameter> parameters = {};
    std::vector<std::string> bodies = {};
};

class Place {
public:
    Place(const Json& value, std::string path, Reading& reading)
        : value_(&value), path_(std::move(path)), reading_(&reading) {}

    const Json& value() const { return *value_; }
    const std::string& path() const { return path_; }
    Reading& reading() const { return *reading_; }

    /// A field of an object; none if it has none of that name.
    std::optional<Place> find(std::string_view key) const;
    Place at(std::string_view key) const;
    /// Refuses fields of an object that are none of these.
    void require_known(const std::vector<std::string_view>& known) const;
    /// An element of an array, of `size` elements.
    Place at(std::size_t index) const;
    std::size_t size() const;
    void require_size(std::size_t size) const;

    /// A finite number, or "inf", "-inf", "nan".
    double number() const;
    long integer(long lowest, long highest) const;
    bool flag() const;
    const std::string& text() const;

    /// Throws InvalidInput("<document>: <path> is <value>; <rule>").
    [[noreturn, gnu::cold]] void refuse(std::string_view rule) const;
    /// f(), whose complaints get the place in front.
    template <class F>
    auto located(F&& f) const {
        try {
            return f();
        } catch (const Refusal&) {
            throw;
        } catch (const Error& e) {
            // what is no refusal, too: that a length cannot be measured is a matter of what the file says
            complain(e.what());
        }
    }
    /// Throws InvalidInput("<document>: <path>: <message>").
    [[noreturn, gnu::cold]] void complain(std::string_view message) const;

private:
    const Json* value_;
    std::string path_;
    Reading* reading_;
};

/// A JSON document from its text. Throws InvalidInput with the place of what is none.
[[gnu::cold]] Json parsed(std::string_view text, const std::string& document);
/// Its text: what fits on a line stands on one. Every double reads back as itself. Throws InvalidInput, with its place,
/// for a string that is no UTF-8.
[[gnu::cold]] std::string printed(const Json& json);

}  // namespace rbdyn::inline RBDYN_FORM::file
