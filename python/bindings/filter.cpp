#include <pybind11/stl.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "filter/learn/chain/inputs.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "modebank/archive/load_bank.hpp"
#include "modebank/base/eigen.hpp"
#include "modebank/filter/bank_filter.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"
#include "python/bindings/keys.hpp"

namespace modebank::python {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Copies a sample's numbers from Python into a vector of fixed size. Usual types are read without making an array,
/// because a filter step takes only microseconds.
void take(const char* name, py::handle given, std::vector<double>& numbers) {
  const auto size = static_cast<py::ssize_t>(numbers.size());
  const auto require_size = [&](py::ssize_t found) {
    if (found != size)
      throw std::invalid_argument(std::string(name) + " has " + std::to_string(found) + " numbers, the bank " +
                                  std::to_string(size));
  };
  if (given.is_none()) {
    numbers.assign(numbers.size(), nan);
  } else if (PyFloat_Check(given.ptr()) != 0) {
    require_size(1);
    numbers[0] = PyFloat_AS_DOUBLE(given.ptr());
  } else if (PyTuple_Check(given.ptr()) != 0 || PyList_Check(given.ptr()) != 0) {
    require_size(PySequence_Fast_GET_SIZE(given.ptr()));
    for (py::ssize_t i = 0; i < size; ++i) {
      numbers[static_cast<std::size_t>(i)] = PyFloat_AsDouble(PySequence_Fast_GET_ITEM(given.ptr(), i));
      if (PyErr_Occurred() != nullptr) throw py::error_already_set();
    }
  } else {
    const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
    if (!array) throw py::error_already_set();
    require_size(array.size());
    std::copy_n(array.data(), size, numbers.begin());
  }
}

/// A running filter that uses a bank.
class Filter {
 public:
  Filter(const filter::Bank& bank, const FilterOptions& options)
      : filter_(bank, options),
        input_(static_cast<std::size_t>(bank.inputs())),
        measurement_(static_cast<std::size_t>(bank.measurements())) {}

  filter::Estimate step(py::handle time_s, py::handle input, py::handle measurement) {
    const double time = time_s.is_none() ? nan : PyFloat_AsDouble(time_s.ptr());
    if (PyErr_Occurred() != nullptr) throw py::error_already_set();
    take("u", input, input_);
    take("y", measurement, measurement_);
    return filter_.step(time, input_, measurement_);
  }
  std::vector<filter::Forecast> forecast(const std::optional<Samples>& inputs, std::ptrdiff_t steps) const {
    if (!inputs) return filter_.forecast(Matrix(std::ssize(input_), 0), steps);
    require_samples("u", *inputs);
    if (columns(*inputs).rows() != std::ssize(input_))
      throw std::invalid_argument("u must be (samples, " + std::to_string(input_.size()) + ")");
    return filter_.forecast(to_matrix(columns(*inputs)), steps);
  }
  py::array_t<double> snapshot() const { return copied(filter_.snapshot()); }
  void restore(const Samples& snapshot) {
    if (snapshot.ndim() != 1) throw std::invalid_argument("snapshot must be an array from Filter.snapshot()");
    filter_.restore({snapshot.data(), snapshot.data() + snapshot.size()});
  }
  filter::Estimate estimate() const { return filter_.estimate(); }
  void restart() { filter_.restart(); }
  bool started() const { return filter_.started(); }

 private:
  filter::BankFilter filter_;
  std::vector<double> input_, measurement_;
};

/// A filter of a Bank, with the options in `keys`. Or a filter of an archive, with the options of the archive's
/// evaluation; `keys` override these.
Filter make_filter(const py::object& bank, const std::string& which, const py::kwargs& keys) {
  if (py::isinstance<filter::Bank>(bank)) return {bank.cast<const filter::Bank&>(), config_of(keys, "filter.").filter};
  const std::string path = path_of(bank);
  const FilterOptions of_bank = app::stored_config(load_configuration(path), key_values(keys, "filter.")).filter;
  const bool single = which == "bank" && of_bank.variant == FilterVariant::kf;  // kf uses the global model
  const FilterOptions options = which == "bank" ? of_bank : competitor_filter(which);
  return {archive::load_bank(path, single ? "baseline" : which), options};
}

/// Forecasts as arrays with one row for each sample ahead.
struct ForecastArrays {
  py::array_t<double> state, covariance, mode_probability;

  explicit ForecastArrays(const std::vector<filter::Forecast>& ahead)
      : state(Shape{std::ssize(ahead), std::ssize(ahead.front().state)}),
        covariance(Shape{std::ssize(ahead), std::ssize(ahead.front().state), std::ssize(ahead.front().state)}),
        mode_probability(Shape{std::ssize(ahead), std::ssize(ahead.front().mode_probability)}) {
    double *x = state.mutable_data(), *P = covariance.mutable_data(), *mu = mode_probability.mutable_data();
    for (const filter::Forecast& sample : ahead) {
      x = std::ranges::copy(sample.state, x).out;
      P = std::ranges::copy(sample.covariance.values, P)
              .out;  // the matrix is symmetric, so rows and columns may be exchanged
      mu = std::ranges::copy(sample.mode_probability, mu).out;
    }
  }
};

#define MODEBANK_ESTIMATE_VECTOR(name, text)                                         \
  .def_property_readonly(                                                            \
      #name,                                                                         \
      [](const py::object& self) {                                                   \
        const auto& values = self.cast<const filter::Estimate&>().name;              \
        return view(values.data(), {static_cast<py::ssize_t>(values.size())}, self); \
      },                                                                             \
      text)
// Covariances are symmetric, so row-major and column-major order are equal.
#define MODEBANK_ESTIMATE_MATRIX(name, text)                                 \
  .def_property_readonly(                                                    \
      #name,                                                                 \
      [](const py::object& self) {                                           \
        const Matrix& matrix = self.cast<const filter::Estimate&>().name;    \
        return view(matrix.values.data(), {matrix.rows, matrix.cols}, self); \
      },                                                                     \
      text)

}  // namespace

void bind_filter(py::module_& module) {
  using filter::Estimate;
  py::class_<Estimate>(module, "Estimate",
                       "A filter's estimate at one sample; n states, n_y measurements, K modes. Before the start, and "
                       "where a measurement is missing, numbers that there are none of are NaN.")
      MODEBANK_ESTIMATE_VECTOR(prediction,
                               "(n,) predicted state before the measurement, all modes combined [state unit]")
          MODEBANK_ESTIMATE_VECTOR(innovation, "(n_y,) measurement minus prediction [state unit]")
              MODEBANK_ESTIMATE_MATRIX(innovation_covariance,
                                       "(n_y, n_y) covariance of the combined prediction [state unit^2]")
                  MODEBANK_ESTIMATE_VECTOR(state, "(n,) estimated state after the measurement [state unit]")
                      MODEBANK_ESTIMATE_MATRIX(covariance, "(n, n) covariance after the measurement [state unit^2]")
                          MODEBANK_ESTIMATE_VECTOR(pit,
                                                   "(n_y,) probability integral transform of the measurement, 0 to 1")
                              MODEBANK_ESTIMATE_VECTOR(mode_probability_predicted, "(K,) before the measurement")
                                  MODEBANK_ESTIMATE_VECTOR(mode_probability, "(K,) after the measurement")
                                      .def_readonly("nis", &Estimate::nis,
                                                    "normalised innovation squared of the measured signals")
                                      .def_readonly("log_density", &Estimate::log_density,
                                                    "log density of the measurement under its prediction [nats]")
                                      .def_readonly("steps", &Estimate::steps,
                                                    "model steps since the sample before; 0: the filter started here");
  py::class_<ForecastArrays>(
      module, "Forecast", "Predictions of the samples ahead, all modes combined; NaN before the start of the filter.")
      .def_readonly("state", &ForecastArrays::state, "(steps, n) [state unit]")
      .def_readonly("covariance", &ForecastArrays::covariance, "(steps, n, n) [state unit^2]")
      .def_readonly("mode_probability", &ForecastArrays::mode_probability, "(steps, K)");
  py::class_<Filter>(
      module, "Filter",
      "A running filter of a bank, sample by sample; one object per stream. Filter(archive) steps as the archive's "
      "evaluation did, Filter(bank) by the defaults.")
      .def(py::init(&make_filter), py::arg("bank"), py::kw_only(), py::arg("which") = "bank",
           "bank: an Archive, its path, or a Bank; which: the archive's bank, or a competitor's name (baseline, "
           "noise_only, one_motion, drifting, nonlinear). Options: keys of the [filter] section, as variant='kf'.")
      .def("step", &Filter::step, py::arg("t"), py::arg("u"), py::arg("y"),
           "The next sample in the order of time: t [s] (None or NaN: one step after the last), u: the inputs recorded "
           "at it (NaN: the last known one), y: the measurement (NaN where missing; None: nothing was measured). The "
           "first whole measurement is the start. Returns an Estimate that later steps do not change.")
      .def(
          "forecast",
          [](const Filter& self, const std::optional<Samples>& u, std::ptrdiff_t steps) {
            return ForecastArrays(self.forecast(u, steps));
          },
          py::arg("u"), py::arg("steps"),
          "The next `steps` samples without measurements; the filter stays as it is. u (samples, inputs): row i is the "
          "input planned for the sample i + 1 ahead, as step will be given it; steps minus the bank's smallest input "
          "delay (usually 1) of them are enough, None: none. Returns a Forecast.")
      .def("snapshot", &Filter::snapshot, "The filter's state as an array, to store it.")
      .def("restore", &Filter::restore, py::arg("snapshot"),
           "Continues from a snapshot of a filter of the same bank and options, with bit-identical steps.")
      .def_property_readonly("estimate", &Filter::estimate, "the last step's estimate")
      .def("restart", &Filter::restart, "Resets the filter; it starts anew at the next complete measurement.")
      .def_property_readonly("started", &Filter::started, "whether the filter has started");
}

}  // namespace modebank::python
