#pragma once

#include <muParser.h>

#include <string>
#include <vector>

namespace modebank {

/// Takes muParser's own functions and constants away and defines ours (io/import/expression.hpp).
void define_functions(mu::Parser& parser);

/// Names of what define_functions defines, and of the functions of columns.
const std::vector<std::string>& function_names();

}  // namespace modebank
