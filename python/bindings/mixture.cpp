#include <pybind11/stl.h>

#include "mixture/select.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"
#include "python/bindings/ctrl_c.hpp"
#include "python/bindings/keys.hpp"

namespace modebank::python {

namespace {

py::array_t<double> covariances(const GaussianMixture& mixture) {
  const Index K = mixture.components(), F = mixture.features();
  py::array_t<double> array(Shape{K, F, F});
  for (Index k = 0; k < K; ++k)
    Eigen::Map<Eigen::MatrixXd>(array.mutable_data(k), F, F) = mixture.covariances[static_cast<std::size_t>(k)];
  return array;
}

/// Points (N, F) in the form that the mixture's functions use.
Eigen::MatrixXd points_of(const Samples& points) {
  require_samples("points", points);
  return columns(points);
}

Selection fit_mixture(const Samples& points, double effective_samples, std::uint64_t seed, const py::dict& keys) {
  const SelectionOptions options = config_of(keys, "mixture.").mixture.selection;
  const Eigen::MatrixXd values = points_of(points);
  const Unlocked unlocked;
  return select(PointSet(values), effective_samples, options, seed);
}

py::object candidates(const Selection& selection) {
  py::list rows;
  for (const Candidate& candidate : selection.candidates) {
    py::dict row;
    row["components"] = candidate.components;
    row["log_likelihood"] = candidate.log_likelihood;
    row["parameters"] = candidate.parameters;
    row["effective_samples"] = candidate.effective_samples;
    row["bic"] = candidate.bic;
    row["aic"] = candidate.aic;
    row["converged"] = candidate.converged;
    row["selected"] = candidate.selected;
    rows.append(row);
  }
  return py::module_::import("pandas").attr("DataFrame")(rows);
}

py::array_t<double> responsibilities_of(const Selection& selection, const Samples& points) {
  const Eigen::MatrixXd values = points_of(points);
  const Eigen::MatrixXd result = responsibilities(selection.mixture, values);
  return copied(result.data(), {result.cols(), result.rows()});
}

py::array_t<double> log_densities(const Selection& selection, const Samples& points) {
  const Eigen::MatrixXd values = points_of(points);
  const Eigen::VectorXd result = log_density(selection.mixture, values);
  return copied(result.data(), {result.size()});
}

}  // namespace

void bind_mixture(py::module_& module) {
  py::class_<Selection>(module, "Mixture", "A mixture of K Gaussians over F features, in the points' units.")
      .def_property_readonly(
          "weights", [](const py::object& self) { return view(self.cast<const Selection&>().mixture.weights, self); },
          "(K,) decreasing")
      .def_property_readonly(
          "means", [](const py::object& self) { return view(self.cast<const Selection&>().mixture.means, self); },
          "(K, F) [feature unit]")
      .def_property_readonly(
          "covariances", [](const Selection& selection) { return covariances(selection.mixture); },
          "(K, F, F) [feature unit^2]")
      .def_property_readonly("candidates", &candidates, "a pandas table: every number of components with its criteria")
      .def("responsibilities", &responsibilities_of, py::arg("points"),
           "(N, K) posterior probability of each component at points (N, F).")
      .def("log_density", &log_densities, py::arg("points"), "(N,) log density at points (N, F) [nats].");
  module.def("fit_mixture", &fit_mixture, py::arg("points"), py::arg("effective_samples"), py::arg("seed"),
             py::arg("keys"));
}

}  // namespace modebank::python
