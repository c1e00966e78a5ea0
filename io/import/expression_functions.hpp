#pragma once

#include <muParser.h>

#include <string>
#include <vector>

namespace modebank {

/// Removes muParser's own functions and constants, and defines those of io/import/expression.hpp.
void define_functions(mu::Parser& parser);

/// Names from define_functions, and of the functions of whole columns.
const std::vector<std::string>& function_names();

}  // namespace modebank
