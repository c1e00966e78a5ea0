#pragma once

#include "ident/base/linalg.hpp"

namespace modebank {

/// R factor of [above; below], or the stacked matrix itself if it has at most as many rows as columns. With a call per
/// block of rows, least squares over any number of rows needs the memory of one block.
inline Eigen::MatrixXd stacked_triangle(const Eigen::MatrixXd& above, const Eigen::MatrixXd& below) {
  Eigen::MatrixXd rows(above.rows() + below.rows(), below.cols());
  rows << above, below;
  return rows.rows() <= rows.cols() ? rows : qr_triangle(rows);
}

}  // namespace modebank
