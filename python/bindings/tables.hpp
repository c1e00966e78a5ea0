#pragma once

#include <pybind11/pybind11.h>

#include "io/import/memory_tables.hpp"

namespace modebank::python {

/// Tables of {run: (inputs, states)} or {run: (inputs,)}. Each is {column: values} with numpy arrays of doubles or
/// 64-bit integers, lists of texts, or times as datetime64[ns]. Numbers are not copied, so `tables` must outlive the
/// result.
MemoryTables memory_tables(const pybind11::dict& tables);

}  // namespace modebank::python
