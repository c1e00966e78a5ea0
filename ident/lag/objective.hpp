#pragma once

#include <Eigen/Core>
#include <optional>

#include "ident/data/averaged_stream.hpp"

namespace modebank {

/// The values that are searched: lag, and time constant of the response.
struct LagPoint {
  double lag_s = 0.0;
  double time_constant_s = 0.0;
};

/// The stream without missing values. Samples of states with a missing value are removed. A missing value of an input
/// is replaced by the last known value.
Stream without_missing(const Stream& stream);
Stream with_last_known(const Stream& stream);

/// States regressed on delayed inputs as a function of the delay (ident/lag/estimate.hpp).
class LagObjective {
 public:
  /// Streams without missing values, with at least two samples each. At most `most_samples` averages are compared.
  LagObjective(const Stream& states, const Stream& inputs, Eigen::Index most_samples);

  double period_s() const { return period_s_; }  ///< width and spacing of the averaging intervals
  double span_s() const { return centres_s_.size() > 0 ? centres_s_(centres_s_.size() - 1) - centres_s_(0) : 0.0; }
  Eigen::Index samples() const { return centres_s_.size(); }

  /// Mean over the states of log(1 - R^2). 0 if the inputs explain nothing, or if fewer than half of the samples have
  /// an input.
  double cost(const LagPoint& point) const;
  /// Sets the weights by Huber's loss of the residuals at `point`.
  void reweight(const LagPoint& point);

  struct Fit {
    Eigen::Index first = 0, samples = 0;  ///< the samples with known delayed inputs
    Eigen::MatrixXd inputs;               ///< m x samples, delayed and filtered inputs
    Eigen::MatrixXd coefficients;         ///< n x m, coefficients of the inputs
    Eigen::MatrixXd residuals;            ///< n x samples
    Eigen::VectorXd unexplained;          ///< n, unexplained share 1 - R^2 of each state
    Eigen::VectorXd weights;              ///< samples
  };
  std::optional<Fit> fit(const LagPoint& point) const;
  /// The inputs at `point` for the samples of `fit`, m x samples.
  Eigen::MatrixXd inputs_at(const LagPoint& point, const Fit& fit) const;

 private:
  const AveragedStream& response(double time_constant_s) const;

  Stream inputs_;
  double period_s_ = 0.0;
  Eigen::VectorXd centres_s_;  // N
  Eigen::MatrixXd states_;     // averaged states, n x N
  Eigen::VectorXd weights_;    // N
  mutable double response_time_constant_s_ = -1.0;
  mutable AveragedStream response_;
};

}  // namespace modebank
