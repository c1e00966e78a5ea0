#pragma once

#include <pybind11/pybind11.h>

#include "io/import/memory_tables.hpp"

namespace modebank::python {

/// The tables of {run: (inputs, states)} or {run: (inputs,)}, each {column: values} as numpy arrays of doubles or
/// 64-bit integers, lists of texts, or times as datetime64[ns]. Their numbers stay where they are: `tables` must
/// outlive the result.
MemoryTables memory_tables(const pybind11::dict& tables);

}  // namespace modebank::python
