#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/drift_rates.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// What the recursion knows between two samples; its sizes never change. n outputs, r = regressors().
struct DriftingMemory {
  Eigen::MatrixXd theta;                ///< r x n, coefficients of the scaled regressors
  std::vector<Eigen::MatrixXd> P;       ///< n of r x r, lower triangles: covariance of a coefficient column, over v
  std::vector<Eigen::Index> P_of = {};  ///< n, which of them an output's is; one serves all until a signal is missing
  Eigen::Index P_count = 1;             ///< how many are in use
  Eigen::VectorXd z;  ///< n * state_lags, newest sample first; a prediction where nothing was measured
  bool fresh = true;  ///< no step since the start
};

/// The Kalman filter of the coefficients: x[k+1] = x[k] + theta' h + e, where h = [z; v; (1)] / scale and theta wanders
/// as theta[k+1] = theta0 + leak (theta[k] - theta0) + w, cov(w) = q v I. In units of the variance v of e neither
/// errors nor gains depend on v, so this recursion serves every v, and all outputs together.
///
/// What the method leaves open, and why it is so here:
/// - The first step after a start has the coefficients theta0 with covariance p0 v I themselves: no leak, no q yet.
/// - Within a step: leak and q, prediction, score, coefficients, then (in the filter) the variance; so a sample is
///   scored by nothing that it had a part in.
/// - A step without a measurement leaks and adds q, too: time passes. Its prediction stands in for the sample.
/// - Where some signals of a sample are missing the others' coefficients learn alone; P is then their own from there
/// on.
/// - Between samples further apart a step is taken per sample period with the inputs held, as banks do.
class DriftingRecursion {
 public:
  /// theta0: p, of the regressors as they are; scale: r, positive. `direction`: r x n, of unit length, what of an
  /// output's scaled coefficients wanders: cov(w) = q v d d'; empty: all of them, cov(w) = q v I.
  DriftingRecursion(const LinearStructure& structure, const Eigen::VectorXd& theta0, const Eigen::VectorXd& scale,
                    const DriftRates& rates, Eigen::MatrixXd direction = {});

  void start(const Eigen::Ref<const Eigen::VectorXd>& z);
  /// To the next model step; `inputs`: those that act on it.
  void predict(const Eigen::Ref<const Eigen::VectorXd>& inputs);
  /// Nothing was measured: the prediction is the sample.
  void skip();
  /// Takes the sample in; what is missing of it is the prediction.
  void update(const Eigen::Ref<const Eigen::VectorXd>& measured);

  const Eigen::VectorXd& prediction() const { return prediction_; }  ///< n, of the newest sample
  const Eigen::VectorXd& innovation() const { return innovation_; }  ///< n, of the last update; NaN where missing
  /// 1 + h'Ph, the variance of an output's prediction over v.
  double growth(Eigen::Index output) const { return growth_(memory_.P_of[static_cast<std::size_t>(output)]); }

  const DriftingMemory& memory() const { return memory_; }
  /// Sizes must be those of memory().
  void restore(const DriftingMemory& memory) { memory_ = memory; }

 private:
  LinearStructure structure_;
  Eigen::MatrixXd theta0_;  ///< r x n, scaled
  Eigen::VectorXd inverse_scale_;
  DriftRates rates_;
  Eigen::MatrixXd direction_;
  DriftingMemory memory_;
  Eigen::VectorXd h_, prediction_, innovation_, sample_;
  Eigen::MatrixXd Ph_;      ///< r x n, one column per P in use
  Eigen::VectorXd growth_;  ///< n, one per P in use

  void drift();
  void split_partial();
  void push(const Eigen::VectorXd& sample);
};

/// theta as coefficients of scaled regressors, r x n.
Eigen::MatrixXd scaled_coefficients(const LinearStructure& structure, const Eigen::VectorXd& theta,
                                    const Eigen::VectorXd& scale);

}  // namespace modebank
