#include <string>

#include "app/chain/pipeline.hpp"
#include "app/config/config_file.hpp"
#include "modebank/base/error.hpp"
#include "python/bindings/bindings.hpp"
#include "python/bindings/keys.hpp"
#include "python/bindings/tables.hpp"

namespace modebank::python {

namespace py = pybind11;

namespace {

/// Passes progress and warnings to Python. Ctrl-C can end the run at each of these calls.
class Callbacks : public app::Adviser {
 public:
  Callbacks(py::object progress, py::object warning) : told_{py::none(), std::move(progress), std::move(warning)} {}

  void tell(Level level, const std::string& line) const override { call(told_[static_cast<std::size_t>(level)], line); }
  void done(Stage stage, const Archive& archive) const override {
    Adviser::done(stage, archive);
    call(told_[0], "");
  }

 private:
  static void call(const py::object& function, const std::string& line) {
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!function.is_none()) function(line);
  }

  std::array<py::object, 3> told_;  ///< by Level
};

/// Returns the path of the archive.
std::string run_file(const std::string& file, const py::dict& keys, const py::object& progress,
                     const py::object& warning) {
  const app::Config config = app::load_config(file, key_values(keys, ""));
  app::validate(config);
  const Callbacks callbacks(progress, warning);
  {
    const py::gil_scoped_release unlocked;
    app::check_request(config, file);
    app::run_all(config, "modebank.run(" + file + ")", callbacks);
  }
  return config.archive.output;
}

/// Processes runs in memory and returns the path of the archive. `keys` must contain archive.output.
std::string run_tables(const py::dict& tables, const py::dict& keys, const py::object& progress,
                       const py::object& warning) {
  app::Config config = config_of(keys, "");
  config.data.inputs = frames_in_memory;
  const MemoryTables memory = memory_tables(tables);
  if (memory.empty()) throw ConfigurationError("there are no runs");
  if (memory.begin()->second.size() > 1) config.data.states = frames_in_memory;
  const Callbacks callbacks(progress, warning);
  {
    const py::gil_scoped_release unlocked;
    app::check_request(config, "", &memory);
    app::run_all(config, "modebank.run(frames)", callbacks, &memory);
  }
  return config.archive.output;
}

}  // namespace

void bind_run(py::module_& module) {
  module.def("run_file", &run_file, py::arg("file"), py::arg("keys"), py::arg("progress"), py::arg("warning"));
  module.def("run_tables", &run_tables, py::arg("tables"), py::arg("keys"), py::arg("progress"), py::arg("warning"));
}

}  // namespace modebank::python
