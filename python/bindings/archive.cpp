#include "io/archive/archive.hpp"

#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "app/config/config_file.hpp"
#include "app/text/first_screen.hpp"
#include "app/text/mode_families.hpp"
#include "app/text/summary_text.hpp"
#include "modebank/base/eigen.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"

namespace modebank::python {

namespace {

std::string screen(const std::string& path, int width) {
  const py::gil_scoped_release unlocked;
  const Archive archive = read_archive(path, Evaluations::in_file);
  const app::Settings settings = app::resolved_values(archive.config);
  return app::has_first_screen(archive) ? app::first_screen(archive, settings, path, width)
                                        : app::summary_text(archive, app::time_unit(settings), width);
}

std::string summary(const std::string& path, int width) {
  const py::gil_scoped_release unlocked;
  const Archive archive = read_archive(path, Evaluations::in_file);
  return app::summary_text(archive, app::time_unit(app::resolved_values(archive.config)), width);
}

/// One dictionary for each family of modes. The most used family comes first.
py::list families(const std::string& path) {
  std::vector<app::ModeFamily> all;
  {
    const py::gil_scoped_release unlocked;
    const Archive archive = read_archive(path, Evaluations::in_file);
    if (archive.bank) all = app::mode_families(archive);
  }
  py::list list;
  for (const app::ModeFamily& family : all) {
    py::dict said;
    said["title"] = family.title();
    said["modes"] = family.modes;
    said["use"] = family.use;
    said["stay_s"] = family.stay_s;
    said["time_constant_s"] = family.slowest.time_constant_s;
    said["time_constant_error_s"] = family.slowest.time_constant_error_s;
    said["gain"] = copied(to_matrix(family.gain));
    said["gain_error"] = copied(to_matrix(family.gain_error));
    list.append(said);
  }
  return list;
}

}  // namespace

void bind_archive(py::module_& module) {
  module.def(
      "check_archive",
      [](const std::string& path) {
        const py::gil_scoped_release unlocked;
        return OpenArchive(path).digest();
      },
      py::arg("path"), "SHA-256 of an archive after a check; throws DataError for a file that is not an archive.");
  module.def("families", &families, py::arg("path"),
             "Families of the modes of an archive's bank, most used first: one dictionary per family.");
  module.def("screen", &screen);
  module.def("summary", &summary);
}

}  // namespace modebank::python
