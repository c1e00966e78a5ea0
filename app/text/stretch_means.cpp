#include "app/text/stretch_means.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace modebank {

Eigen::MatrixXd stretch_means(const Eigen::MatrixXd& rows, Eigen::Index count) {
  if (count < 1) throw std::invalid_argument("stretch_means: count must be at least 1");
  count = std::min(count, rows.cols());
  Eigen::MatrixXd means(rows.rows(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index begin = i * rows.cols() / count, end = (i + 1) * rows.cols() / count;
    for (Eigen::Index k = 0; k < rows.rows(); ++k) {
      const auto stretch = rows.row(k).segment(begin, end - begin).array();
      const Eigen::Index finite = stretch.isFinite().count();
      means(k, i) = finite == 0 ? std::numeric_limits<double>::quiet_NaN()
                                : stretch.isFinite().select(stretch, 0.0).sum() / static_cast<double>(finite);
    }
  }
  return means;
}

}  // namespace modebank
