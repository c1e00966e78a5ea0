// What is said of modes of two banks that are matched. Draws nothing.

// [differing, agreeing] pairs of a match: the farthest apart first, modes that one bank has alone after all pairs.
export function sortedPairs({modes}) {
  const distance = ({first, second, distance: cell}) => (first < 0 || second < 0 ? -1 : cell.v);
  const sorted = [...modes].sort((p, q) => distance(q) - distance(p) || p.first - q.first);
  return [sorted.filter(({agree}) => !agree), sorted.filter(({agree}) => agree)];
}

// In which parameters a pair differs most: "B (+5.2), A (-3.1)".
export function differingWords({first, second, agree, z}, names, letter) {
  if (first < 0) return `only in ${letter}`;
  if (second < 0) return 'only in A';
  if (agree) return 'agree within their errors';
  const far = z.map(({v, t}, i) => ({v: Math.abs(v), text: `${names[i].replace(/ \[[^\]]*\]$/, '')} (${t})`}))
                  .sort((p, q) => q.v - p.v);
  return `differ in ${far.slice(0, 2).filter(({v}) => v > 2).map(({text}) => text).join(', ')}`;
}
