#include "app/export/c/c_texts.hpp"

namespace modebank::app::c_form {

const char* const transition_at = R"c(/* ---- Modes ---- */

/* The transition probabilities of a step from x under v; T itself where these are not known. */
static void transition_at(const $p_real *x, const $p_real *v, $p_real T[$P_MODES][$P_MODES]) {
  $p_real factor[$P_MODES], largest = -LARGEST_SQUARE;
  int known = 1;
  for (int j = 0; j < $P_MODES; ++j) {
    factor[j] = 0;
    for (int a = 0; a < $P_STATES; ++a) factor[j] += bank_logit_weight[j][a] * (x[a] - bank_logit_reference[a]);
    for (int a = 0; a < $P_ACTING_INPUTS; ++a)
      factor[j] += bank_logit_weight[j][$P_STATES + a] * (v[a] - bank_logit_reference[$P_STATES + a]);
    known = known && isfinite(factor[j]);
    largest = fmax$f(largest, factor[j]);
  }
  for (int j = 0; j < $P_MODES; ++j) factor[j] = known ? exp$f(fmax$f(factor[j] - largest, LEAST_LOG_ODDS)) : 1;
  for (int i = 0; i < $P_MODES; ++i) {
    $p_real sum = 0;
    for (int j = 0; j < $P_MODES; ++j) sum += T[i][j] = bank_T[i][j] * factor[j];
    for (int j = 0; j < $P_MODES; ++j) T[i][j] = known ? T[i][j] / sum : bank_T[i][j];
  }
}

)c";

const char* const with_logit = R"c(  $p_real T[$P_MODES][$P_MODES], x[$P_STATES];
  for (int a = 0; a < $P_STATES; ++a) {
    x[a] = 0;
    for (int i = 0; i < $P_MODES; ++i) x[a] += filter->mode_probability[i] * filter->mode[i].mean[a];
  }
  transition_at(x, v, T);
)c";

const char* const no_mixing = R"c(/* ---- Modes ---- */

/* Every mode goes on from where it is. */
static const $p_gaussian *mix($p_filter *filter, const $p_real *v) {
  (void)v;
  for (int j = 0; j < $P_MODES; ++j) filter->predicted_probability[j] = filter->mode_probability[j];
  return filter->mode;
}

)c";

const char* const mixing_weights =
    R"c(/* How probable each mode is after the step, and what mode i contributes to its start: weight[j][i]. A mode that cannot
 * be entered keeps its own state. */
static void mixing_weights($p_filter *filter, const $p_real *v, $p_real weight[$P_MODES][$P_MODES]) {
@TRANSITION@  (void)v;
  for (int j = 0; j < $P_MODES; ++j) {
    $p_real sum = 0;
    for (int i = 0; i < $P_MODES; ++i) sum += weight[j][i] = @T@[i][j] * filter->mode_probability[i];
    filter->predicted_probability[j] = sum;
    for (int i = 0; i < $P_MODES; ++i) {
      if (sum < IMPOSSIBLE)
        weight[j][i] = i == j ? 1 : 0;
      else
        weight[j][i] /= sum;
    }
  }
}

)c";

const char* const mix_imm =
    R"c(/* Interacting multiple models: every mode starts from its mixture (Blom and Bar-Shalom 1988). */
static const $p_gaussian *mix($p_filter *filter, const $p_real *v) {
  $p_real weight[$P_MODES][$P_MODES];
  mixing_weights(filter, v, weight);
  for (int j = 0; j < $P_MODES; ++j) merge(filter->mode, weight[j], &filter->mixed[j]);
  return filter->mixed;
}

)c";

const char* const probabilities_text = R"c(/* Modes' probabilities are kept above a floor, then normalised. */
static void floor_probabilities($p_real *mu) {
  $p_real sum = 0;
  for (int j = 0; j < $P_MODES; ++j) sum += mu[j] = fmax$f(mu[j], LEAST_PROBABILITY);
  for (int j = 0; j < $P_MODES; ++j) mu[j] /= sum;
}

/* Bayes' rule, the largest term taken out first; unnormalised weights. Returns that term. */
static $p_real likelihood_weights(const $p_filter *filter, $p_real *weight) {
  $p_real largest = LOWEST_LOG_DENSITY;
  int found = 0;
  for (int j = 0; j < $P_MODES; ++j)
    if (filter->predicted_probability[j] >= IMPOSSIBLE && (!found || filter->step[j].log_likelihood > largest)) {
      largest = filter->step[j].log_likelihood;
      found = 1;
    }
  for (int j = 0; j < $P_MODES; ++j)
    weight[j] = filter->predicted_probability[j] >= IMPOSSIBLE
                    ? filter->predicted_probability[j] * exp$f(filter->step[j].log_likelihood - largest)
                    : 0;
  return largest;
}

/* Returns the log density of the measurement. */
static $p_real bayes($p_filter *filter) {
  $p_real sum = 0;
  const $p_real largest = likelihood_weights(filter, filter->mode_probability);
  for (int j = 0; j < $P_MODES; ++j) sum += filter->mode_probability[j];
  for (int j = 0; j < $P_MODES; ++j) filter->mode_probability[j] /= sum;
  floor_probabilities(filter->mode_probability);
  return largest + log$f(sum);
}

)c";

const char* const noise_text = R"c(/* ---- The scale of the noise, which follows the run ---- */

/* tr(S^-1 C Q C') and e' S^-1 C Q C' S^-1 e of mode j, the latter with e' S^-1 e cut. */
static void explained(const sensor_t *sensor, $p_step_of_mode *m, int j, $p_real *share, $p_real *square) {
  $p_real CQC[$P_MEASUREMENTS][$P_MEASUREMENTS], column[$P_MEASUREMENTS], nis = 0;
  const $p_real most = LARGEST_STANDARDISED * LARGEST_STANDARDISED * (($p_real)($P_MEASUREMENTS - sensor->missing));
  *share = *square = 0;
  for (int i = 0; i < $P_MEASUREMENTS; ++i)
    for (int k = 0; k < $P_MEASUREMENTS; ++k) {
      CQC[i][k] = 0;
      for (int a = 0; a < $P_STATES; ++a)
        for (int b = 0; b < $P_STATES; ++b) CQC[i][k] += sensor->C[i][a] * bank_Q[j][a][b] * sensor->C[k][b];
    }
  for (int i = 0; i < $P_MEASUREMENTS; ++i) {
    for (int k = 0; k < $P_MEASUREMENTS; ++k) column[k] = CQC[k][i];
    solve(m->L, m->D, column);
    *share += column[i];
    nis += m->decorrelated[i] * m->decorrelated[i] / m->D[i];
  }
  if (!(nis < LARGEST_SQUARE)) return;
  for (int i = 0; i < $P_MEASUREMENTS; ++i) column[i] = m->innovation[i];
  solve(m->L, m->D, column);
  for (int i = 0; i < $P_MEASUREMENTS; ++i)
    for (int k = 0; k < $P_MEASUREMENTS; ++k) *square += column[i] * CQC[i][k] * column[k];
  if (nis > most) *square *= most / nis;
}

/* Discounted sums, pulled to one as the memory of the run fades (West and Harrison 1997, section 10.8). */
static void adapt_noise($p_filter *filter, const sensor_t *sensor) {
  const $p_real n_y = ($p_real)($P_MEASUREMENTS - sensor->missing), scale = filter->noise_scale;
  $p_real weight[$P_MODES], total = 0, share = 0, square = 0, squares;
  likelihood_weights(filter, weight);
  for (int j = 0; j < $P_MODES; ++j) {
    $p_real share_j, square_j;
    if (!(weight[j] > 0)) continue;
    explained(sensor, &filter->step[j], j, &share_j, &square_j);
    total += weight[j];
    share += weight[j] * scale * share_j;
    square += weight[j] * scale * square_j;
  }
  share /= total;
  square /= total;
  if (!isfinite(share) || !isfinite(square)) return;
  squares = FORGETTING * filter->noise_samples * scale + (1 - FORGETTING) * PRIOR_SAMPLES + scale * square / n_y;
  filter->noise_samples = FORGETTING * filter->noise_samples + (1 - FORGETTING) * PRIOR_SAMPLES + share / n_y;
  filter->noise_scale = fmin$f(fmax$f(squares / filter->noise_samples, 1 / LARGEST_NOISE_SCALE), LARGEST_NOISE_SCALE);
}

)c";

}  // namespace modebank::app::c_form
