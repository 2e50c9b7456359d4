/// Converts data to arrays for NumPy and pandas.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

namespace plant_sim::python {

/// An array with `of(row)` for each row. Text becomes Python strings, which pandas does not convert.
template <class Rows, class Of>
[[nodiscard]] pybind11::array column(const Rows& rows, const Of& of) {
    using Value = std::decay_t<decltype(of(*rows.begin()))>;
    const auto count = static_cast<pybind11::ssize_t>(rows.size());
    if constexpr (std::is_same_v<Value, std::string>) {
        pybind11::list texts(count);
        std::size_t i = 0;
        for (const auto& row : rows) texts[i++] = pybind11::str(of(row));
        return pybind11::module_::import("numpy").attr("array")(texts, pybind11::arg("dtype") = "object");
    } else {
        pybind11::array_t<Value> values(count);
        Value* next = values.mutable_data();
        for (const auto& row : rows) *next++ = of(row);
        return values;
    }
}

[[nodiscard]] inline pybind11::array column(const std::vector<double>& values) {
    return pybind11::array_t<double>(static_cast<pybind11::ssize_t>(values.size()), values.data());
}

}  // namespace plant_sim::python
