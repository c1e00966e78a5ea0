// Filters for the table of runs: a user types them below a heading.
import {plainValue} from './ordering.js';

const comparisons = {
  '>': (v, limit) => v > limit,
  '<': (v, limit) => v < limit,
  '>=': (v, limit) => v >= limit,
  '<=': (v, limit) => v <= limit,
  '=': (v, limit) => v === limit,
};

// The text as a number; NaN for other text.
const numberIn = (text) => (text === null || text === undefined || String(text).trim() === '' ? NaN : Number(text));

const shownText = (cell) => {
  if (cell === null || cell === undefined) return '';
  return String(typeof cell === 'object' ? cell.t : cell);
};

function comparisonIn(word) {
  const found = /^(>=|<=|>|<|=)\s*(\S+)$/.exec(word);
  if (!found || Number.isNaN(numberIn(found[2]))) return null;
  const holds = comparisons[found[1]], limit = numberIn(found[2]);
  return (cell) => {
    const v = numberIn(plainValue(cell));
    return !Number.isNaN(v) && holds(v, limit);
  };
}

function rangeIn(word) {
  const found = /^(\S+)\.\.(\S+)$/.exec(word);
  if (!found) return null;
  const [low, high] = [numberIn(found[1]), numberIn(found[2])];
  if (Number.isNaN(low) || Number.isNaN(high)) return null;
  return (cell) => {
    const v = numberIn(plainValue(cell));
    return v >= low && v <= high;
  };
}

function choicesIn(word) {
  if (!word.includes('|')) return null;
  const choices = word.split('|').map((text) => text.trim());
  return (cell) => choices.includes(shownText(cell)) || choices.includes(String(plainValue(cell)));
}

// Accepts "> 2", "<= 0.1", "3..5" and "a | b" (either of both). A cell matches any other text if it contains that text.
// Returns a function cell => bool.
export function filterOf(text) {
  const word = text.trim();
  if (!word) return () => true;
  const part = (cell) => shownText(cell).toLowerCase().includes(word.toLowerCase());
  return comparisonIn(word) || rangeIn(word) || choicesIn(word) || part;
}
