// What is said of modes of two banks that are matched. Draws nothing.

/**
 * Ranks of colours (usedColour) of the modes of each bank, so that matched modes share A's: those of A by use, the
 * others told one by one of theirs; what a bank has alone comes after A's, by use. Infinity: others.
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

// [differing, agreeing] pairs of a match: the farthest apart first, modes that one bank has alone after all pairs.
export function sortedPairs({modes}) {
  const distance = ({first, second, distance: cell}) => (first < 0 || second < 0 ? -1 : cell.v || 0);
  const sorted = [...modes].sort((p, q) => distance(q) - distance(p) || p.first - q.first);
  return [sorted.filter(({agree}) => !agree), sorted.filter(({agree}) => agree)];
}

// In which parameters a pair differs most: "B (+5.2), A (-3.1)".
export function differingWords({first, second, agree, z}, names, letter) {
  if (first < 0) return `only in ${letter}`;
  if (second < 0) return 'only in A';
  if (agree) return 'agree within their errors';
  if (!z.length) return '–';  // of other models
  const far = z.map(({v, t}, i) => ({v: Math.abs(v), text: `${names[i].replace(/ \[[^\]]*\]$/, '')} (${t})`}))
                  .sort((p, q) => q.v - p.v);
  return `differ in ${far.slice(0, 2).filter(({v}) => v > 2).map(({text}) => text).join(', ')}`;
}
