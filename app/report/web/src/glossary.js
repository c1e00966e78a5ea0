// The meanings of headings, in the words of `modebank help TERM`.

/** `terms`: [{term, also, means}]. */
export class Glossary {
  constructor(terms) {
    const named = terms.flatMap(({term, also, means}) => [term, ...also].map((name) => [name, means]));
    const lower = named.map(([name, means]) => [name.toLowerCase(), means]);
    this.meanings =
        new Map([...lower, ...named]);  // exact spellings overwrite lower case, because Q and q are two terms
  }

  /** The meaning of a heading, apart from its unit and its object; null for words without a definition. */
  meaningOf(heading) {
    const spelt = String(heading), name = spelt.toLowerCase(), bare = name.replace(/ \[[^\]]*\]$/, '');
    const general = bare.replace(/^(steady gain|rmse|log noise variance) .*/, '$1');
    return [spelt, name, bare, general].map((text) => this.meanings.get(text)).find(Boolean) || null;
  }
}
