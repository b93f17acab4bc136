// Tables of rows as sequences in Python.
#pragma once

#include <string>

#include "binding.hpp"

namespace binding {

/// A table of rows as a sequence.
template <class Table, class Row>
void as_sequence(py::class_<Table>& type, const char* name) {
    type.def_readonly("rows", &Table::rows, "All of them, in order.")
        .def("__len__", [](const Table& t) { return t.rows.size(); })
        .def(
            "__getitem__",
            [name](const Table& t, py::ssize_t i) {
                const auto n = static_cast<py::ssize_t>(t.rows.size());
                if (i < 0) i += n;
                if (i < 0 || i >= n)
                    throw py::index_error(std::string(name) + ": there are " + std::to_string(n) + " rows");
                return t.rows[static_cast<std::size_t>(i)];
            },
            py::arg("index"))
        .def("__iter__", [](const Table& t) {
            return py::reinterpret_borrow<py::typing::Iterator<Row>>(py::iter(py::cast(t.rows)));
        });
}

}  // namespace binding
