#pragma once

#include <pybind11/pybind11.h>

/// The parts of the module. Each part is in a file of the same name.
namespace modebank::python {

void bind_archive(pybind11::module_& module);
void bind_bank(pybind11::module_& module);
void bind_filter(pybind11::module_& module);
void bind_free_run(pybind11::module_& module);
void bind_mixture(pybind11::module_& module);
void bind_tables(pybind11::module_& module);
void bind_run(pybind11::module_& module);
void bind_windows(pybind11::module_& module);

}  // namespace modebank::python
