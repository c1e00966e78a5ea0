#include "tests/support/golden.hpp"

#include <cmath>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "tests/support/paths.hpp"

namespace modebank::test {

namespace {

void collect(const nlohmann::json& value, std::vector<double>& numbers) {
  if (value.is_array())
    for (const nlohmann::json& part : value) collect(part, numbers);
  else
    numbers.push_back(value.is_null() ? std::nan("") : value.get<double>());
}

}  // namespace

nlohmann::json read_golden(const std::string& name) {
  std::ifstream file(golden_dir() / (name + ".json"));
  if (!file) throw std::runtime_error("no golden file " + name);
  return nlohmann::json::parse(file);
}

Eigen::MatrixXd golden_columns(const nlohmann::json& rows) {
  Eigen::MatrixXd result;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    std::vector<double> numbers;
    collect(rows[k], numbers);
    if (k == 0) result.resize(std::ssize(numbers), std::ssize(rows));
    result.col(static_cast<Eigen::Index>(k)) = Eigen::VectorXd::Map(numbers.data(), std::ssize(numbers));
  }
  return result;
}

Eigen::MatrixXd golden_rows(const nlohmann::json& rows) { return golden_columns(rows).transpose(); }

}  // namespace modebank::test
