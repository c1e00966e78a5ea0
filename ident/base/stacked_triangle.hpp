#pragma once

#include "ident/base/linalg.hpp"

namespace modebank {

/// R of the QR decomposition of both below each other; they as they are where that has no fewer rows. Block after block
/// it takes least squares over any number of rows in the memory of one block.
inline Eigen::MatrixXd stacked_triangle(const Eigen::MatrixXd& above, const Eigen::MatrixXd& below) {
  Eigen::MatrixXd rows(above.rows() + below.rows(), below.cols());
  rows << above, below;
  return rows.rows() <= rows.cols() ? rows : qr_triangle(rows);
}

}  // namespace modebank
