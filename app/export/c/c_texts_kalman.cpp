#include "app/export/c/c_texts.hpp"

namespace modebank::app::c_form {

const char* const steps_repeat = R"c(/* ---- Samples ---- */

/* Model steps from one time to the next; without a clock one. */
static int steps_between(double from_s, double to_s) {
  const double periods = (to_s - from_s) / DT_S;
  if (!(to_s - from_s >= 1.25 * DT_S) || isnan(periods)) return 1;
  if (periods >= LONGEST_GAP + 1) return LONGEST_GAP + 1;
  return (int)(periods + 0.5);
}

)c";

const char* const steps_single = R"c(/* ---- Samples ---- */

/* The clock does not matter: every sample is one step. */
static int steps_between(double from_s, double to_s) {
  (void)from_s;
  (void)to_s;
  return 1;
}

)c";

const char* const samples_text = R"c(static int is_missing($p_real y) { return !(fabs$f(y) < LARGEST_MEASUREMENT); }

/* Takes a sample in; `measurement` null: none of it. Returns the model steps from the one before. */
static int push($p_filter *filter, double time_s, const $p_real *input, const $p_real *measurement) {
  const int steps = filter->samples == 0 ? 1 : steps_between(filter->time_s, time_s);
  int whole = 1;
  if (steps > LONGEST_GAP) filter->samples = filter->whole = 0;
  for (int i = $P_INPUT_SAMPLES - 1; i > 0; --i)
    for (int a = 0; a < $P_INPUTS; ++a) filter->recorded[i][a] = filter->recorded[i - 1][a];
  for (int a = 0; a < $P_INPUTS; ++a)
    if (isfinite(input[a])) filter->recorded[0][a] = input[a];
  for (int i = $P_MEASURED_SAMPLES - 1; i > 0; --i)
    for (int a = 0; a < $P_MEASUREMENTS; ++a) filter->measured[i][a] = filter->measured[i - 1][a];
  for (int a = 0; a < $P_MEASUREMENTS; ++a) {
    filter->measured[0][a] = measurement ? measurement[a] : ($p_real)NAN;
    if (is_missing(filter->measured[0][a])) whole = 0;
  }
  if (filter->samples <= FIRST_STEP) ++filter->samples;
  if (!whole) filter->whole = 0;
  if (whole && filter->whole < STATE_LAGS) ++filter->whole;
  filter->time_s = time_s;
  return steps;
}

/* The inputs that act on the step into the newest sample. */
static void acting_inputs(const $p_filter *filter, $p_real *v) {
  v[0] = 0;
  for (int a = 0; a < $P_ACTING_INPUTS; ++a)
    v[a] = filter->recorded[INPUT_DELAY + a / $P_INPUT_ROOM][a % $P_INPUT_ROOM];
}

)c";

const char* const algebra_text = R"c(/* ---- Small matrices ---- */

/* S = L D L', L with ones on its diagonal. A pivot that is rounding is raised. */
static void factorise(const $p_real S[$P_MEASUREMENTS][$P_MEASUREMENTS], $p_real L[$P_MEASUREMENTS][$P_MEASUREMENTS],
    $p_real D[$P_MEASUREMENTS]) {
  for (int j = 0; j < $P_MEASUREMENTS; ++j) {
    $p_real pivot = S[j][j];
    for (int k = 0; k < j; ++k) pivot -= L[j][k] * L[j][k] * D[k];
    D[j] = fmax$f(fmax$f(pivot, LEAST_PIVOT * fabs$f(S[j][j])), LEAST_VARIANCE);
    for (int i = j + 1; i < $P_MEASUREMENTS; ++i) {
      $p_real sum = S[i][j];
      for (int k = 0; k < j; ++k) sum -= L[i][k] * L[j][k] * D[k];
      L[i][j] = sum / D[j];
    }
  }
}

/* v := L^-1 v */
static void decorrelate($p_real L[$P_MEASUREMENTS][$P_MEASUREMENTS], $p_real *v) {
  for (int i = 1; i < $P_MEASUREMENTS; ++i)
    for (int k = 0; k < i; ++k) v[i] -= L[i][k] * v[k];
}

/* v := S^-1 v */
static void solve($p_real L[$P_MEASUREMENTS][$P_MEASUREMENTS], const $p_real *D, $p_real *v) {
  decorrelate(L, v);
  for (int i = $P_MEASUREMENTS - 1; i >= 0; --i) {
    v[i] /= D[i];
    for (int k = i + 1; k < $P_MEASUREMENTS; ++k) v[i] -= L[k][i] * v[k];
  }
}

/* Mean and covariance of a mixture. */
static void merge(const $p_gaussian *parts, const $p_real *weight, $p_gaussian *merged) {
  for (int a = 0; a < $P_STATES; ++a) {
    merged->mean[a] = 0;
    for (int i = 0; i < $P_MODES; ++i) merged->mean[a] += weight[i] * parts[i].mean[a];
  }
  for (int b = 0; b < $P_STATES; ++b)
    for (int a = b; a < $P_STATES; ++a) {
      $p_real sum = 0;
      for (int i = 0; i < $P_MODES; ++i)
        sum += weight[i] * (parts[i].covariance[a][b] +
                            (parts[i].mean[a] - merged->mean[a]) * (parts[i].mean[b] - merged->mean[b]));
      merged->covariance[a][b] = merged->covariance[b][a] = sum;
    }
}

)c";

const char* const input_term = "    for (int i = 0; i < $P_ACTING_INPUTS; ++i) sum += bank_B[j][a][i] * v[i];\n";

const char* const kalman_text = R"c(/* ---- One mode's Kalman filter ---- */

/* What is measured: C, R, y; a missing signal is one that is always zero, of variance one, unrelated to the others. */
typedef struct {
  $p_real C[$P_MEASUREMENTS][$P_STATES], R[$P_MEASUREMENTS][$P_MEASUREMENTS], y[$P_MEASUREMENTS];
  int missing;
} sensor_t;

/* `y` null: the sensor as it is when nothing is missing. */
static void make_sensor(const $p_real *y, sensor_t *sensor) {
  sensor->missing = 0;
  for (int i = 0; i < $P_MEASUREMENTS; ++i) {
    for (int a = 0; a < $P_STATES; ++a) sensor->C[i][a] = bank_C[i][a];
    for (int a = 0; a < $P_MEASUREMENTS; ++a) sensor->R[i][a] = bank_R[i][a];
    sensor->y[i] = y ? y[i] : 0;
  }
  for (int i = 0; y && i < $P_MEASUREMENTS; ++i) {
    if (!is_missing(y[i])) continue;
    for (int a = 0; a < $P_STATES; ++a) sensor->C[i][a] = 0;
    for (int a = 0; a < $P_MEASUREMENTS; ++a) sensor->R[i][a] = sensor->R[a][i] = 0;
    sensor->R[i][i] = 1;
    sensor->y[i] = 0;
    ++sensor->missing;
  }
}

/* Keeps a prediction usable: what diverges is scaled down, what rounding made indefinite loses its correlations. */
static void make_usable($p_gaussian *g) {
  $p_real largest = g->covariance[0][0], least = largest, mean = 0;
  for (int i = 0; i < $P_STATES; ++i) {
    largest = fmax$f(largest, g->covariance[i][i]);
    least = fmin$f(least, g->covariance[i][i]);
    mean = fmax$f(mean, fabs$f(g->mean[i]));
  }
  if (least < 0) {
    for (int i = 0; i < $P_STATES; ++i)
      for (int k = 0; k < $P_STATES; ++k) g->covariance[i][k] = i == k ? fabs$f(g->covariance[i][i]) : 0;
    largest = fmax$f(largest, -least);
  }
  for (int i = 0; largest > LARGEST_VARIANCE && i < $P_STATES; ++i)
    for (int k = 0; k < $P_STATES; ++k) g->covariance[i][k] *= LARGEST_VARIANCE / largest;
  for (int i = 0; mean > LARGEST_MEAN && i < $P_STATES; ++i) g->mean[i] *= LARGEST_MEAN / mean;
}

/* x := A x + B v + c, P := A P A' + noise_scale Q, of mode j. */
static void predict_mode(const $p_gaussian *from, int j, const $p_real *v, $p_real noise_scale, $p_gaussian *to) {
  $p_real AP[$P_STATES][$P_STATES];
@NO_INPUT@  for (int a = 0; a < $P_STATES; ++a) {
    $p_real sum = bank_c[j][a];
    for (int i = 0; i < $P_STATES; ++i) sum += bank_A[j][a][i] * from->mean[i];
@INPUT_TERM@    to->mean[a] = sum;
    for (int b = 0; b < $P_STATES; ++b) {
      AP[a][b] = 0;
      for (int i = 0; i < $P_STATES; ++i) AP[a][b] += bank_A[j][a][i] * from->covariance[i][b];
    }
  }
  for (int b = 0; b < $P_STATES; ++b)
    for (int a = b; a < $P_STATES; ++a) {
      $p_real sum = noise_scale * bank_Q[j][a][b];
      for (int i = 0; i < $P_STATES; ++i) sum += AP[a][i] * bank_A[j][b][i];
      to->covariance[a][b] = to->covariance[b][a] = sum;
    }
  make_usable(to);
}

/* S = C P C' + R and its factor; P C' in gain. */
static void expect(const sensor_t *sensor, $p_step_of_mode *m) {
  for (int a = 0; a < $P_STATES; ++a)
    for (int i = 0; i < $P_MEASUREMENTS; ++i) {
      m->gain[a][i] = 0;
      for (int b = 0; b < $P_STATES; ++b) m->gain[a][i] += m->predicted.covariance[a][b] * sensor->C[i][b];
    }
  for (int k = 0; k < $P_MEASUREMENTS; ++k)
    for (int i = k; i < $P_MEASUREMENTS; ++i) {
      $p_real sum = sensor->R[i][k];
      for (int a = 0; a < $P_STATES; ++a) sum += sensor->C[i][a] * m->gain[a][k];
      m->S[i][k] = m->S[k][i] = sum;
    }
  factorise((const $p_real (*)[$P_MEASUREMENTS])m->S, m->L, m->D);
}

/* The innovation and its log density, of the signals that are there. */
static void observe(const sensor_t *sensor, $p_step_of_mode *m) {
  const $p_real log_two_pi = 1.8378770664093454836$F;
  $p_real sum = (($p_real)($P_MEASUREMENTS - sensor->missing)) * log_two_pi;
  for (int i = 0; i < $P_MEASUREMENTS; ++i) {
    m->innovation[i] = sensor->y[i];
    for (int a = 0; a < $P_STATES; ++a) m->innovation[i] -= sensor->C[i][a] * m->predicted.mean[a];
    m->decorrelated[i] = m->innovation[i];
  }
  decorrelate(m->L, m->decorrelated);
  for (int i = 0; i < $P_MEASUREMENTS; ++i) sum += log$f(m->D[i]) + m->decorrelated[i] * m->decorrelated[i] / m->D[i];
  m->log_likelihood = -0.5$F * sum > LOWEST_LOG_DENSITY ? -0.5$F * sum : LOWEST_LOG_DENSITY;
}

/* An overflowing correction is no information; a measurement never enlarges a variance. */
static void keep_sound(const $p_gaussian *predicted, $p_gaussian *posterior) {
  $p_real sum = 0;
  int sound = 1;
  for (int i = 0; i < $P_STATES; ++i) {
    sum += posterior->mean[i];
    for (int k = 0; k < $P_STATES; ++k) sum += posterior->covariance[i][k];
  }
  if (!isfinite(sum)) *posterior = *predicted;
  for (int i = 0; i < $P_STATES; ++i) sound = sound && posterior->covariance[i][i] >= 0;
  for (int i = 0; !sound && i < $P_STATES; ++i)
    for (int k = 0; k < $P_STATES; ++k)
      posterior->covariance[i][k] =
          i == k ? fmin$f(fmax$f(posterior->covariance[i][i], 0), fmax$f(predicted->covariance[i][i], 0)) : 0;
}

/* The state after the measurement, its covariance in Joseph's form. */
static void correct(const sensor_t *sensor, $p_step_of_mode *m, $p_gaussian *posterior) {
  $p_real rest[$P_STATES][$P_STATES], restP[$P_STATES][$P_STATES];
  for (int a = 0; a < $P_STATES; ++a) {
    solve(m->L, m->D, m->gain[a]);
    posterior->mean[a] = m->predicted.mean[a];
    for (int i = 0; i < $P_MEASUREMENTS; ++i) posterior->mean[a] += m->gain[a][i] * m->innovation[i];
    for (int b = 0; b < $P_STATES; ++b) {
      rest[a][b] = a == b ? 1 : 0;
      for (int i = 0; i < $P_MEASUREMENTS; ++i) rest[a][b] -= m->gain[a][i] * sensor->C[i][b];
    }
    for (int b = 0; b < $P_STATES; ++b) {
      restP[a][b] = 0;
      for (int i = 0; i < $P_STATES; ++i) restP[a][b] += rest[a][i] * m->predicted.covariance[i][b];
    }
  }
  for (int b = 0; b < $P_STATES; ++b)
    for (int a = b; a < $P_STATES; ++a) {
      $p_real sum = 0;
      for (int i = 0; i < $P_STATES; ++i) sum += restP[a][i] * rest[b][i];
      for (int i = 0; i < $P_MEASUREMENTS; ++i)
        for (int k = 0; k < $P_MEASUREMENTS; ++k) sum += m->gain[a][i] * sensor->R[i][k] * m->gain[b][k];
      posterior->covariance[a][b] = posterior->covariance[b][a] = sum;
    }
  keep_sound(&m->predicted, posterior);
}

)c";

}  // namespace modebank::app::c_form
