// The modes of B beside the modes of A, matched one to one.
import {details, h, note} from './elements.js';
import {rankColour} from './look.js';
import {differingWords, matchedRanks, sortedPairs} from './mode_pairs.js';
import {nameOf} from './modes.js';
import {section} from './page.js';
import {table} from './table.js';

// The parameters of a mode as on the page of its bank.
const parametersOf = (bank, k) =>
    (k < 0                        ? null :
         bank.motion_names.length ? bank.modes[k].motion :
                                    bank.modes[k].parameters);
const namesOf = (bank) => (bank.motion_names.length ? bank.motion_names : bank.parameter_names);
const modeText = (bank, k) => (k < 0 ? '–' : nameOf(bank, k));

function pairColumns(a, b, match) {
  const names = match.difference ? [] : namesOf(a), ranks = matchedRanks(a, b, match);
  const colourOf = (i, mode) => (mode < 0 ? null : rankColour(ranks[i][mode]));
  const cell = (bank, mode, i) => {
    const values = parametersOf(bank, mode);
    return values ? values[i] : null;
  };
  const alone = (pair) => pair.first < 0 || pair.second < 0;
  return [
    {name: 'Mode of A', text: true, of: (pair) => modeText(a, pair.first), swatch: (pair) => colourOf(0, pair.first)},
    {name: 'Mode of B', text: true, of: (pair) => modeText(b, pair.second), swatch: (pair) => colourOf(1, pair.second)},
    ...(match.by_time ? [{name: 'Time in common', of: (pair) => (alone(pair) ? null : pair.shared)}] : []),
    {name: 'Apart [standard errors]', of: (pair) => (alone(pair) ? null : pair.distance)},
    {name: 'They', text: true, of: (pair) => differingWords(pair, names)},
    ...names.flatMap(
        (name, i) =>
            [{name: `A: ${name}`, of: (pair) => cell(a, pair.first, i)},
             {name: `B: ${name}`, of: (pair) => cell(b, pair.second, i)},
  ]),
  ];
}

export function drawModes({match, runs: [{bank: a}, {bank: b}]}) {
  if (!match.modes.length) {
    section('modes', 'Modes side by side', note(`They cannot be matched: ${match.difference}.`));
    return;
  }
  const columns = pairColumns(a, b, match), [differing, agreeing] = sortedPairs(match);
  const same = agreeing.length ? table(columns, agreeing, {caption: 'Modes of A and B that agree'}) : null;
  const how = match.by_time ?
      'Matched one to one by their time in common: over the samples of common runs, the sum of the smaller of both ' +
          'probabilities over the sum of the larger.' :
      'They have no common run, so they are matched one to one by the parameters.';
  const rest = ' Apart: root mean square difference of the parameters over their joint standard errors. ' +
      'Modes that agree do so in all parameters together at 95 %. Matched modes have one colour.';
  section(
      'modes', 'Modes side by side',
      differing.length ? table(columns, differing, {caption: 'Modes of A and B that differ', sortable: true}) :
                         note('All modes agree within their errors.'),
      same && differing.length ? details(`${agreeing.length} pairs agree within their errors`, same) : same,
      h('p', {class: 'caption'}, how + rest));
}
