#include "ident/model/linear_model.hpp"

#include <cassert>
#include <limits>

#include "ident/base/linalg.hpp"

namespace modebank {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::string lag_suffix(const LinearStructure& s, Eigen::Index lag) {
  return s.lagged() ? "_lag" + std::to_string(lag) : "";
}

/// Fills the rows of the lagged samples: block i of the next step equals block i - 1 of this step.
void fill_companion_rows(const LinearStructure& s, Eigen::MatrixXd& A) {
  const Eigen::Index lagged = s.dimension() - s.states;
  A.bottomRows(lagged).setZero();
  A.bottomRightCorner(lagged, lagged).diagonal().setConstant(-1.0);
  A.bottomLeftCorner(lagged, lagged).diagonal().array() += 1.0;
}

}  // namespace

std::vector<std::string> LinearStructure::parameter_names() const {
  std::vector<std::string> names;
  for (Eigen::Index i = 1; i <= states; ++i) {
    const std::string row = states == 1 ? "" : std::to_string(i);
    for (Eigen::Index lag = 1; lag <= state_lags; ++lag)
      for (Eigen::Index j = 1; j <= states; ++j)
        names.push_back((states == 1 ? "A" : "A" + row + std::to_string(j)) + lag_suffix(*this, lag));
    for (Eigen::Index lag = 0; lag < input_lags; ++lag)
      for (Eigen::Index j = 0; j < inputs; ++j)
        names.push_back("B" + row + std::to_string(j + 1) + lag_suffix(*this, input_delay[j] + lag));
    if (intercept) names.push_back("c" + row);
  }
  return names;
}

Eigen::VectorXd LinearStructure::acting_centre() const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(dimension() + acting_inputs());
  for (Eigen::Index j = 0; !centre.empty() && j < all.size(); ++j) all(j) = centre_of(j);
  return all;
}

LinearModel unpack(const LinearStructure& s, const Eigen::VectorXd& theta) {
  assert(theta.size() == s.parameters());
  const Eigen::Index n = s.dimension();
  const Eigen::Map<const RowMajor> rows(theta.data(), s.states, s.regressors());
  LinearModel model{Eigen::MatrixXd(n, n), Eigen::MatrixXd::Zero(n, s.acting_inputs()), Eigen::VectorXd::Zero(n)};
  model.A.topRows(s.states) = rows.leftCols(n);
  fill_companion_rows(s, model.A);
  model.B.topRows(s.states) = rows.middleCols(n, s.acting_inputs());
  if (s.intercept) model.c.head(s.states) = rows.rightCols(1);
  if (!s.centre.empty()) model.c.head(s.states) -= rows.leftCols(n + s.acting_inputs()) * s.acting_centre();
  return model;
}

Eigen::VectorXd pack(const LinearStructure& s, const LinearModel& model) {
  RowMajor rows(s.states, s.regressors());
  rows.leftCols(s.dimension()) = model.A.topRows(s.states);
  rows.middleCols(s.dimension(), s.acting_inputs()) = model.B.topRows(s.states);
  if (s.intercept) rows.rightCols(1) = model.c.head(s.states);
  if (!s.centre.empty()) rows.rightCols(1) += rows.leftCols(s.regressors() - 1) * s.acting_centre();
  return Eigen::Map<const Eigen::VectorXd>(rows.data(), rows.size());
}

double spectral_radius(const LinearModel& model) {
  if (!model.A.allFinite()) return std::numeric_limits<double>::infinity();
  return eigenvalues(model.full_form()).cwiseAbs().maxCoeff();
}

}  // namespace modebank
