#include "app/export/c/c_texts.hpp"

namespace modebank::app::c_form {

const char* const step_text = R"c(/* ---- The filter ---- */

static void predict($p_filter *filter, const $p_real *v) {
  sensor_t sensor;
  const $p_gaussian *from = mix(filter, v);
  make_sensor(0, &sensor);
  for (int j = 0; j < $P_MODES; ++j) {
    predict_mode(&from[j], j, v, filter->noise_scale, &filter->step[j].predicted);
    expect(&sensor, &filter->step[j]);
  }
}

/* Nothing was measured: the prediction is all there is. */
static void skip($p_filter *filter) {
  for (int j = 0; j < $P_MODES; ++j) {
    filter->mode[j] = filter->step[j].predicted;
    filter->mode_probability[j] = filter->predicted_probability[j];
  }
  floor_probabilities(filter->mode_probability);
}

/* Takes a measurement in, of which something is there. Returns its log density. */
static $p_real take_in($p_filter *filter, const sensor_t *sensor) {
  for (int j = 0; j < $P_MODES; ++j) {
    $p_step_of_mode *m = &filter->step[j];
    if (sensor->missing > 0) expect(sensor, m);
    observe(sensor, m);
    correct(sensor, m, &filter->mode[j]);
  }
@ADAPT@  return bayes(filter);
}

/* Moments of what will be measured: C x and S of the predicted mixture. */
static void expected_measurement(const $p_filter *filter, $p_real *mean, $p_real *S) {
  for (int i = 0; i < $P_MEASUREMENTS; ++i) {
    mean[i] = 0;
    for (int j = 0; j < $P_MODES; ++j)
      for (int a = 0; a < $P_STATES; ++a)
        mean[i] += filter->predicted_probability[j] * bank_C[i][a] * filter->step[j].predicted.mean[a];
  }
  for (int i = 0; i < $P_MEASUREMENTS * $P_MEASUREMENTS; ++i) S[i] = 0;
  for (int j = 0; j < $P_MODES; ++j) {
    const $p_real weight = filter->predicted_probability[j];
    $p_real away[$P_MEASUREMENTS];
    for (int i = 0; i < $P_MEASUREMENTS; ++i) {
      away[i] = -mean[i];
      for (int a = 0; a < $P_STATES; ++a) away[i] += bank_C[i][a] * filter->step[j].predicted.mean[a];
    }
    for (int i = 0; i < $P_MEASUREMENTS; ++i)
      for (int k = 0; k < $P_MEASUREMENTS; ++k)
        S[i * $P_MEASUREMENTS + k] += weight * (filter->step[j].S[i][k] + away[i] * away[k]);
  }
}

static void fill_missing($p_real *values, int count) {
  for (int i = 0; i < count; ++i) values[i] = ($p_real)NAN;
}

/* Nothing is known. */
static void clear_estimate($p_estimate *estimate) {
  fill_missing(estimate->prediction, $P_STATES);
  fill_missing(estimate->innovation, $P_MEASUREMENTS);
  fill_missing(&estimate->innovation_covariance[0][0], $P_MEASUREMENTS * $P_MEASUREMENTS);
  fill_missing(estimate->state, $P_STATES);
  fill_missing(&estimate->covariance[0][0], $P_STATES * $P_STATES);
  for (int j = 0; j < $P_MODES; ++j)
    estimate->mode_probability_predicted[j] = estimate->mode_probability[j] = bank_initial_probability[j];
  estimate->log_density = ($p_real)NAN;
  estimate->steps = 0;
}

/* What was known before the measurement `y`. */
static void record_prediction(const $p_filter *filter, const $p_real *y, int steps, $p_estimate *estimate) {
  expected_measurement(filter, estimate->innovation, &estimate->innovation_covariance[0][0]);
  for (int i = 0; i < $P_MEASUREMENTS; ++i)
    estimate->innovation[i] = is_missing(y[i]) ? ($p_real)NAN : y[i] - estimate->innovation[i];
  for (int a = 0; a < $P_STATES; ++a) {
    estimate->prediction[a] = 0;
    for (int j = 0; j < $P_MODES; ++j)
      estimate->prediction[a] += filter->predicted_probability[j] * filter->step[j].predicted.mean[a];
  }
  for (int j = 0; j < $P_MODES; ++j) estimate->mode_probability_predicted[j] = filter->predicted_probability[j];
  estimate->steps = steps;
}

static void record_state(const $p_filter *filter, $p_estimate *estimate) {
  $p_gaussian merged;
  merge(filter->mode, filter->mode_probability, &merged);
  for (int a = 0; a < $P_STATES; ++a) {
    estimate->state[a] = merged.mean[a];
    for (int b = 0; b < $P_STATES; ++b) estimate->covariance[a][b] = merged.covariance[a][b];
  }
  for (int j = 0; j < $P_MODES; ++j) estimate->mode_probability[j] = filter->mode_probability[j];
}

/* From the newest measurements, all of them whole. */
static void start($p_filter *filter) {
  for (int j = 0; j < $P_MODES; ++j) {
    for (int a = 0; a < $P_STATES; ++a) {
      filter->mode[j].mean[a] = 0;
      for (int i = 0; i < $P_MEASUREMENTS * STATE_LAGS; ++i)
        filter->mode[j].mean[a] += bank_start_gain[a][i] * filter->measured[i / $P_MEASUREMENTS][i % $P_MEASUREMENTS];
      for (int b = 0; b < $P_STATES; ++b) filter->mode[j].covariance[a][b] = bank_start_covariance[a][b];
    }
    filter->mode_probability[j] = bank_initial_probability[j];
  }
  floor_probabilities(filter->mode_probability);
  filter->noise_scale = 1;
  filter->noise_samples = @PRIOR_SAMPLES@;
  filter->started = 1;
}

void $p_restart($p_filter *filter) {
  filter->started = filter->samples = filter->whole = 0;
  filter->time_s = 0;
  for (int i = 0; i < $P_INPUT_SAMPLES; ++i)
    for (int a = 0; a < $P_INPUT_ROOM; ++a) filter->recorded[i][a] = 0;
  for (int i = 0; i < $P_MEASURED_SAMPLES; ++i)
    for (int a = 0; a < $P_MEASUREMENTS; ++a) filter->measured[i][a] = 0;
}

/* A started filter and the sample that was pushed last. */
static void advance($p_filter *filter, const $p_real *measurement, int steps, $p_estimate *estimate) {
  sensor_t sensor;
  $p_real v[ACTING_ROOM], log_density = ($p_real)NAN;
  acting_inputs(filter, v);
  for (int i = 1; i < steps; ++i) {
    predict(filter, v);
    skip(filter);
  }
  predict(filter, v);
  if (estimate) record_prediction(filter, measurement, steps, estimate);
  make_sensor(measurement, &sensor);
  if (sensor.missing == $P_MEASUREMENTS)
    skip(filter);
  else
    log_density = take_in(filter, &sensor);
  if (estimate) estimate->log_density = log_density;
}

void $p_step($p_filter *filter, double time_s, const $p_real *input, const $p_real *measurement, $p_estimate *estimate) {
  const int steps = push(filter, time_s, input, measurement);
  if (steps > LONGEST_GAP) filter->started = 0;
  if (estimate) clear_estimate(estimate);
  if (filter->started) {
    advance(filter, measurement, steps, estimate);
  } else if (filter->samples > FIRST_STEP && filter->whole >= STATE_LAGS) {
    start(filter);
    for (int j = 0; estimate && j < $P_MODES; ++j)
      estimate->mode_probability_predicted[j] = filter->mode_probability[j];
  }
  if (estimate && filter->started) record_state(filter, estimate);
}

void $p_predict(const $p_filter *filter, $p_filter *ahead, int steps, const $p_real *input, $p_real *mean,
    $p_real *covariance) {
  *ahead = *filter;
  for (int k = 0; k < steps; ++k) {
    $p_real v[ACTING_ROOM], *S = covariance + k * $P_MEASUREMENTS * $P_MEASUREMENTS;
    push(ahead, NAN, input + k * $P_INPUTS, 0);
    acting_inputs(ahead, v);
    fill_missing(mean + k * $P_MEASUREMENTS, $P_MEASUREMENTS);
    fill_missing(S, $P_MEASUREMENTS * $P_MEASUREMENTS);
    if (!ahead->started) continue;
    predict(ahead, v);
    expected_measurement(ahead, mean + k * $P_MEASUREMENTS, S);
    skip(ahead);
  }
}
)c";

}  // namespace modebank::app::c_form
