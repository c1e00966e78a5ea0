// Texts and colours for the matched modes of two banks. This file does not draw.

/**
 * Ranks of colours (usedColour) of the modes of each bank. Matched modes have A's rank, which is by use. The other
 * listed modes of a bank follow after A's, by use. Infinity: merged modes.
 * @param {({order: number[], told: number}|null)[]} banks
 * @param {{modes: {first: number, second: number}[]}[]} matches of the second, third, ... with A
 * @returns {number[][]}
 */
export function matchedRanks(banks, matches) {
  const byUse = ({order, told}) => {
    const ranks = [];
    order.forEach((mode, rank) => {
      ranks[mode] = rank < told ? rank : Infinity;
    });
    return ranks;
  };
  const all = banks.map((bank) => (bank ? byUse(bank) : []));
  matches.forEach(({modes}, i) => {
    const bank = banks[i + 1];
    if (!banks[0] || !bank || !modes.length) return;
    let next = banks[0].told;
    const partner = new Map(modes.filter(({first}) => first >= 0).map(({first, second}) => [second, first]));
    bank.order.forEach((mode, rank) => {
      const first = partner.get(mode);
      const shared = first === undefined ? Infinity : all[0][first];
      if (Number.isFinite(shared)) {
        all[i + 1][mode] = shared;
      } else {
        all[i + 1][mode] = rank < bank.told ? next++ : Infinity;
      }
    });
  });
  return all;
}

// [differing, agreeing] pairs of a match. The pair with the largest distance is first; unmatched modes are last.
export function sortedPairs({modes}) {
  const distance = ({first, second, distance: cell}) => (first < 0 || second < 0 ? -1 : cell.v || 0);
  const sorted = [...modes].sort((p, q) => distance(q) - distance(p) || p.first - q.first);
  return [sorted.filter(({agree}) => !agree), sorted.filter(({agree}) => agree)];
}

// The parameters in which the modes of a pair differ most: "B (+5.2), A (-3.1)".
export function differingWords({first, second, agree, z}, names, letter) {
  if (first < 0) return `only in ${letter}`;
  if (second < 0) return 'only in A';
  if (agree) return 'agree within their errors';
  if (!z.length) return '–';  // the modes belong to different models
  const far = z.map(({v, t}, i) => ({v: Math.abs(v), text: `${names[i].replace(/ \[[^\]]*\]$/, '')} (${t})`}))
                  .sort((p, q) => q.v - p.v);
  return `differ in ${far.slice(0, 2).filter(({v}) => v > 2).map(({text}) => text).join(', ')}`;
}
