enum {
  MODEBANK_MODES = 2,
  MODEBANK_STATES = 2, /* of x, lagged samples among them */
  MODEBANK_MEASUREMENTS = 1, /* of y */
  MODEBANK_INPUTS = 1, /* as they are recorded */
  MODEBANK_ACTING_INPUTS = 1, /* of u, which acts on one step: lagged samples among them */
  MODEBANK_ROOM_FOR_INPUTS = 1,
  MODEBANK_KEPT_INPUTS = 2, /* samples that the filter remembers */
  MODEBANK_KEPT_MEASUREMENTS = 2
};

/* Places in `input` */
enum {
  MODEBANK_INPUT_u0 = 0 /* u0 [m/s] */
};

/* Places in `measurement` */
enum {
  MODEBANK_MEASUREMENT_y0 = 0 /* y0 [rad/s] */
};

/* Places in x */
enum {
  MODEBANK_STATE_x0 = 0, /* x0 [rad/s] */
  MODEBANK_STATE_x1 = 1 /* x1 [rad/s] */
};

/* Places in mode_probability */
enum {
  MODEBANK_MODE_wet_ice = 0, /* wet ice */
  MODEBANK_MODE_1 = 1 /* mode 1 */
};
