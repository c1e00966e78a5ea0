#pragma once

#include <pybind11/pybind11.h>

#include "io/import/memory_tables.hpp"

namespace modebank::python {

/// Converts {run: (inputs, states)} or {run: (inputs,)} to tables. `inputs` and `states` are each {column: values}.
/// Values are numpy arrays of doubles or 64-bit integers, lists of texts, or times as datetime64[ns].
/// Numbers are not copied, so `tables` must outlive the result.
MemoryTables memory_tables(const pybind11::dict& tables);

}  // namespace modebank::python
