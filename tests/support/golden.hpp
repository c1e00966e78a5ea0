#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>

namespace modebank::test {

/// A golden file, tests/golden/NAME.json. Throws when it is absent.
nlohmann::json read_golden(const std::string& name);

/// Numbers, or rows of numbers (any nesting below), as the matrix with these rows; null: NaN.
Eigen::MatrixXd golden_rows(const nlohmann::json& rows);

/// The same with rows as columns: one sample per row there, one per column here.
Eigen::MatrixXd golden_columns(const nlohmann::json& rows);

}  // namespace modebank::test
