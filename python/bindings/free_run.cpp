#include <memory>

#include "app/chain/stages.hpp"
#include "app/config/config_file.hpp"
#include "app/config/free_run_check.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "modebank/filter/bank.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"
#include "python/bindings/ctrl_c.hpp"
#include "python/bindings/keys.hpp"

namespace modebank::python {

namespace {

Trajectory run_of(const Samples& time_s, const Samples& states, const Samples& inputs) {
  require_samples("states", states);
  require_samples("inputs", inputs);
  if (time_s.size() != states.shape(0) || time_s.size() != inputs.shape(0))
    throw std::invalid_argument("times, states and inputs must have one sample each for every time");
  Trajectory run;
  run.run = "simulated";
  run.role = Role::test;
  run.time_s = Eigen::Map<const Eigen::VectorXd>(time_s.data(), time_s.size());
  run.state = columns(states);
  run.input = columns(inputs);
  return run;
}

FreeRun predict(const Bank& bank, const app::Config& config, const Samples& time_s, const Samples& states,
                const Samples& inputs) {
  const Trajectory run = run_of(time_s, states, inputs);
  const FreeRunOptions how = scoring_inputs(app::chain_options(config)).free_run;
  check_free_run(bank.structure, how);
  const Unlocked unlocked;
  return std::move(free_runs(bank, {run}, config.filter, how).front());
}

/// A free run of a Bank, with the options in `keys`. Or a free run of an archive, with the archive's own options;
/// `keys` override these.
FreeRun simulate(const py::object& bank, const Samples& time_s, const Samples& states, const Samples& inputs,
                 const py::dict& keys) {
  if (py::isinstance<filter::Bank>(bank))
    return predict(bank.cast<const filter::Bank&>().internal(), config_of(keys, "filter."), time_s, states, inputs);
  const std::string path = path_of(bank);
  return predict(modebank::load_bank(path), app::stored_config(load_configuration(path), key_values(keys, "filter.")),
                 time_s, states, inputs);
}

#define MODEBANK_FREE_RUN_ARRAY(name, member, text) \
  .def_property_readonly(                           \
      name, [](const py::object& self) { return view(self.cast<const FreeRun&>().member, self); }, text)

}  // namespace

void bind_free_run(py::module_& module) {
  py::class_<FreeRun>(
      module, "FreeRun",
      "Predictions of a run from its first samples and the inputs alone, one row per sample; NaN (mode: "
      "-1) where nothing was predicted.")
      MODEBANK_FREE_RUN_ARRAY("mean", mean, "(N, n_y) mean of the measurement [state unit]")
          MODEBANK_FREE_RUN_ARRAY("sd", deviation, "(N, n_y) standard deviation of the measurement [state unit]")
              MODEBANK_FREE_RUN_ARRAY("lower", lower, "(N, n_y) lower end of the central 95 % band [state unit]")
                  MODEBANK_FREE_RUN_ARRAY("upper", upper, "(N, n_y) upper end of the central 95 % band [state unit]")
                      MODEBANK_FREE_RUN_ARRAY("log_density", log_density,
                                              "(N,) log density of the measurements [nats]; NaN without a measurement")
                          MODEBANK_FREE_RUN_ARRAY("mode", mode, "(N,) most probable mode");
  module.def("simulate", &simulate, py::arg("bank"), py::arg("times"), py::arg("states"), py::arg("inputs"),
             py::arg("keys"));
}

}  // namespace modebank::python
