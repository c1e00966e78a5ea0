/* The filter of a bank of modes in C99. `modebank export --to c` makes NAME.h of this file and NAME.c of filter.c. The
 * bank's numbers replace bank_sizes.h and bank_numbers.h, and NAME replaces "modebank" in identifiers. With the tables
 * in tests/app/export/small_bank both files compile unchanged. */
#ifndef MODEBANK_H
#define MODEBANK_H

#ifdef __cplusplus
extern "C" {
#endif

#include "bank_sizes.h"

typedef double modebank_real;

/* The estimate at one sample. A member is NaN where it is unknown: before a start, or where nothing was measured. */
typedef struct {
  double prediction[MODEBANK_STATES];                                         /* x before the measurement */
  double innovation[MODEBANK_MEASUREMENTS];                                   /* measurement minus prediction */
  double innovation_covariance[MODEBANK_MEASUREMENTS][MODEBANK_MEASUREMENTS]; /* of the prediction */
  double state[MODEBANK_STATES];                                              /* x after the measurement */
  double covariance[MODEBANK_STATES][MODEBANK_STATES];                        /* and its covariance */
  double mode_probability_predicted[MODEBANK_MODES];                          /* before the measurement */
  double mode_probability[MODEBANK_MODES];                                    /* after it */
  double log_density; /* of the signals that were measured, given all samples before [nats] */
  int steps;          /* model steps from the sample before; 0: the filter (re)started here, or waits for a start */
} modebank_estimate;

typedef struct {
  double mean[MODEBANK_STATES];
  double covariance[MODEBANK_STATES][MODEBANK_STATES];
} modebank_gaussian;

/* Workspace: one mode's step. */
typedef struct {
  modebank_gaussian predicted;
  double gain[MODEBANK_STATES][MODEBANK_MEASUREMENTS];
  double innovation[MODEBANK_MEASUREMENTS], decorrelated[MODEBANK_MEASUREMENTS];
  double S[MODEBANK_MEASUREMENTS][MODEBANK_MEASUREMENTS]; /* covariance of the innovation, L D L' */
  double L[MODEBANK_MEASUREMENTS][MODEBANK_MEASUREMENTS], D[MODEBANK_MEASUREMENTS];
  double log_likelihood;
} modebank_step_of_mode;

/* The filter's state and workspace. A copy is an independent filter. */
typedef struct {
  int started;
  modebank_gaussian mode[MODEBANK_MODES];
  double mode_probability[MODEBANK_MODES];
  double recorded[MODEBANK_KEPT_INPUTS][MODEBANK_ROOM_FOR_INPUTS];    /* inputs, newest first */
  double measured[MODEBANK_KEPT_MEASUREMENTS][MODEBANK_MEASUREMENTS]; /* newest first */
  int samples, whole; /* samples so far, and whole ones in a row; neither is counted further than a start needs */
  double time_s;      /* of the last sample */
  modebank_step_of_mode step[MODEBANK_MODES];
  modebank_gaussian mixed[MODEBANK_MODES];
  double predicted_probability[MODEBANK_MODES];
} modebank_filter;

/* Resets the filter. Call it before the first sample. */
void modebank_restart(modebank_filter* filter);

/* Steps to the next sample: its time [s] (NaN: one period after the last), its inputs (not finite: the last finite
 * value continues) and its measurements (NaN: missing). k periods between two times are k steps with the held inputs.
 * After more than 50 periods the filter starts anew from the next complete measurement. Times must increase. `estimate`
 * may be null. */
void modebank_step(modebank_filter* filter, double time_s, const double* input, const double* measurement,
                   modebank_estimate* estimate);

/* Predicts the measurements of the next `steps` samples, one period apart, and their covariances. `input`: steps x
 * MODEBANK_INPUTS, inputs of these samples. `mean`: steps x MODEBANK_MEASUREMENTS. `covariance`: steps x
 * MODEBANK_MEASUREMENTS x MODEBANK_MEASUREMENTS. `filter` is unchanged; `ahead` is workspace for a copy of it. */
void modebank_predict(const modebank_filter* filter, modebank_filter* ahead, int steps, const double* input,
                      double* mean, double* covariance);

#ifdef __cplusplus
}
#endif

#endif /* MODEBANK_H */
