// When a user should touch a key: one sentence for each, in the order of the option table.
#include "app/config/options/when_to_touch.hpp"

#include <unordered_map>

namespace modebank::app {
namespace {

const std::unordered_map<std::string_view, std::string_view>& data_keys() {
  static const std::unordered_map<std::string_view, std::string_view> sentences{
      {"data.root", "when the data lie elsewhere than the configuration, or move between machines"},
      {"data.inputs", "always: without it there is nothing to read"},
      {"data.states", "when what was measured and what was commanded are in different files"},
      {"data.state", "always: it is what the model predicts"},
      {"data.input", "always, unless the system moves without any input"},
      {"data.derive", "when a channel is not in the log as you need it: a yaw rate from a quaternion, another unit"},
      {"data.where", "when parts of a log do not belong to it: handling by people, a fault, a switched-off motor"},
      {"data.truth",
       "only for simulated data or an external reference (motion capture): it is compared, never learned"},
      {"data.weight", "never, unless some samples are known to be worth less than others"},
      {"data.label", "when the log says on which ground, gear or floor it was: it names modes and checks them"},
      {"data.state_unit", "when the log has no units, so that plots and exported filters say them"},
      {"data.input_unit", "when the log has no units; export to ros2 looks for m/s and rad/s"},
      {"data.time", "when the column of times has another name, or of a recording the receive time is the better one"},
      {"data.time_unit", "when durations on the screen are off by 60, a thousand or a million"},
      {"data.time_format", "when a message shows a time that it cannot read, or whose day and month may be swapped"},
      {"data.separator", "never, unless a text file is read wrongly: a mixture of separators cannot be told"},
      {"data.decimal", "never, unless numbers with a decimal comma are read wrongly"},
      {"data.na", "when your logger writes a word or a number of its own, such as -999, where nothing was measured"},
      {"data.skip_rows", "when a text file has a title above its table; `modebank init` finds the number"},
      {"data.header", "when the first row of a text file is taken for names and is not, or the other way round"},
      {"data.definitions", "when a ROS 2 .db3 recording has messages of your own types"},
      {"data.join", "row, when both files were written row by row together and their times cannot be trusted"},
      {"data.run", "when one file holds several runs"},
      {"data.rate_hz", "when `modebank check` suggests a rate: times jitter, or values only repeat between samples"},
      {"data.lag_s", "auto, when states and inputs come from two instruments; a number, when you know it"},
      {"data.lag_range_s", "when the lag is said to lie at the edge of the range"},
      {"data.quantum", "auto, when the finding says that measurements come in steps too coarse to compare densities"},
      {"data.missing", "when reading stops at a missing value: gap if samples are lost, predict if single values are"},
      {"data.disorder", "sort, when reading stops at times that go backwards and the logger is to blame"},
      {"data.split", "when there is one long run: only what is held out can be evidence"},
      {"data.train", "when some runs must train (those that excite well), or must not"},
      {"data.test", "when the held-out runs must be particular ones: another day, another ground"},
  };
  return sentences;
}

const std::unordered_map<std::string_view, std::string_view>& learning_keys() {
  static const std::unordered_map<std::string_view, std::string_view> sentences{
      {"window.model",
       "auto, when the screen's last lines say that errors follow a pattern, or the plant answers late; a motion "
       "model, when its "
       "parameters (a track, a radius) are what you are after"},
      {"window.state_lags", "with varx, or to keep auto from searching: when the order of the motion is known"},
      {"window.input_lags",
       "with varx, or to keep auto from searching: when the length of the input's effect is known"},
      {"window.input_delay",
       "with varx, or to keep auto from searching: when a dead time of whole samples is known; for lags of clocks "
       "data.lag_s"},
      {"window.wheel_radius_m", "with icr and slip, when inputs are wheel speeds in rad/s"},
      {"window.length",
       "when `modebank check` suggests another: longer where windows are rank deficient, shorter where "
       "modes last less than a window; auto, when the model has many lags"},
      {"window.step",
       "larger, when windows are too many to wait for: neighbours share most of their samples; beyond 100,000 windows "
       "auto does it"},
      {"window.loss", "when `modebank check` suggests it: tukey for gross errors, trivial for clean data"},
      {"window.loss_scale", "never, unless you study the loss itself"},
      {"window.scale", "run or fixed, when windows are so short that their own scale is noise"},
      {"window.sigma", "with scale = fixed: from the sensor's data sheet or a standstill"},
      {"window.prior", "none, when windows excite everything and you want each one's own fit, as the published recipe"},
      {"window.prior_sd", "when the prior pulls windows of a rare ground towards the common one: larger"},
      {"window.terms",
       "a list, when physics says how the motion bends, such as vx * wz; none, to leave nonlinear and its time out"},
      {"window.intercept", "when the motion has a constant part: a slope, a leak, a sensor's offset"},
      {"window.covariance", "sandwich, when noise differs within a window and you use the windows' standard errors"},
      {"window.solver", "never, unless a warning says that the batch solver's cost was above Ceres'"},
      {"window.max_iterations", "when `modebank show` counts windows at the iteration limit"},
      {"mixture.components",
       "when the selected number stands at the end of the range; a single number to repeat a study"},
      {"mixture.covariance", "diagonal, when windows are few for their parameters"},
      {"mixture.criterion",
       "rarely: a refined bank chooses its number of modes by runs left out; the others are for studies of the "
       "mixture"},
      {"mixture.features",
       "parameters, when modes should differ in motion and not in noise alone; parameters+noise with bank.theta = "
       "mean"},
      {"mixture.windows", "all, with error_aware, when hardly any window is of full rank"},
      {"mixture.straddling", "never, unless you study how windows over a switch blur the components"},
      {"mixture.start", "an archive, to go on from a mixture found before"},
      {"mixture.restarts", "more, when a warning says that few restarts reached the best optimum"},
      {"mixture.split_merge", "0, to see what plain restarts find; else never"},
      {"mixture.tolerance", "never, unless candidates stop at mixture.max_iterations"},
      {"mixture.max_iterations", "when `modebank show` has candidates that did not converge"},
      {"mixture.covariance_floor", "when candidates rest on the floor: your parameters are of another size than one"},
      {"mixture.error_aware", "when windows are noisy and differ much in how well they are excited"},
      {"mixture.noise_component", "when some windows are of no mode (collisions, lifts) and blur the others"},
      {"bank.theta", "mean, for the published recipe"},
      {"bank.mode_names", "when you know what the modes are and show the results to others"},
      {"bank.noise", "shared or fixed, to see what the modes' own noise is worth; such a bank is not refined"},
      {"bank.noise_by_input", "none, for a bank that is exported to C or whose R is looked for"},
      {"bank.transition", "stay, when switches are too few to count; logit, when they depend on where one drives"},
      {"bank.stay", "with transition = stay: 1 - 1/N for a mode that lasts N samples"},
      {"bank.process_variance", "with noise = fixed: the Q you would have tuned by hand"},
      {"bank.measurement_variance", "when you know the sensor's noise and a warning says that R cannot be told"},
      {"bank.screen", "false, when the motion itself is unstable or drifts, and the run ends with no mode left"},
      {"bank.modes", "when the filter must be small, on a microcontroller: then the least that your score allows"},
      {"bank.refine", "none, for a look at the data in seconds, or to keep the mixture's own modes"},
      {"bank.restarts", "more, when repeated runs with other seeds differ by more than the gain's standard error"},
      {"bank.look_ahead", "when predictions several samples ahead matter (control): the number of samples"},
      {"bank.look_ahead_score", "error, when the mean of long predictions matters (free run), not their spread"},
      {"bank.folds", "1, to save time when you choose the number of modes yourself"},
      {"bank.refine_transitions",
       "less, when learning from a long recording takes too long; 0, when time is no matter"},
      {"bank.drift",
       "auto, when conditions change within a run (wear, load, temperature) and a competitor that drifts wins"},
      {"bank.max_iterations", "when the screen says that the fit was stopped by it"},
      {"bank.tolerance", "never, unless a fit must be repeated to more digits"},
  };
  return sentences;
}

const std::unordered_map<std::string_view, std::string_view>& using_keys() {
  static const std::unordered_map<std::string_view, std::string_view> sentences{
      {"filter.variant", "never, unless you compare filters: imm serves; kf is the one model alone"},
      {"filter.noise", "adaptive, when the band is found false: the noise's scale then follows the run"},
      {"filter.horizon", "when you predict for control: the number of samples that the controller looks ahead"},
      {"filter.simulate", "when the model shall simulate: so many measured samples at the start, then inputs alone"},
      {"filter.simulate_horizon", "when runs are so long that a free run to their end means nothing"},
      {"filter.simulate_start", "fixed, for comparison with benchmarks that start a free run from a measurement"},
      {"filter.simulate_method",
       "paths, when a mode's spread is no Gaussian and the band must show it; it takes longer"},
      {"filter.paths", "more, when a free run by paths must be smooth in its outer quantiles"},
      {"filter.smooth", "false, when archives of long runs are too large"},
      {"archive.output", "when the archive shall have another name or place than the configuration's"},
      {"archive.input", "when windows or a mixture were archived before and only later stages change"},
      {"archive.bank", "when a bank that exists is judged on other runs"},
      {"job.threads", "when the machine is shared: fewer"},
      {"job.seed", "to see how much of a result is luck: repeat with three other seeds"},
      {"study.vary", "for every study: it is what a study varies"},
      {"study.together", "when two varied keys belong together (rate and window length)"},
      {"study.when", "when a varied key means nothing beside some values of another"},
      {"study.sample", "when the full grid has more runs than there is time for"},
      {"study.sampling", "sobol, when a study is extended later: its points fill what those before left"},
      {"study.repeats", "3 or more, when differences between settings may be luck of the seed"},
      {"study.output", "when the study's folder shall have another name or place"},
      {"study.jobs", "fewer than cores, when runs need much memory"},
      {"study.timeout_s", "when some settings take forever and shall count as failed"},
      {"study.on_failure", "stop, while you try out a study's configuration"},
      {"study.retry", "false, when failures are known to come again"},
      {"study.cache_mb", "more, when many runs share a long import; less, on a small disk"},
      {"study.stage", "on a cluster: submit, then merge at the end; on one machine never"},
      {"study.estimate", "before a long study, to know how long it will take"},
      {"study.shard", "never on a cluster, whose job script sets it; by hand to share a study among machines"},
      {"study.flat", "when study.h5 must be one file that can be copied alone"},
      {"study.page", "when you want to watch a long study"},
      {"study.slurm_tasks", "when your cluster limits the size of job arrays, or tasks are too short"},
      {"study.slurm_options", "always with submit: your cluster's partition, time and memory"},
      {"track.filter", "when the finding names a simpler description: that one"},
      {"track.format", "never, unless the first line misleads"},
      {"track.level", "when another interval than 95 % is needed"},
      {"track.alarm", "higher, when there are too many alarms: 0.999 is one in 1000 samples of a true filter"},
      {"track.checkpoint", "when the filter must go on after a restart as if there had been none"},
      {"track.checkpoint_interval", "with a checkpoint: when power may fail"},
      {"track.resume", "after a restart: the checkpoint that was kept"},
      {"track.forecast", "when inputs come late and the state of now is wanted"},
      {"track.watchdog_s", "when the filter runs unattended and someone reads its log"},
      {"report.size_mb", "when the page of long runs must show more samples, or must be sent by mail"},
      {"report.runs", "0, when a study's page alone is enough; more, when you look into many runs"},
  };
  return sentences;
}

const std::unordered_map<std::string_view, std::string_view>& simulation_keys() {
  static const std::unordered_map<std::string_view, std::string_view> sentences{
      {"simulate.output", "for every simulation that is to be kept"},
      {"simulate.system",
       "vehicle, when physics shall make the data; linear, when the true modes must be known exactly"},
      {"simulate.outlier_fraction", "to see how a robust loss copes"},
      {"simulate.outlier_sd", "with outlier_fraction: some ten times the noise"},
      {"simulate.input_law", "white for the best excitation, drive for what robots do"},
      {"simulate.hold_samples", "longer, to see how poor excitation hurts"},
      {"simulate.input_amplitude", "when your system's inputs are of another size"},
      {"simulate.input_quantum", "when your commands come in steps"},
      {"simulate.standstill_fraction", "as in your logs; much of it leaves windows rank deficient"},
      {"simulate.equal_fraction", "as in your logs: straight driving tells little about turning"},
      {"simulate.runs", "when an answer needs more (or fewer) runs: evidence needs some"},
      {"simulate.samples", "when an answer needs longer runs"},
      {"simulate.rate_hz", "as in your logs"},
      {"simulate.state_rate_hz", "as in your logs; equal to rate_hz where both come together"},
      {"simulate.modes", "always with linear: it is the system"},
      {"simulate.process_sd", "always with linear: noise in the motion"},
      {"simulate.measurement_sd", "when your sensor's noise is not small beside the motion's"},
      {"simulate.transition", "when modes follow each other by a known matrix; else dwell_samples is enough"},
      {"simulate.dwell_samples", "for modes that switch within a run; a few windows long, to be found well"},
      {"simulate.mass", "for your vehicle"},
      {"simulate.yaw_inertia", "for your vehicle"},
      {"simulate.track", "for your vehicle"},
      {"simulate.wheelbase", "for your vehicle; 0 turns without scrubbing"},
      {"simulate.contact_length", "never, unless you know your tyres"},
      {"simulate.slip_speed", "never, unless stick and slip near standstill is what you study"},
      {"simulate.drive_mass", "never, unless you know your drive"},
      {"simulate.drive_time", "for your vehicle's speed controller: its step response"},
      {"simulate.drive_force", "for your vehicle; on grip it limits what wheels can follow"},
      {"simulate.friction", "for your grounds: 0.05 to 0.1 is ice, 0.6 dry floor"},
      {"simulate.ground_names", "when modes shall be named after the grounds"},
      {"simulate.shear", "never, unless grounds shall differ in stiffness, too"},
      {"simulate.resistance", "higher for soft ground"},
      {"simulate.patch", "0, for one ground a run; larger, for longer stays on each"},
      {"simulate.forward_speed", "0, for turning on the spot alone"},
      {"simulate.turn_scale", "below 1, for a driver who turns gently"},
      {"simulate.gyro_noise_density", "from your gyro's data sheet"},
      {"simulate.gyro_bias", "from your gyro's data sheet, to see what window.intercept does"},
      {"simulate.gyro_bias_walk", "from your gyro's data sheet"},
      {"simulate.speed_noise_sd", "when data.state names speeds, too"},
      {"simulate.wheel_quantum", "for your encoders"},
      {"simulate.lag_s", "to see whether lag_s = auto finds it"},
      {"simulate.drift", "to see whether lag_s = auto finds it"},
      {"simulate.step", "never, unless you check the integration: half of it must change nothing"},
  };
  return sentences;
}

}  // namespace

std::string when_to_touch(const std::string& key) {
  for (const auto& sentences : {data_keys(), learning_keys(), using_keys(), simulation_keys()})
    if (const auto found = sentences.find(key); found != sentences.end()) return std::string(found->second);
  return "";
}

}  // namespace modebank::app
