#include "ident/fit/window_summary.hpp"

#include <cmath>
#include <vector>

#include "ident/base/not_a_number.hpp"
#include "ident/fit/scale.hpp"

namespace modebank {

namespace {

template <class Values>
Eigen::VectorXd defined(const Values& values) {
  std::vector<double> kept;
  for (Index i = 0; i < values.size(); ++i)
    if (!std::isnan(values(i))) kept.push_back(values(i));
  return Eigen::VectorXd::Map(kept.data(), static_cast<Index>(kept.size()));
}

template <class Values>
Eigen::VectorXd row_medians(const Values& values) {
  Eigen::VectorXd medians(values.rows());
  for (Index j = 0; j < values.rows(); ++j) medians(j) = median(defined(values.row(j)));
  return medians;
}

}  // namespace

WindowSummary summarize(const WindowFits& fits) {
  constexpr double significance = 2.0;
  WindowSummary summary;
  summary.parameter = row_medians(fits.parameters);
  summary.standard_error = row_medians(fits.standard_errors());
  summary.significant.resize(fits.parameter_count());
  const Eigen::MatrixXd t = fits.t_values();
  for (Index j = 0; j < t.rows(); ++j) {
    const Eigen::VectorXd values = defined(t.row(j));
    const double count = values.size() > 0 ? static_cast<double>(values.size()) : not_a_number;
    summary.significant(j) = static_cast<double>((values.array().abs() > significance).count()) / count;
  }
  summary.r_squared = row_medians(fits.r_squared);
  return summary;
}

}  // namespace modebank
