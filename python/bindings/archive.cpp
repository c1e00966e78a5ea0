#include "io/archive/archive.hpp"

#include <pybind11/stl.h>

#include <string>

#include "app/config/config_file.hpp"
#include "app/text/first_screen.hpp"
#include "app/text/summary_text.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"

namespace modebank::python {

namespace {

std::string screen(const std::string& path, int width) {
  const py::gil_scoped_release unlocked;
  const Archive archive = read_archive(path, Evaluations::in_file);
  return app::has_first_screen(archive) ? app::first_screen(archive, app::resolved_values(archive.config), path, width)
                                        : app::summary_text(archive, width);
}

std::string summary(const std::string& path, int width) {
  const py::gil_scoped_release unlocked;
  return app::summary_text(read_archive(path, Evaluations::in_file), width);
}

}  // namespace

void bind_archive(py::module_& module) {
  module.def(
      "check_archive",
      [](const std::string& path) {
        const py::gil_scoped_release unlocked;
        return OpenArchive(path).digest();
      },
      py::arg("path"), "SHA-256 of an archive, which is right; throws DataError for a file that is none.");
  module.def("screen", &screen, py::arg("path"), py::arg("width"));
  module.def("summary", &summary, py::arg("path"), py::arg("width"));
}

}  // namespace modebank::python
