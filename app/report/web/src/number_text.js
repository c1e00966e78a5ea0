// Numbers as the page's own scripts write them; those of tables were written by C++ (numbers.hpp).

/** At most `digits` digits that count; a true minus sign. */
export function shortNumber(value, digits = 6) {
  if (!Number.isFinite(value)) return '–';
  const text = String(Number(value.toPrecision(digits)));
  return text.replace('e-', 'e−').replace(/^-/, '−');
}

/** A time in seconds, to a tenth of a millisecond. */
export const secondsText = (t) => `${shortNumber(Math.round(t * 1e4) / 1e4, 12)} s`;

/** What a readout says of {low, high}: one value, or a range where they differ. */
export function rangeText({low, high}, unit) {
  const text = low === high || Number.isNaN(low) ? shortNumber(low) : `${shortNumber(low)} … ${shortNumber(high)}`;
  return unit ? `${text} ${unit}` : text;
}
