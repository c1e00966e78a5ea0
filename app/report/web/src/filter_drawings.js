// Panels that show a filter's calibration.

/** Residual autocorrelation by lag, from one sample on: a panel with a line and points for each of `rows`. */
export function autocorrelationPanel(rows, band) {
  const marks = rows.flatMap(({series, name, colour}) => {
    const y = series.slice(1), x = y.map((_, lag) => lag + 1);
    return [{kind: 'line', x, y, colour}, {kind: 'points', x, y, colour, size: 5, name}];
  });
  const grey = band === undefined ? [] : [{kind: 'band', low: -band, high: band}];
  return {x: {title: 'lag [samples]', whole: true}, y: {title: 'autocorrelation'}, marks: [...grey, ...marks]};
}

/** A histogram of probability integral transforms (PIT) as bars, with the interval for a true filter. */
export function pitPanel({counts, band, expected}, colour, title) {
  const bins = counts.length, x = counts.map((_, b) => (b + 0.5) / bins);
  return {
    title,
    x: {title: 'PIT', range: [0, 1]},
    y: {title: 'samples', zero: true},
    marks: [
      {kind: 'bars', x, y: counts, width: 0.94 / bins, colour},
      {kind: 'band', low: band[0], high: band[1]},
      {kind: 'rule', y: expected},
    ],
  };
}
