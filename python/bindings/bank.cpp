#include "modebank/filter/bank.hpp"

#include <pybind11/stl.h>

#include <functional>
#include <optional>

#include "modebank/archive/load_bank.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"

namespace modebank::python {

namespace {

/// One matrix per mode, as an array (K, rows, cols).
py::array_t<double> stacked(const filter::Bank& bank, const std::function<Matrix(const filter::Mode&)>& part) {
  const filter::BankDescription all = bank.description();
  const Matrix first = part(all.modes.front());
  py::array_t<double> array(Shape{std::ssize(all.modes), first.rows, first.cols});
  for (py::ssize_t k = 0; k < array.shape(0); ++k) {
    const Matrix values = part(all.modes[static_cast<std::size_t>(k)]);
    for (py::ssize_t i = 0; i < values.rows; ++i)
      for (py::ssize_t j = 0; j < values.cols; ++j) array.mutable_at(k, i, j) = values(i, j);
  }
  return array;
}

Matrix matrix_of(const char* name, const Samples& array) {
  if (array.ndim() != 2) throw std::invalid_argument(std::string(name) + " must have two dimensions");
  Matrix matrix(array.shape(0), array.shape(1));
  for (py::ssize_t i = 0; i < matrix.rows; ++i)
    for (py::ssize_t j = 0; j < matrix.cols; ++j) matrix(i, j) = array.at(i, j);
  return matrix;
}

/// Matrix k of an array (K, rows, cols).
Matrix mode_matrix(const char* name, const Samples& array, py::ssize_t k, py::ssize_t modes) {
  if (array.ndim() != 3 || array.shape(0) != modes)
    throw std::invalid_argument(std::string(name) + " must have three dimensions, the first of them the modes'");
  Matrix matrix(array.shape(1), array.shape(2));
  for (py::ssize_t i = 0; i < matrix.rows; ++i)
    for (py::ssize_t j = 0; j < matrix.cols; ++j) matrix(i, j) = array.at(k, i, j);
  return matrix;
}

filter::Bank make_bank(const Samples& A, const Samples& B, const Samples& Q, const Samples& transition,
                       const std::optional<Samples>& c, const std::optional<Samples>& C,
                       const std::optional<Samples>& R, double dt) {
  if (A.ndim() != 3) throw std::invalid_argument("A must be (modes, states, states)");
  filter::BankDescription all;
  for (py::ssize_t k = 0; k < A.shape(0); ++k) {
    filter::Mode mode;
    mode.A = mode_matrix("A", A, k, A.shape(0));
    mode.B = mode_matrix("B", B, k, A.shape(0));
    mode.Q = mode_matrix("Q", Q, k, A.shape(0));
    mode.c.assign(static_cast<std::size_t>(mode.A.rows), 0.0);
    if (c && (c->ndim() != 2 || c->shape(0) != A.shape(0) || c->shape(1) != A.shape(1)))
      throw std::invalid_argument("c must be (modes, states)");
    for (py::ssize_t i = 0; c && i < c->shape(1); ++i) mode.c[static_cast<std::size_t>(i)] = c->at(k, i);
    mode.weight = 1.0 / static_cast<double>(A.shape(0));
    all.modes.push_back(std::move(mode));
  }
  all.transition = matrix_of("transition", transition);
  if (C) all.C = matrix_of("C", *C);
  const std::ptrdiff_t measured = C ? all.C.rows : all.modes.front().A.rows;
  all.R = R ? matrix_of("R", *R) : Matrix(measured, measured);
  all.inputs = all.modes.front().B.cols;
  all.intercept = c.has_value();
  all.dt_s = dt;
  return filter::Bank(all);
}

py::array_t<double> offsets(const filter::Bank& bank) {
  return stacked(bank,
                 [](const filter::Mode& mode) {
                   Matrix row(1, std::ssize(mode.c));
                   row.values = mode.c;
                   return row;
                 })
      .reshape({bank.modes(), py::ssize_t{-1}});
}

std::vector<double> weights(const filter::Bank& bank) {
  std::vector<double> result;
  for (const filter::Mode& mode : bank.description().modes) result.push_back(mode.weight);
  return result;
}

}  // namespace

void bind_bank(py::module_& module) {
  py::class_<filter::Bank>(
      module, "Bank",
      "K modes of motion, x[k+1] = x[k] + A x[k] + B u[k] + c + w, w ~ N(0, Q) per sample period, how they "
      "follow each other, and y = C x + v, v ~ N(0, R). Immutable.")
      .def(
          py::init(&make_bank), py::arg("A"), py::arg("B"), py::arg("Q"), py::arg("transition"),
          py::arg("c") = py::none(), py::arg("C") = py::none(), py::arg("R") = py::none(), py::arg("dt") = 0.0,
          "A (K, n, n) of the increment, B (K, n, m), Q (K, n, n) [state unit^2], transition (K, K) with rows that sum "
          "to one, c (K, n), C (n_y, n), None: the state is measured; R (n_y, n_y), None: exactly; dt: sample period "
          "[s], 0: whatever comes.")
      .def_static(
          "load", [](const std::string& path, const std::string& which) { return archive::load_bank(path, which); },
          py::arg("path"), py::arg("which") = "bank", py::call_guard<py::gil_scoped_release>(),
          "The bank of an archive, or the competitor `which`; its hash is checked.")
      .def_property_readonly(
          "A", [](const filter::Bank& b) { return stacked(b, [](const filter::Mode& m) { return m.A; }); },
          "(K, n, n) matrices of the increment; the full form is I + A")
      .def_property_readonly(
          "B", [](const filter::Bank& b) { return stacked(b, [](const filter::Mode& m) { return m.B; }); }, "(K, n, m)")
      .def_property_readonly(
          "Q", [](const filter::Bank& b) { return stacked(b, [](const filter::Mode& m) { return m.Q; }); },
          "(K, n, n) covariance of the process noise per step [state unit^2]")
      .def_property_readonly("c", &offsets, "(K, n) [state unit]")
      .def_property_readonly(
          "weights", [](const filter::Bank& b) { return copied(weights(b)); }, "(K,) shares of the windows")
      .def_property_readonly(
          "C", [](const filter::Bank& b) { return copied(b.description().C); }, "(n_y, n)")
      .def_property_readonly(
          "R", [](const filter::Bank& b) { return copied(b.description().R); },
          "(n_y, n_y) covariance of the measurement noise [state unit^2]")
      .def_property_readonly(
          "transition", [](const filter::Bank& b) { return copied(b.description().transition); },
          "(K, K), row i: probabilities of the mode that follows mode i")
      .def_property_readonly(
          "initial_probability", [](const filter::Bank& b) { return copied(b.description().initial_probability); },
          "(K,)")
      .def_property_readonly("state_names", [](const filter::Bank& b) { return b.description().state_names; })
      .def_property_readonly("input_names", [](const filter::Bank& b) { return b.description().input_names; })
      .def_property_readonly("modes", &filter::Bank::modes, "K")
      .def_property_readonly("states", &filter::Bank::states, "n, including lagged states")
      .def_property_readonly("measurements", &filter::Bank::measurements, "n_y, number of measurements in a step")
      .def_property_readonly("inputs", &filter::Bank::inputs, "number of inputs in a step")
      .def_property_readonly("dt", &filter::Bank::dt_s, "sample period of one step [s]");
}

}  // namespace modebank::python
