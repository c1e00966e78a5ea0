// Names of the archive's filters and runs as people read them.
export const filterNames = {
  bank: 'Bank',
  baseline: 'Baseline (one Kalman filter)',
  noise_only: 'Noise only',
  global: 'Global model',
};
export const shortNames = {
  bank: 'bank',
  baseline: 'baseline',
  noise_only: 'noise only',
  global: 'global model'
};
export const roleNames = {
  test: 'held-out runs',
  train: 'training runs'
};
export const roleOf = (role) => (role === 'test' ? 'held out' : 'training');
