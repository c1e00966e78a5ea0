/* The bank. x: x0 [rad/s], x1 [rad/s].
 * u: u0 [m/s].
 * y: y0 [rad/s].
 * A[i][j] is in units of x[i] per x[j], B[i][j] of x[i] per u[j], c[i] of x[i], Q[i][j] of x[i] x[j]. */
enum {
  FIRST_TRANSITION = 1, /* of a run, by samples before it */
  TRANSITION_BY_STATE = 1
};

/* Length of a step [s]; 0: samples have no clock */
static const double bank_dt_s = 0.125;

/* Samples from each input to its first effect */
static const int bank_input_delay[] = {1};

/* A = I + the archive's increment */
static const double bank_A[MODES][STATES][STATES] = {
    /* wet ice; standard errors 0.125 0.125; 0.125 0.125 */
    {{0.75, -0.125},
     {1.0, 0.0}},
    /* mode 1; standard errors 0.125 0.125; 0.125 0.125 */
    {{0.9375, 0.03125},
     {1.0, 0.0}}
};

/* B */
static const double bank_B[MODES][STATES][ACTING_ROOM] = {
    /* wet ice; standard errors 0; 0 */
    {{0.5},
     {0.0}},
    /* mode 1; standard errors 0; 0 */
    {{0.125},
     {0.0}}
};

/* c */
static const double bank_c[MODES][STATES] = {
    /* wet ice; standard errors 0; 0 */
    {0.0625, 0.0},
    /* mode 1; standard errors 0; 0 */
    {0.0, 0.0}
};

/* Q, per step of bank_dt_s */
static const double bank_Q[MODES][STATES][STATES] = {
    /* wet ice; standard errors not known */
    {{0.0009765625, 0.0},
     {0.0, 0.0}},
    /* mode 1; standard errors not known */
    {{0.0078125, 0.0},
     {0.0, 0.0}}
};

/* C */
static const double bank_C[MEASUREMENTS][STATES] = {{1.0, 0.0}};

/* R */
static const double bank_R[MEASUREMENTS][MEASUREMENTS] = {{0.0001220703125}};

/* T[i][j] = P(mode j next | mode i now): a row is the mode that is left, and sums to one */
static const double bank_T[MODES][MODES] = {{0.875, 0.125},
    {0.25, 0.75}};

/* of the modes at a start */
static const double bank_initial_probability[MODES] = {0.5, 0.5};

/* with TRANSITION_BY_STATE T[i][j] is multiplied by exp(weight[j] . (z - reference)), z = (x, u), and its rows are
 * normalised */
static const double bank_logit_weight[MODES][STATES + ACTING_ROOM] = {{0.0, 0.0, 0.0},
    {2.0, -1.0, 4.0}};

/* z where T holds */
static const double bank_logit_reference[STATES + ACTING_ROOM] = {0.125, 0.0, 0.25};

/* x of a start by the measurements, newest first */
static const double bank_start_gain[STATES][MEASUREMENTS * STATE_LAGS] = {{1.0, 0.0},
    {0.0, 1.0}};

/* and its covariance */
static const double bank_start_covariance[STATES][STATES] = {{0.0001220703125, 0.0},
    {0.0, 0.0001220703125}};
