#include <pybind11/stl.h>

#include <cmath>
#include <optional>

#include "app/config/section.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/model/parameter_labels.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"
#include "python/bindings/ctrl_c.hpp"
#include "python/bindings/keys.hpp"

namespace modebank::python {

namespace {

/// Fits of windows, with the run and the position of each window.
struct Windows {
  WindowFits fits;
  std::vector<std::string> labels;
  Eigen::VectorXi run, start;
};

std::vector<Channel> channels(const std::vector<std::string>& names, Index count, const char* prefix) {
  if (!names.empty() && std::ssize(names) != count)
    throw std::invalid_argument(std::to_string(names.size()) + " names for " + std::to_string(count) + " signals");
  std::vector<Channel> result;
  for (Index i = 0; i < count; ++i)
    result.push_back({names.empty() ? prefix + std::to_string(i + 1) : names[static_cast<std::size_t>(i)], ""});
  return result;
}

/// A run. With `in_place`, its arrays are not copied.
Trajectory run_of(std::size_t number, const Samples& states, const Samples& inputs, double dt_s, bool in_place) {
  require_samples("states", states);
  require_samples("inputs", inputs);
  if (inputs.shape(0) != states.shape(0))
    throw std::invalid_argument("there are " + std::to_string(states.shape(0)) + " samples of states, but " +
                                std::to_string(inputs.shape(0)) + " of inputs");
  const auto x = columns(states), u = columns(inputs);
  Trajectory run;
  run.run = std::to_string(number + 1);
  if (in_place)
    run.kept = {x.data(), u.data(), x.rows(), u.rows(), x.cols()};
  else
    run.state = x, run.input = u;
  run.time_s = Eigen::VectorXd::LinSpaced(x.cols(), 0.0, dt_s * static_cast<double>(x.cols() - 1));
  return run;
}

Windows identify(const std::vector<Samples>& states, const std::vector<Samples>& inputs, double dt_s,
                 const std::vector<std::string>& state_names, const std::vector<std::string>& input_names,
                 const py::dict& keys) {
  if (states.empty() || states.size() != inputs.size())
    throw std::invalid_argument("states and inputs must have equally many runs");
  if (!(dt_s > 0.0) || !std::isfinite(dt_s)) throw std::invalid_argument("dt must be a positive number of seconds");
  app::Config config = config_of(keys, "window.");
  if (!keys.contains("model")) config.structure.automatic_model = false;  // Windows alone use the lags in the options.
  if (app::searched_lags_of(config).any())
    throw ConfigurationError("lags and delay = auto, and window.model = auto, are found by run; give numbers here");
  const bool in_place = is_linear(config.window);
  Recording recording;
  for (std::size_t i = 0; i < states.size(); ++i)
    recording.runs.push_back(run_of(i, states[i], inputs[i], dt_s, in_place));
  const Trajectory& first = recording.runs.front();
  for (const Trajectory& run : recording.runs)
    if (run.states().rows() != first.states().rows() || run.inputs().rows() != first.inputs().rows())
      throw std::invalid_argument("all runs must have the same signals");
  recording.states = channels(state_names, first.states().rows(), "x");
  recording.inputs = channels(input_names, first.inputs().rows(), "u");
  const Unlocked unlocked;
  Windows windows;
  windows.fits = in_section("window", [&] { return fit_windows(recording, config.window); });
  windows.labels = parameter_labels(windows.fits, names_of(recording.states), names_of(recording.inputs));
  windows.run.resize(windows.fits.count());
  windows.start.resize(windows.fits.count());
  for (Index i = 0; i < windows.fits.count(); ++i) {
    windows.run(i) = static_cast<int>(windows.fits.windows[static_cast<std::size_t>(i)].run);
    windows.start(i) = static_cast<int>(windows.fits.windows[static_cast<std::size_t>(i)].start);
  }
  return windows;
}

py::array_t<double> square(const Eigen::MatrixXd& covariances, Index size, py::handle owner) {
  return view(covariances.data(), {covariances.cols(), size, size}, owner);
}

std::vector<std::string> statuses(const Windows& windows) {
  static constexpr const char* words[]{"converged", "iteration_limit", "rank_deficient", "failed"};
  std::vector<std::string> result;
  for (const int status : windows.fits.status) result.emplace_back(words[status]);
  return result;
}

/// An array with the values of `member`, a member of WindowFits with the same name.
#define MODEBANK_WINDOWS_ARRAY(name, member, text) \
  .def_property_readonly(                          \
      name, [](const py::object& self) { return view(self.cast<const Windows&>().member, self); }, text)

}  // namespace

void bind_windows(py::module_& module) {
  py::class_<Windows>(module, "Windows",
                      "Local models: the fits of M windows of n states with p parameters. Arrays are views of this "
                      "object's numbers, without a copy.")
      MODEBANK_WINDOWS_ARRAY("parameters", fits.parameters,
                             "(M, p) theta; of linear models A (row by row), B and c of each state in turn, of the "
                             "increment x[k+1] - x[k] [state unit per regressor's unit and sample]")
          .def_property_readonly(
              "covariance",
              [](const py::object& self) {
                const WindowFits& fits = self.cast<const Windows&>().fits;
                return square(fits.covariance, fits.parameters.rows(), self);
              },
              "(M, p, p) covariance of theta; NaN where the window does not determine it and there is no prior")
              MODEBANK_WINDOWS_ARRAY("noise_variance", fits.noise_variance,
                                     "(M, n) variance of the one-step residuals [state unit^2]")
                  MODEBANK_WINDOWS_ARRAY("run", run, "(M,) index of the window's run, from 0")
                      MODEBANK_WINDOWS_ARRAY("start", start, "(M,) first sample of the window") MODEBANK_WINDOWS_ARRAY(
                          "rank", fits.rank, "(M,) number of directions of theta that the window's data determine")
                          MODEBANK_WINDOWS_ARRAY("condition", fits.condition,
                                                 "(M,) condition number of the scaled regressors")
                              MODEBANK_WINDOWS_ARRAY("information", fits.information,
                                                     "(M, p) 1 - posterior over prior variance; NaN without a prior")
                                  MODEBANK_WINDOWS_ARRAY("r_squared", fits.r_squared,
                                                         "(M, n) share of the increments' variance explained")
                                      MODEBANK_WINDOWS_ARRAY(
                                          "inlier_fraction", fits.inlier_fraction,
                                          "(M,) share of samples that keep half of their least-squares weight")
                                          MODEBANK_WINDOWS_ARRAY(
                                              "prior_sd", fits.prior_sd,
                                              "(p,) standard deviations of the prior; empty without one")
                                              MODEBANK_WINDOWS_ARRAY(
                                                  "global_parameters", fits.global.theta,
                                                  "(p,) least squares over all transitions, the prior's mean")
          .def_property_readonly("status", &statuses, "M words: converged, iteration_limit, rank_deficient or failed")
          .def_property_readonly(
              "length", [](const Windows& windows) { return windows.fits.length; }, "transitions per window [samples]")
          .def_property_readonly(
              "names", [](const Windows& windows) { return windows.fits.parameter_names(); },
              "p names: a11, b12, c1, ...")
          .def_readonly("labels", &Windows::labels, "p labels in the signals' names: 'wz <- velL'")
          .def("__len__", [](const Windows& windows) { return windows.fits.count(); });
  module.def("identify", &identify, py::arg("states"), py::arg("inputs"), py::arg("dt"), py::arg("state_names"),
             py::arg("input_names"), py::arg("keys"));
}

}  // namespace modebank::python
