#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>

namespace modebank::test {

/// Reads a golden file, tests/golden/NAME.json. Throws if the file does not exist.
nlohmann::json read_golden(const std::string& name);

/// The matrix with the rows of a JSON array (numbers, or rows of numbers in any nesting); null becomes NaN.
Eigen::MatrixXd golden_rows(const nlohmann::json& rows);

/// Like golden_rows, but transposed: the file has one sample per row, the matrix one sample per column.
Eigen::MatrixXd golden_columns(const nlohmann::json& rows);

}  // namespace modebank::test
