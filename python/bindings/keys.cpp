#include "python/bindings/keys.hpp"

namespace modebank::python {

namespace py = pybind11;

namespace {

bool is_list(py::handle value) {
  return !py::isinstance<py::str>(value) && !py::isinstance<py::bytes>(value) && py::hasattr(value, "__iter__");
}

std::string text_of(py::handle value) {
  if (value.is_none()) return "";
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::hasattr(value, "__fspath__")) return py::str(value.attr("__fspath__")());
  if (!is_list(value)) return py::str(value);
  std::string text;
  for (const py::handle part : value) {
    if (!text.empty()) text += is_list(part) ? " | " : ", ";
    text += text_of(part);
  }
  return text;
}

}  // namespace

app::KeyValues key_values(const py::dict& keys, const std::string& section) {
  app::KeyValues result;
  for (const auto& [key, value] : keys) {
    const std::string name = py::str(key);
    result.emplace_back(name.find('.') == std::string::npos ? section + name : name, text_of(value));
  }
  return result;
}

std::string path_of(const py::object& archive) {
  const py::object path = py::getattr(archive, "path", archive);
  return py::str(py::module_::import("os").attr("fspath")(path));
}

app::Config config_of(const py::dict& keys, const std::string& section) {
  return app::stored_config("", key_values(keys, section));
}

}  // namespace modebank::python
