#include <pybind11/pybind11.h>

#include "app/chain/build_info.hpp"
#include "modebank/base/error.hpp"
#include "python/bindings/bindings.hpp"

PYBIND11_MODULE(_modebank, module) {
  module.doc() = "The compiled part of modebank; use `import modebank`.";
  module.attr("__version__") = modebank::build_info::version;
  pybind11::register_exception<modebank::ConfigurationError>(module, "ConfigurationError", PyExc_ValueError);
  pybind11::register_exception<modebank::DataError>(module, "DataError", PyExc_RuntimeError);
  modebank::python::bind_bank(module);
  modebank::python::bind_filter(module);
  modebank::python::bind_free_run(module);
  modebank::python::bind_windows(module);
  modebank::python::bind_mixture(module);
  modebank::python::bind_archive(module);
  modebank::python::bind_tables(module);
  modebank::python::bind_run(module);
}
