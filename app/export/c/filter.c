/* The functions of filter.h: filter/step's equations in C, function by function. tests/app/export/c_filter_test.cpp
 * compares the two. Global names begin with "modebank", which the prefix of NAME.c replaces. So static names must not
 * end in _MODES, _STATES, _INPUTS, _MEASUREMENTS, _filter, _estimate or _step. */
#include "filter.h"

#include <math.h>

enum {
  MODES = MODEBANK_MODES,
  STATES = MODEBANK_STATES,
  MEASUREMENTS = MODEBANK_MEASUREMENTS,
  ACTING = MODEBANK_ACTING_INPUTS,
  ACTING_ROOM = MODEBANK_ACTING_INPUTS > 0 ? MODEBANK_ACTING_INPUTS : 1,
  STATE_LAGS = MODEBANK_KEPT_MEASUREMENTS,
  LONGEST_GAP = 50 /* steps without a sample; after more the filter starts anew */
};

#include "bank_numbers.h"

/* Bounds that keep the arithmetic valid. */
#define LARGEST_VARIANCE 1e60       /* a diverging prediction stops growing here */
#define LARGEST_MEAN 1e30           /* and here */
#define LEAST_VARIANCE 1e-40        /* of a measurement */
#define IMPOSSIBLE 1e-100           /* a mode of lower probability takes no part */
#define LEAST_PROBABILITY 1e-12     /* no mode dies for good */
#define LOWEST_LOG_DENSITY (-1e300) /* lower ones are not told apart [nats] */
#define LARGEST_MEASUREMENT 1e30    /* one that is not smaller counts as missing */
#define LEAST_PIVOT 1e-14           /* share of a diagonal entry that is rounding */
#define LARGEST_SQUARE 1e300        /* larger than any that counts */
#define LEAST_LOG_ODDS (-200.0)     /* further odds are as good as certain */

/* ---- Samples ---- */

/* Number of model steps between two times. Without a clock (bank_dt_s = 0) every sample is one step. A time that goes
 * back is a new start. */
static int steps_between(double from_s, double to_s) {
  const double periods = (to_s - from_s) / bank_dt_s;
  if (to_s < from_s) return LONGEST_GAP + 1;
  if (!(bank_dt_s > 0) || !(to_s - from_s >= 1.25 * bank_dt_s) || isnan(periods)) return 1;
  if (periods >= LONGEST_GAP + 1) return LONGEST_GAP + 1;
  return (int)(periods + 0.5);
}

static int is_missing(double y) { return !(fabs(y) < LARGEST_MEASUREMENT); }

/* Stores a sample; `measurement` null: nothing was measured. Returns the model steps since the last sample. */
static int push(modebank_filter* filter, double time_s, const double* input, const double* measurement) {
  const int steps = filter->samples == 0 ? 1 : steps_between(filter->time_s, time_s);
  int whole = 1;
  if (steps > LONGEST_GAP) filter->samples = filter->whole = 0;
  for (int i = MODEBANK_KEPT_INPUTS - 1; i > 0; --i)
    for (int a = 0; a < MODEBANK_INPUTS; ++a) filter->recorded[i][a] = filter->recorded[i - 1][a];
  for (int a = 0; a < MODEBANK_INPUTS; ++a)
    if (isfinite(input[a])) filter->recorded[0][a] = input[a];
  for (int i = STATE_LAGS - 1; i > 0; --i)
    for (int a = 0; a < MEASUREMENTS; ++a) filter->measured[i][a] = filter->measured[i - 1][a];
  for (int a = 0; a < MEASUREMENTS; ++a) {
    filter->measured[0][a] = measurement ? measurement[a] : NAN;
    if (is_missing(filter->measured[0][a])) whole = 0;
  }
  if (filter->samples <= FIRST_TRANSITION) ++filter->samples;
  if (!whole) filter->whole = 0;
  if (whole && filter->whole < STATE_LAGS) ++filter->whole;
  filter->time_s = time_s;
  return steps;
}

/* The inputs that act on the step into the newest sample. */
static void acting_inputs(const modebank_filter* filter, double* v) {
  v[0] = 0;
  for (int a = 0; a < ACTING; ++a)
    v[a] = filter->recorded[bank_input_delay[a % MODEBANK_ROOM_FOR_INPUTS] + a / MODEBANK_ROOM_FOR_INPUTS]
                           [a % MODEBANK_ROOM_FOR_INPUTS];
}

/* ---- Small matrices ---- */

/* S = L D L', L with ones on its diagonal. Raises pivots that are only rounding errors. */
static void factorise(modebank_step_of_mode* m) {
  for (int j = 0; j < MEASUREMENTS; ++j) {
    double pivot = m->S[j][j];
    for (int k = 0; k < j; ++k) pivot -= m->L[j][k] * m->L[j][k] * m->D[k];
    m->D[j] = fmax(fmax(pivot, LEAST_PIVOT * fabs(m->S[j][j])), LEAST_VARIANCE);
    for (int i = j + 1; i < MEASUREMENTS; ++i) {
      double sum = m->S[i][j];
      for (int k = 0; k < j; ++k) sum -= m->L[i][k] * m->L[j][k] * m->D[k];
      m->L[i][j] = sum / m->D[j];
    }
  }
}

/* v := L^-1 v */
static void decorrelate(const modebank_step_of_mode* m, double* v) {
  for (int i = 1; i < MEASUREMENTS; ++i)
    for (int k = 0; k < i; ++k) v[i] -= m->L[i][k] * v[k];
}

/* v := S^-1 v */
static void solve(const modebank_step_of_mode* m, double* v) {
  decorrelate(m, v);
  for (int i = MEASUREMENTS - 1; i >= 0; --i) {
    v[i] /= m->D[i];
    for (int k = i + 1; k < MEASUREMENTS; ++k) v[i] -= m->L[k][i] * v[k];
  }
}

/* Mean and covariance of a mixture. */
static void merge(const modebank_gaussian* parts, const double* weight, modebank_gaussian* merged) {
  for (int a = 0; a < STATES; ++a) {
    merged->mean[a] = 0;
    for (int i = 0; i < MODES; ++i) merged->mean[a] += weight[i] * parts[i].mean[a];
  }
  for (int b = 0; b < STATES; ++b)
    for (int a = b; a < STATES; ++a) {
      double sum = 0;
      for (int i = 0; i < MODES; ++i)
        sum += weight[i] * (parts[i].covariance[a][b] +
                            (parts[i].mean[a] - merged->mean[a]) * (parts[i].mean[b] - merged->mean[b]));
      merged->covariance[a][b] = merged->covariance[b][a] = sum;
    }
}

/* ---- One mode's Kalman filter ---- */

/* Measurement y = C x + v, v ~ N(0, R). A missing signal is zero with variance one, and independent of the others. */
typedef struct {
  double C[MEASUREMENTS][STATES], R[MEASUREMENTS][MEASUREMENTS];
  double y[MEASUREMENTS];
  int missing;
} sensor_t;

/* `y` null: a sensor without missing signals. */
static void make_sensor(const double* y, sensor_t* sensor) {
  sensor->missing = 0;
  for (int i = 0; i < MEASUREMENTS; ++i) {
    for (int a = 0; a < STATES; ++a) sensor->C[i][a] = bank_C[i][a];
    for (int a = 0; a < MEASUREMENTS; ++a) sensor->R[i][a] = bank_R[i][a];
    sensor->y[i] = y ? y[i] : 0;
  }
  for (int i = 0; y && i < MEASUREMENTS; ++i) {
    if (!is_missing(y[i])) continue;
    for (int a = 0; a < STATES; ++a) sensor->C[i][a] = 0;
    for (int a = 0; a < MEASUREMENTS; ++a) sensor->R[i][a] = sensor->R[a][i] = 0;
    sensor->R[i][i] = 1;
    sensor->y[i] = 0;
    ++sensor->missing;
  }
}

/* Keeps a prediction usable. A diverging one is scaled down; one that is indefinite by rounding loses its correlations.
 */
static void make_usable(modebank_gaussian* g) {
  double largest = g->covariance[0][0], least = largest, mean = 0;
  for (int i = 0; i < STATES; ++i) {
    largest = fmax(largest, g->covariance[i][i]);
    least = fmin(least, g->covariance[i][i]);
    mean = fmax(mean, fabs(g->mean[i]));
  }
  if (least < 0) {
    for (int i = 0; i < STATES; ++i)
      for (int k = 0; k < STATES; ++k) g->covariance[i][k] = i == k ? fabs(g->covariance[i][i]) : 0;
    largest = fmax(largest, -least);
  }
  for (int i = 0; largest > LARGEST_VARIANCE && i < STATES; ++i)
    for (int k = 0; k < STATES; ++k) g->covariance[i][k] *= LARGEST_VARIANCE / largest;
  for (int i = 0; mean > LARGEST_MEAN && i < STATES; ++i) g->mean[i] *= LARGEST_MEAN / mean;
}

/* x := A x + B v + c, P := A P A' + Q, of mode j. */
static void predict_mode(const modebank_gaussian* from, int j, const double* v,
                         modebank_gaussian* to) {
  double AP[STATES][STATES];
  for (int a = 0; a < STATES; ++a) {
    double sum = bank_c[j][a];
    for (int i = 0; i < STATES; ++i) sum += bank_A[j][a][i] * from->mean[i];
    for (int i = 0; i < ACTING; ++i) sum += bank_B[j][a][i] * v[i];
    to->mean[a] = sum;
    for (int b = 0; b < STATES; ++b) {
      AP[a][b] = 0;
      for (int i = 0; i < STATES; ++i) AP[a][b] += bank_A[j][a][i] * from->covariance[i][b];
    }
  }
  for (int b = 0; b < STATES; ++b)
    for (int a = b; a < STATES; ++a) {
      double sum = bank_Q[j][a][b];
      for (int i = 0; i < STATES; ++i) sum += AP[a][i] * bank_A[j][b][i];
      to->covariance[a][b] = to->covariance[b][a] = sum;
    }
  make_usable(to);
}

/* S = C P C' + R and its factor; P C' in gain. */
static void expect(const sensor_t* sensor, modebank_step_of_mode* m) {
  for (int a = 0; a < STATES; ++a)
    for (int i = 0; i < MEASUREMENTS; ++i) {
      m->gain[a][i] = 0;
      for (int b = 0; b < STATES; ++b) m->gain[a][i] += m->predicted.covariance[a][b] * sensor->C[i][b];
    }
  for (int k = 0; k < MEASUREMENTS; ++k)
    for (int i = k; i < MEASUREMENTS; ++i) {
      double sum = sensor->R[i][k];
      for (int a = 0; a < STATES; ++a) sum += sensor->C[i][a] * m->gain[a][k];
      m->S[i][k] = m->S[k][i] = sum;
    }
  factorise(m);
}

/* The innovation and its log density, for the measured signals. */
static void observe(const sensor_t* sensor, modebank_step_of_mode* m) {
  const double log_two_pi = 1.8378770664093454836;
  double sum = (MEASUREMENTS - sensor->missing) * log_two_pi;
  for (int i = 0; i < MEASUREMENTS; ++i) {
    m->innovation[i] = sensor->y[i];
    for (int a = 0; a < STATES; ++a) m->innovation[i] -= sensor->C[i][a] * m->predicted.mean[a];
    m->decorrelated[i] = m->innovation[i];
  }
  decorrelate(m, m->decorrelated);
  for (int i = 0; i < MEASUREMENTS; ++i) sum += log(m->D[i]) + m->decorrelated[i] * m->decorrelated[i] / m->D[i];
  m->log_likelihood = -0.5 * sum > LOWEST_LOG_DENSITY ? -0.5 * sum : LOWEST_LOG_DENSITY;
}

/* An overflowing correction is skipped, and a measurement never enlarges a variance. */
static void keep_sound(const modebank_gaussian* predicted, modebank_gaussian* posterior) {
  double sum = 0;
  int sound = 1;
  for (int i = 0; i < STATES; ++i) {
    sum += posterior->mean[i];
    for (int k = 0; k < STATES; ++k) sum += posterior->covariance[i][k];
  }
  if (!isfinite(sum)) *posterior = *predicted;
  for (int i = 0; i < STATES; ++i) sound = sound && posterior->covariance[i][i] >= 0;
  for (int i = 0; !sound && i < STATES; ++i)
    for (int k = 0; k < STATES; ++k)
      posterior->covariance[i][k] =
          i == k ? fmin(fmax(posterior->covariance[i][i], 0), fmax(predicted->covariance[i][i], 0)) : 0;
}

/* The state after the measurement, its covariance in Joseph's form. */
static void correct(const sensor_t* sensor, modebank_step_of_mode* m, modebank_gaussian* posterior) {
  double rest[STATES][STATES], restP[STATES][STATES];
  for (int a = 0; a < STATES; ++a) {
    solve(m, m->gain[a]);
    posterior->mean[a] = m->predicted.mean[a];
    for (int i = 0; i < MEASUREMENTS; ++i) posterior->mean[a] += m->gain[a][i] * m->innovation[i];
    for (int b = 0; b < STATES; ++b) {
      rest[a][b] = a == b ? 1 : 0;
      for (int i = 0; i < MEASUREMENTS; ++i) rest[a][b] -= m->gain[a][i] * sensor->C[i][b];
    }
    for (int b = 0; b < STATES; ++b) {
      restP[a][b] = 0;
      for (int i = 0; i < STATES; ++i) restP[a][b] += rest[a][i] * m->predicted.covariance[i][b];
    }
  }
  for (int b = 0; b < STATES; ++b)
    for (int a = b; a < STATES; ++a) {
      double sum = 0;
      for (int i = 0; i < STATES; ++i) sum += restP[a][i] * rest[b][i];
      for (int i = 0; i < MEASUREMENTS; ++i)
        for (int k = 0; k < MEASUREMENTS; ++k) sum += m->gain[a][i] * sensor->R[i][k] * m->gain[b][k];
      posterior->covariance[a][b] = posterior->covariance[b][a] = sum;
    }
  keep_sound(&m->predicted, posterior);
}

/* ---- Modes ---- */

/* The transition probabilities of a step from the mean state with inputs v; T itself where these are unknown. */
static void transition_at(const modebank_filter* filter, const double* v, double T[MODES][MODES]) {
  double x[STATES], factor[MODES], largest = -LARGEST_SQUARE;
  int known = 1;
  for (int a = 0; a < STATES; ++a) {
    x[a] = 0;
    for (int i = 0; i < MODES; ++i) x[a] += filter->mode_probability[i] * filter->mode[i].mean[a];
  }
  for (int j = 0; j < MODES; ++j) {
    factor[j] = 0;
    for (int a = 0; a < STATES; ++a) factor[j] += bank_logit_weight[j][a] * (x[a] - bank_logit_reference[a]);
    for (int a = 0; a < ACTING; ++a)
      factor[j] += bank_logit_weight[j][STATES + a] * (v[a] - bank_logit_reference[STATES + a]);
    known = known && isfinite(factor[j]);
    largest = fmax(largest, factor[j]);
  }
  for (int j = 0; j < MODES; ++j) factor[j] = known ? exp(fmax(factor[j] - largest, LEAST_LOG_ODDS)) : 1;
  for (int i = 0; i < MODES; ++i) {
    double sum = 0;
    for (int j = 0; j < MODES; ++j) sum += T[i][j] = bank_T[i][j] * factor[j];
    for (int j = 0; j < MODES; ++j) T[i][j] = known ? T[i][j] / sum : bank_T[i][j];
  }
}

/* Each mode's probability after the step, and the share of mode i in its start: weight[j][i]. A mode that no other mode
 * can enter keeps its own state. */
static void mixing_weights(modebank_filter* filter, const double* v, double weight[MODES][MODES]) {
  double T[MODES][MODES];
  if (TRANSITION_BY_STATE) transition_at(filter, v, T);
  for (int j = 0; j < MODES; ++j) {
    double sum = 0;
    for (int i = 0; i < MODES; ++i)
      sum += weight[j][i] = (TRANSITION_BY_STATE ? T[i][j] : bank_T[i][j]) * filter->mode_probability[i];
    filter->predicted_probability[j] = sum;
    for (int i = 0; i < MODES; ++i) {
      if (sum < IMPOSSIBLE)
        weight[j][i] = i == j ? 1 : 0;
      else
        weight[j][i] /= sum;
    }
  }
}

/* Interacting multiple models: every mode starts from its mixture (Blom and Bar-Shalom 1988). */
static const modebank_gaussian* mix(modebank_filter* filter, const double* v) {
  double weight[MODES][MODES];
  if (MODES == 1) {
    filter->predicted_probability[0] = filter->mode_probability[0];
    return filter->mode;
  }
  mixing_weights(filter, v, weight);
  for (int j = 0; j < MODES; ++j) merge(filter->mode, weight[j], &filter->mixed[j]);
  return filter->mixed;
}

/* Modes' probabilities are kept above a floor, then normalised. */
static void floor_probabilities(double* mu) {
  double sum = 0;
  for (int j = 0; j < MODES; ++j) sum += mu[j] = fmax(mu[j], LEAST_PROBABILITY);
  for (int j = 0; j < MODES; ++j) mu[j] /= sum;
}

/* Bayes' rule without its denominator. Likelihoods are divided by the largest one, whose logarithm is returned. */
static double likelihood_weights(const modebank_filter* filter, double* weight) {
  double largest = LOWEST_LOG_DENSITY;
  int found = 0;
  for (int j = 0; j < MODES; ++j)
    if (filter->predicted_probability[j] >= IMPOSSIBLE && (!found || filter->step[j].log_likelihood > largest)) {
      largest = filter->step[j].log_likelihood;
      found = 1;
    }
  for (int j = 0; j < MODES; ++j)
    weight[j] = filter->predicted_probability[j] >= IMPOSSIBLE
                    ? filter->predicted_probability[j] * exp(filter->step[j].log_likelihood - largest)
                    : 0;
  return largest;
}

/* Returns the log density of the measurement. */
static double bayes(modebank_filter* filter) {
  double sum = 0;
  const double largest = likelihood_weights(filter, filter->mode_probability);
  for (int j = 0; j < MODES; ++j) sum += filter->mode_probability[j];
  for (int j = 0; j < MODES; ++j) filter->mode_probability[j] /= sum;
  floor_probabilities(filter->mode_probability);
  return largest + log(sum);
}

/* ---- The filter ---- */

static void predict(modebank_filter* filter, const double* v) {
  sensor_t sensor;
  const modebank_gaussian* from = mix(filter, v);
  make_sensor(0, &sensor);
  for (int j = 0; j < MODES; ++j) {
    predict_mode(&from[j], j, v, &filter->step[j].predicted);
    expect(&sensor, &filter->step[j]);
  }
}

/* Without a measurement the prediction becomes the estimate. */
static void skip(modebank_filter* filter) {
  for (int j = 0; j < MODES; ++j) {
    filter->mode[j] = filter->step[j].predicted;
    filter->mode_probability[j] = filter->predicted_probability[j];
  }
  floor_probabilities(filter->mode_probability);
}

/* Updates the filter by a measurement with at least one signal. Returns its log density. */
static double take_in(modebank_filter* filter, const sensor_t* sensor) {
  for (int j = 0; j < MODES; ++j) {
    modebank_step_of_mode* m = &filter->step[j];
    if (sensor->missing > 0) expect(sensor, m);
    observe(sensor, m);
    correct(sensor, m, &filter->mode[j]);
  }
  return bayes(filter);
}

/* Mean C x and covariance S of the measurement that the mixture predicts. */
static void expected_measurement(const modebank_filter* filter, double* mean, double* S) {
  for (int i = 0; i < MEASUREMENTS; ++i) {
    mean[i] = 0;
    for (int j = 0; j < MODES; ++j)
      for (int a = 0; a < STATES; ++a)
        mean[i] += filter->predicted_probability[j] * bank_C[i][a] * filter->step[j].predicted.mean[a];
  }
  for (int i = 0; i < MEASUREMENTS * MEASUREMENTS; ++i) S[i] = 0;
  for (int j = 0; j < MODES; ++j) {
    const double weight = filter->predicted_probability[j];
    double away[MEASUREMENTS];
    for (int i = 0; i < MEASUREMENTS; ++i) {
      away[i] = -mean[i];
      for (int a = 0; a < STATES; ++a) away[i] += bank_C[i][a] * filter->step[j].predicted.mean[a];
    }
    for (int i = 0; i < MEASUREMENTS; ++i)
      for (int k = 0; k < MEASUREMENTS; ++k)
        S[i * MEASUREMENTS + k] += weight * (filter->step[j].S[i][k] + away[i] * away[k]);
  }
}

static void fill_missing(double* values, int count) {
  for (int i = 0; i < count; ++i) values[i] = NAN;
}

/* The estimate of a filter that has not started. */
static void record_nothing(modebank_estimate* estimate) {
  fill_missing(estimate->prediction, STATES);
  fill_missing(estimate->innovation, MEASUREMENTS);
  fill_missing(&estimate->innovation_covariance[0][0], MEASUREMENTS * MEASUREMENTS);
  fill_missing(estimate->state, STATES);
  fill_missing(&estimate->covariance[0][0], STATES * STATES);
  for (int j = 0; j < MODES; ++j)
    estimate->mode_probability_predicted[j] = estimate->mode_probability[j] = bank_initial_probability[j];
  estimate->log_density = NAN;
  estimate->steps = 0;
}

/* The estimate before the measurement `y`, and the innovation. */
static void record_prediction(const modebank_filter* filter, const double* y, int steps, modebank_estimate* estimate) {
  expected_measurement(filter, estimate->innovation, &estimate->innovation_covariance[0][0]);
  for (int i = 0; i < MEASUREMENTS; ++i)
    estimate->innovation[i] = is_missing(y[i]) ? NAN : y[i] - estimate->innovation[i];
  for (int a = 0; a < STATES; ++a) {
    estimate->prediction[a] = 0;
    for (int j = 0; j < MODES; ++j)
      estimate->prediction[a] += filter->predicted_probability[j] * filter->step[j].predicted.mean[a];
  }
  for (int j = 0; j < MODES; ++j) estimate->mode_probability_predicted[j] = filter->predicted_probability[j];
  estimate->steps = steps;
}

static void record_state(const modebank_filter* filter, modebank_estimate* estimate) {
  modebank_gaussian merged;
  merge(filter->mode, filter->mode_probability, &merged);
  for (int a = 0; a < STATES; ++a) {
    estimate->state[a] = merged.mean[a];
    for (int b = 0; b < STATES; ++b) estimate->covariance[a][b] = merged.covariance[a][b];
  }
  for (int j = 0; j < MODES; ++j) estimate->mode_probability[j] = filter->mode_probability[j];
}

/* Starts from the newest measurements, all of which are complete. */
static void start(modebank_filter* filter) {
  for (int j = 0; j < MODES; ++j) {
    for (int a = 0; a < STATES; ++a) {
      filter->mode[j].mean[a] = 0;
      for (int i = 0; i < MEASUREMENTS * STATE_LAGS; ++i)
        filter->mode[j].mean[a] += bank_start_gain[a][i] * filter->measured[i / MEASUREMENTS][i % MEASUREMENTS];
      for (int b = 0; b < STATES; ++b) filter->mode[j].covariance[a][b] = bank_start_covariance[a][b];
    }
    filter->mode_probability[j] = bank_initial_probability[j];
  }
  floor_probabilities(filter->mode_probability);
  filter->started = 1;
}

void modebank_restart(modebank_filter* filter) {
  filter->started = filter->samples = filter->whole = 0;
  filter->time_s = 0;
  for (int i = 0; i < MODEBANK_KEPT_INPUTS; ++i)
    for (int a = 0; a < MODEBANK_ROOM_FOR_INPUTS; ++a) filter->recorded[i][a] = 0;
  for (int i = 0; i < STATE_LAGS; ++i)
    for (int a = 0; a < MEASUREMENTS; ++a) filter->measured[i][a] = 0;
}

/* A step of a started filter to the newest stored sample. */
static void advance(modebank_filter* filter, const double* measurement, int steps, modebank_estimate* estimate) {
  sensor_t sensor;
  double v[ACTING_ROOM], log_density = NAN;
  acting_inputs(filter, v);
  for (int i = 1; i < steps; ++i) {
    predict(filter, v);
    skip(filter);
  }
  predict(filter, v);
  if (estimate) record_prediction(filter, measurement, steps, estimate);
  make_sensor(measurement, &sensor);
  if (sensor.missing == MEASUREMENTS)
    skip(filter);
  else
    log_density = take_in(filter, &sensor);
  if (estimate) estimate->log_density = log_density;
}

void modebank_step(modebank_filter* filter, double time_s, const double* input, const double* measurement,
                   modebank_estimate* estimate) {
  const int steps = push(filter, time_s, input, measurement);
  if (steps > LONGEST_GAP) filter->started = 0;
  if (estimate) record_nothing(estimate);
  if (filter->started) {
    advance(filter, measurement, steps, estimate);
  } else if (filter->samples > FIRST_TRANSITION && filter->whole >= STATE_LAGS) {
    start(filter);
    for (int j = 0; estimate && j < MODES; ++j) estimate->mode_probability_predicted[j] = filter->mode_probability[j];
  }
  if (estimate && filter->started) record_state(filter, estimate);
}

void modebank_predict(const modebank_filter* filter, modebank_filter* ahead, int steps, const double* input,
                      double* mean, double* covariance) {
  *ahead = *filter;
  for (int k = 0; k < steps; ++k) {
    double v[ACTING_ROOM], *S = covariance + k * MEASUREMENTS * MEASUREMENTS;
    push(ahead, NAN, input + k * MODEBANK_INPUTS, 0);
    acting_inputs(ahead, v);
    fill_missing(mean + k * MEASUREMENTS, MEASUREMENTS);
    fill_missing(S, MEASUREMENTS * MEASUREMENTS);
    if (!ahead->started) continue;
    predict(ahead, v);
    expected_measurement(ahead, mean + k * MEASUREMENTS, S);
    skip(ahead);
  }
}
