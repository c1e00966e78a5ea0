#pragma once

#include "ident/base/linalg.hpp"

namespace modebank {

/// R factor of [above; below]. If the stacked matrix has at most as many rows as columns, returns the stacked matrix
/// itself. Calls for one block of rows after another solve a least-squares problem of any length in the memory of one
/// block.
inline Eigen::MatrixXd stacked_triangle(const Eigen::MatrixXd& above, const Eigen::MatrixXd& below) {
  Eigen::MatrixXd rows(above.rows() + below.rows(), below.cols());
  rows << above, below;
  return rows.rows() <= rows.cols() ? rows : qr_triangle(rows);
}

}  // namespace modebank
