// Formats of numbers that the scripts compute. C++ formats the numbers in tables (numbers.hpp).

/** At most `digits` significant digits, with a true minus sign. */
export function shortNumber(value, digits = 6) {
  if (!Number.isFinite(value)) return '–';
  const text = String(Number(value.toPrecision(digits)));
  return text.replace('e-', 'e−').replace(/^-/, '−');
}

/** A time in seconds, to a tenth of a millisecond. */
export const secondsText = (t) => `${shortNumber(Math.round(t * 1e4) / 1e4, 12)} s`;

/** Readout of {low, high}: one value, or a range if they differ. */
export function rangeText({low, high}, unit) {
  const text = low === high || Number.isNaN(low) ? shortNumber(low) : `${shortNumber(low)} … ${shortNumber(high)}`;
  return unit ? `${text} ${unit}` : text;
}
