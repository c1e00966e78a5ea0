#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "app/config/config_file.hpp"

namespace modebank::python {

/// Configuration keys with their values in the form of a configuration file: True becomes true, a list 1, 2, rows of
/// numbers 1, 2 | 3, 4 and None nothing. `section`: prefix of keys without one ("window."), or empty.
app::KeyValues key_values(const pybind11::dict& keys, const std::string& section);

/// A configuration with only these keys. Throws ConfigurationError as load_config does.
app::Config config_of(const pybind11::dict& keys, const std::string& section);

/// The path of an Archive, a path object or a text.
std::string path_of(const pybind11::object& archive);

}  // namespace modebank::python
