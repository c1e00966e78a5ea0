#include "io/archive/archive.hpp"

#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "app/config/config_file.hpp"
#include "app/text/first_screen.hpp"
#include "app/text/motions.hpp"
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

/// One dictionary for each motion, the most used first.
py::list motions(const std::string& path) {
  std::vector<app::Motion> all;
  {
    const py::gil_scoped_release unlocked;
    const Archive archive = read_archive(path, Evaluations::in_file);
    if (archive.bank) all = app::motions_of(archive);
  }
  py::list list;
  for (const app::Motion& motion : all) {
    py::dict said;
    said["title"] = motion.title();
    said["modes"] = motion.modes;
    said["use"] = motion.use;
    said["stay_s"] = motion.stay_s;
    said["time_constant_s"] = motion.slowest.time_constant_s;
    said["time_constant_error_s"] = motion.slowest.time_constant_error_s;
    said["gain"] = copied(to_matrix(motion.gain));
    said["gain_error"] = copied(to_matrix(motion.gain_error));
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
  module.def("motions", &motions, py::arg("path"),
             "Motions of an archive's bank, most used first: one dictionary per motion.");
  module.def("screen", &screen);
  module.def("summary", &summary);
}

}  // namespace modebank::python
