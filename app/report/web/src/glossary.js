// Finds terms in headings and sentences.

const escaped = (text) => text.replace(/[.*+?^${}()|[\]\\/-]/g, '\\$&');

// A pattern that matches all names, as whole words or plurals. Longer names come first: "95 % band" before "band". "one
// motion" in a sentence need not mean the competitor one_motion.
function anyOf(names) {
  const isOther = (name) => name.includes(' ') && names.includes(name.replace(/ /g, '_'));
  const meant = (name) => name.length > 2 && /^\w/.test(name) && !isOther(name);
  const sorted = names.filter(meant).sort((a, b) => b.length - a.length);
  return new RegExp(`(?<![\\w-])(${sorted.map(escaped).join('|')})s?(?![\\w])`, 'gi');
}

/** `terms`: [{term, also, means}]. */
export class Glossary {
  constructor(terms) {
    const named = terms.flatMap(({term, also, means}) => [term, ...also].map((name) => [name, means]));
    const lower = named.map(([name, means]) => [name.toLowerCase(), means]);
    this.meanings =
        new Map([...lower, ...named]);  // exact spellings overwrite lower case, because Q and q are two terms
    this.anyTerm = anyOf(lower.map(([name]) => name));
  }

  /** The meaning of a heading, apart from its unit and its object; null for words without a definition. */
  meaningOf(heading) {
    const spelt = String(heading), name = spelt.toLowerCase(), bare = name.replace(/ \[[^\]]*\]$/, '');
    const general = bare.replace(/^(steady gain|rmse|log noise variance) .*/, '$1');
    return [spelt, name, bare, general].map((text) => this.meanings.get(text)).find(Boolean) || null;
  }

  /** The parts of a sentence as {part, meaning}; meaning is null except at the first mention of a term. */
  termsIn(sentence) {
    const parts = [], told = new Set();
    let from = 0;
    const add = (to, meaning) => {
      if (to > from) parts.push({part: sentence.slice(from, to), meaning});
      from = to;
    };
    for (const found of sentence.matchAll(this.anyTerm)) {
      const meaning = this.meanings.get(found[1].toLowerCase());
      if (told.has(meaning)) continue;
      told.add(meaning);
      add(found.index, null);
      add(found.index + found[0].length, meaning);
    }
    add(sentence.length, null);
    return parts;
  }
}
