#pragma once

#include <pybind11/pybind11.h>

/// Parts of the module; each is in a file of its name.
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
