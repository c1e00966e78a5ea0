#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ident/model/linear_model.hpp"
#include "ident/model/motion_model.hpp"

namespace modebank::test {

/// The linear increment model (without lags) as a motion model. Its fits must equal those of the linear model. Its
/// start theta = 0 means that the state stays constant.
class LinearMotion final : public MotionModel {
 public:
  explicit LinearMotion(const LinearStructure& structure) : structure_(structure) {
    for (const std::string& name : structure.parameter_names()) table_.push_back({name, ""});
  }

  const std::string& name() const override { return name_; }
  Eigen::Index states() const override { return structure_.states; }
  Eigen::Index inputs() const override { return structure_.inputs; }
  const std::vector<ModelParameter>& parameters() const override { return table_; }

  void predict(const double* theta, const double* x, const double* u, double, double* next, double* by_theta,
               double* by_x, double* by_u) const override {
    const Eigen::Index n = states(), m = inputs(), q = structure_.regressors();
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::Map<const RowMajor> rows(theta, n, q);
    Eigen::VectorXd phi(q);
    fill_regressor(structure_, Eigen::Map<const Eigen::VectorXd>(x, n), Eigen::Map<const Eigen::VectorXd>(u, m), phi);
    Eigen::Map<Eigen::VectorXd>(next, n) = Eigen::Map<const Eigen::VectorXd>(x, n) + rows * phi;
    if (by_theta) {
      Eigen::Map<RowMajor> out(by_theta, n, n * q);
      out.setZero();
      for (Eigen::Index i = 0; i < n; ++i) out.row(i).segment(i * q, q) = phi;
    }
    if (by_x) Eigen::Map<RowMajor>(by_x, n, n) = rows.leftCols(n) + Eigen::MatrixXd::Identity(n, n);
    if (by_u) Eigen::Map<RowMajor>(by_u, n, m) = rows.middleCols(n, m);
  }

 private:
  LinearStructure structure_;
  std::string name_ = "linear";
  std::vector<ModelParameter> table_;
};

inline std::shared_ptr<const MotionModel> make_linear_motion(const LinearStructure& structure) {
  return std::make_shared<LinearMotion>(structure);
}

}  // namespace modebank::test
