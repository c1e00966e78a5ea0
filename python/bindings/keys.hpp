#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "app/config/config_file.hpp"

namespace modebank::python {

/// Converts configuration keys and values to the form of a configuration file. True becomes true, a list becomes 1, 2,
/// rows of numbers become 1, 2 | 3, 4 and None becomes an empty value. `section`: prefix ("window.") of keys that have
/// none; may be empty.
app::KeyValues key_values(const pybind11::dict& keys, const std::string& section);

/// A configuration that contains only these keys. Throws ConfigurationError in the same cases as load_config.
app::Config config_of(const pybind11::dict& keys, const std::string& section);

/// The path that is given as an Archive, a path object or a text.
std::string path_of(const pybind11::object& archive);

}  // namespace modebank::python
