#pragma once

#include <muParser.h>

#include <string>
#include <vector>

namespace modebank {

/// Removes muParser's own functions and constants. Defines the functions and constants of io/import/expression.hpp.
void define_functions(mu::Parser& parser);

/// Names of the functions that define_functions defines, and of the functions that need whole columns.
const std::vector<std::string>& function_names();

}  // namespace modebank
