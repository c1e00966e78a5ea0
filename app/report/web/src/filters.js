// Names of filters and runs as the page shows them.
export const filterNames = {
  bank: 'Bank',
  baseline: 'Baseline (one Kalman filter)',
  noise_only: 'Noise only',
  one_motion: 'One motion, changing noise',
  drifting: 'One drifting motion',
  nonlinear: 'One nonlinear motion',
  combined: 'All filters combined',
  global: 'Global model',
};
export const shortNames = {
  bank: 'bank',
  baseline: 'baseline',
  noise_only: 'noise only',
  one_motion: 'one motion',
  drifting: 'drifting',
  nonlinear: 'nonlinear',
  combined: 'combined',
  global: 'global model'
};
// Kinds of scores that count samples on one side of the interval of an exact model.
export const sidesOf = {
  z: {above: 'too_far', below: 'too_close'},
  nis: {above: 'nis_above', below: 'nis_below'}
};
export const kindNames = [['z', 'distance z'], ['nis', 'NIS']];
export const sideNames = {
  above: 'too far',
  below: 'too close'
};
export const roleNames = {
  test: 'held-out runs',
  train: 'training runs'
};
export const roleOf = (role) => (role === 'test' ? 'held out' : 'training');
