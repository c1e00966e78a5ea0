#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "modebank/base/matrix.hpp"

/// Conversion between numpy's arrays and Eigen's matrices. A matrix here has one sample, window or mode per column, in
/// column-major order. In memory this equals numpy's row-major (count, ...) array, so no copy is needed.
namespace modebank::python {

namespace py = pybind11;

/// An array of doubles from Python. A row-major array is used in place; any other array is copied.
using Samples = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Shape = std::vector<py::ssize_t>;

/// A read-only array of numbers that belong to `owner`. Nothing is copied. The array keeps the owner alive.
template <class T>
py::array_t<T> view(const T* numbers, Shape shape, py::handle owner) {
  py::array_t<T> array(std::move(shape), numbers, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// A copy of `matrix` in which each column becomes a row.
template <class Derived>
py::array_t<typename Derived::Scalar> view(const Eigen::PlainObjectBase<Derived>& values, py::handle owner) {
  if constexpr (Derived::IsVectorAtCompileTime)
    return view(values.data(), {values.size()}, owner);
  else
    return view(values.data(), {values.cols(), values.rows()}, owner);
}

/// A copy that owns its memory.
template <class T>
py::array_t<T> copied(const T* numbers, Shape shape) {
  return py::array_t<T>(std::move(shape), numbers);
}
inline py::array_t<double> copied(const std::vector<double>& values) {
  return copied(values.data(), {static_cast<py::ssize_t>(values.size())});
}
/// A copy of a matrix in which rows stay rows.
inline py::array_t<double> copied(const Matrix& matrix) {
  py::array_t<double> array(Shape{matrix.rows, matrix.cols});
  for (py::ssize_t i = 0; i < matrix.rows; ++i)
    for (py::ssize_t j = 0; j < matrix.cols; ++j) array.mutable_at(i, j) = matrix(i, j);
  return array;
}

/// A numpy array (N, n) as an n x N matrix. A vector counts as (N, 1).
inline Eigen::Map<const Eigen::MatrixXd> columns(const Samples& samples) {
  return {samples.data(), samples.ndim() < 2 ? 1 : samples.shape(1), samples.ndim() < 1 ? 1 : samples.shape(0)};
}

/// Throws std::invalid_argument unless the shape is (N, n) or (N,).
inline void require_samples(const char* name, const Samples& samples) {
  if (samples.ndim() == 1 || samples.ndim() == 2) return;
  throw std::invalid_argument(std::string(name) + " has " + std::to_string(samples.ndim()) +
                              " dimensions: it must be (samples, signals), or (samples,) of one signal");
}

}  // namespace modebank::python
