#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "app/config/config_file.hpp"

namespace modebank::python {

/// Configuration keys with their values as a configuration file writes them: True is true, a list 1, 2, rows of numbers
/// 1, 2 | 3, 4 and None nothing. `section`: put in front of keys without one ("window."), or empty.
app::KeyValues key_values(const pybind11::dict& keys, const std::string& section);

/// A configuration of these keys alone. Throws ConfigurationError as load_config does.
app::Config config_of(const pybind11::dict& keys, const std::string& section);

/// Of an Archive, a path or text.
std::string path_of(const pybind11::object& archive);

}  // namespace modebank::python
