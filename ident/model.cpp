#include "ident/model.hpp"

#include <cassert>

namespace modebank {

std::vector<std::string> LinearStructure::parameter_names() const {
  std::vector<std::string> names;
  for (Eigen::Index i = 1; i <= states; ++i) {
    const std::string row = states == 1 ? "" : std::to_string(i);
    for (Eigen::Index j = 1; j <= states; ++j) names.push_back(states == 1 ? "A" : "A" + row + std::to_string(j));
    for (Eigen::Index j = 1; j <= inputs; ++j) names.push_back("B" + row + std::to_string(j));
    if (intercept) names.push_back("c" + row);
  }
  return names;
}

namespace {
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
}

LinearModel unpack(const LinearStructure& s, const Eigen::VectorXd& theta) {
  assert(theta.size() == s.parameters());
  const Eigen::Map<const RowMajor> rows(theta.data(), s.states, s.regressors());
  LinearModel model{rows.leftCols(s.states), rows.middleCols(s.states, s.inputs), Eigen::VectorXd::Zero(s.states)};
  if (s.intercept) model.c = rows.rightCols(1);
  return model;
}

Eigen::VectorXd pack(const LinearStructure& s, const LinearModel& model) {
  RowMajor rows(s.states, s.regressors());
  rows.leftCols(s.states) = model.A;
  rows.middleCols(s.states, s.inputs) = model.B;
  if (s.intercept) rows.rightCols(1) = model.c;
  return Eigen::Map<const Eigen::VectorXd>(rows.data(), rows.size());
}

}  // namespace modebank
