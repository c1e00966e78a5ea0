#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>

namespace modebank::test {

/// Reads a golden file, tests/golden/NAME.json. Throws when it does not exist.
nlohmann::json read_golden(const std::string& name);

/// The matrix with these rows (numbers, or rows of numbers in any nesting); null becomes NaN.
Eigen::MatrixXd golden_rows(const nlohmann::json& rows);

/// The same with rows as columns: the file has one sample per row, the matrix one per column.
Eigen::MatrixXd golden_columns(const nlohmann::json& rows);

}  // namespace modebank::test
