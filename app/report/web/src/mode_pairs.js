// Texts and colours for the matched modes of two banks. This file does not draw.

/**
 * Ranks of colours (usedColour) of the modes of both banks, [of A, of B]. Matched modes have A's rank, which is by use.
 * The other listed modes of B follow after A's, by use. Infinity: merged modes.
 * @typedef {{order: number[], told: number}} Bank
 * @param {Bank} a
 * @param {Bank} b
 * @param {{modes: {first: number, second: number}[]}} match
 * @returns {number[][]}
 */
export function matchedRanks(a, b, {modes}) {
  const ofA = [], ofB = [];
  a.order.forEach((mode, rank) => {
    ofA[mode] = rank < a.told ? rank : Infinity;
  });
  let next = a.told;
  const partner = new Map(modes.filter(({first}) => first >= 0).map(({first, second}) => [second, first]));
  b.order.forEach((mode, rank) => {
    const first = partner.get(mode), shared = first === undefined ? Infinity : ofA[first];
    if (Number.isFinite(shared)) {
      ofB[mode] = shared;
    } else {
      ofB[mode] = rank < b.told ? next++ : Infinity;
    }
  });
  return [ofA, ofB];
}

// [differing, agreeing] pairs of a match. The pair with the largest distance is first; unmatched modes are last.
export function sortedPairs({modes}) {
  const distance = ({first, second, distance: cell}) => (first < 0 || second < 0 ? -1 : cell.v || 0);
  const sorted = [...modes].sort((p, q) => distance(q) - distance(p) || p.first - q.first);
  return [sorted.filter(({agree}) => !agree), sorted.filter(({agree}) => agree)];
}

// The parameters in which the modes of a pair differ most: "B (+5.2), A (-3.1)".
export function differingWords({first, second, agree, z}, names) {
  if (first < 0) return 'only in B';
  if (second < 0) return 'only in A';
  if (agree) return 'agree within their errors';
  if (!z.length) return '–';  // the modes belong to different models
  const far = z.map(({v, t}, i) => ({v: Math.abs(v), text: `${names[i].replace(/ \[[^\]]*\]$/, '')} (${t})`}))
                  .sort((p, q) => q.v - p.v);
  return `differ in ${far.slice(0, 2).filter(({v}) => v > 2).map(({text}) => text).join(', ')}`;
}
