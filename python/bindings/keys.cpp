#include "python/bindings/keys.hpp"

#include <optional>
#include <vector>

#include "app/config/option_table.hpp"
#include "app/config/option_text.hpp"

namespace modebank::python {

namespace py = pybind11;

namespace {

bool is_list(py::handle value) {
  return !py::isinstance<py::str>(value) && !py::isinstance<py::bytes>(value) && py::hasattr(value, "__iter__");
}

/// The elements of a list that contains only texts. Nullopt for other lists.
std::optional<std::vector<std::string>> texts_in(const py::list& list) {
  std::vector<std::string> texts;
  for (const py::handle part : list) {
    if (!py::isinstance<py::str>(part)) return std::nullopt;
    texts.push_back(py::str(part));
  }
  return texts;
}

/// The value as text, in the form of a configuration. In a list, names that contain commas are in quotes.
std::string text_of(py::handle value) {
  if (value.is_none()) return "";
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::hasattr(value, "__fspath__")) return py::str(value.attr("__fspath__")());
  if (!is_list(value)) return py::str(value);
  const py::list parts(py::reinterpret_borrow<py::object>(value));
  if (const auto texts = texts_in(parts)) return app::format_value(*texts);
  std::string text;
  for (const py::handle part : parts) {
    if (!text.empty()) text += is_list(part) ? " | " : ", ";
    text += text_of(part);
  }
  return text;
}

}  // namespace

app::KeyValues key_values(const py::dict& keys, const std::string& section) {
  app::KeyValues result;
  for (const auto& [key, value] : keys) {
    const std::string typed = py::str(key);
    const std::string name = typed.find('.') == std::string::npos ? section + typed : typed;
    const app::Option* const option = app::find_option(name);
    const bool repeats = option && option->repeatable && is_list(value);
    const py::list parts = repeats ? py::list(py::reinterpret_borrow<py::object>(value)) : py::list();
    for (const py::handle part : parts) result.emplace_back(name, text_of(part));
    if (parts.empty()) result.emplace_back(name, text_of(value));
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
