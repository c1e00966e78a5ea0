// The modes of the banks beside the modes of A, matched one to one.
import {details, h, note} from './elements.js';
import {differingWords, sortedPairs} from './mode_pairs.js';
import {hasFamilies, nameOf} from './modes.js';
import {section} from './page.js';
import {letters, modeColours} from './pair.js';
import {table} from './table.js';

// The parameters of a mode as on the page of its bank.
const parametersOf = (bank, k) =>
    (k < 0                        ? null :
         bank.motion_names.length ? bank.modes[k].motion :
                                    bank.modes[k].parameters);
const namesOf = (bank) => (bank.motion_names.length ? bank.motion_names : bank.parameter_names);
const modeText = (bank, k) => (k < 0 ? '–' : nameOf(bank, k));

/** `ofModes`: colours of A's modes and of the other bank's. */
function pairColumns(a, b, letter, ofModes, {by_time: byTime, difference}) {
  const names = difference ? [] : namesOf(a);
  const colourOf = (i, mode) => (mode < 0 ? null : ofModes[i](mode));
  const cell = (bank, mode, i) => {
    const values = parametersOf(bank, mode);
    return values ? values[i] : null;
  };
  return [
    {name: 'Mode of A', text: true, of: (pair) => modeText(a, pair.first), swatch: (pair) => colourOf(0, pair.first)},
    {
      name: `Mode of ${letter}`,
      text: true,
      of: (pair) => modeText(b, pair.second),
      swatch: (pair) => colourOf(1, pair.second)
    },
    ...(byTime ? [{name: 'Time in common', of: (pair) => (pair.first < 0 || pair.second < 0 ? null : pair.shared)}] :
                 []),
    {name: 'Apart [standard errors]', of: (pair) => (pair.first < 0 || pair.second < 0 ? null : pair.distance)},
    {name: 'They', text: true, of: (pair) => differingWords(pair, names, letter)},
    ...names.flatMap(
        (name, i) =>
            [{name: `A: ${name}`, of: (pair) => cell(a, pair.first, i)},
             {name: `${letter}: ${name}`, of: (pair) => cell(b, pair.second, i)},
  ]),
  ];
}

// A table of families that share time. Empty if the archives have no run in common, or if every mode is a family of its
// own.
function familyTable({families}, a, b, letter, ofModes) {
  if (!families.length || !(hasFamilies(a) || hasFamilies(b))) return null;
  const columns = [
    {name: 'Family of A', text: true, of: (pair) => pair.first, swatch: (pair) => ofModes[0](pair.lead[0])},
    {name: 'Used', of: (pair) => pair.first_use},
    {name: `Family of ${letter}`, text: true, of: (pair) => pair.second, swatch: (pair) => ofModes[1](pair.lead[1])},
    {name: `Used in ${letter}`, of: (pair) => pair.second_use},
    {name: 'Time in common', of: (pair) => pair.shared},
  ];
  return table(columns, families, {caption: `Families of A and ${letter}, each with the one it shares most time with`});
}

function matchTables(data, match, k, ofModes) {
  const letter = letters[k], [a, b] = [data.runs[0].bank, data.runs[k].bank];
  const heading = h('h3', {}, `A and ${letter}`);
  if (!match.modes.length) return [heading, note(`They cannot be matched: ${match.difference}.`)];
  const columns = pairColumns(a, b, letter, [ofModes[0], ofModes[k]], match),
        [differing, agreeing] = sortedPairs(match);
  const same = agreeing.length ? table(columns, agreeing, {caption: `Modes of A and ${letter} that agree`}) : null;
  const fold = same && differing.length ? details(`${agreeing.length} pairs agree within their errors`, same) : same;
  return [
    data.matches.length > 1 ? heading : null,
    familyTable(match, a, b, letter, [ofModes[0], ofModes[k]]),
    differing.length ? table(columns, differing, {caption: `Modes of A and ${letter} that differ`, sortable: true}) :
                       note('All modes agree within their errors.'),
    fold,
  ];
}

export function drawModes(data) {
  const how = data.matches.some(({by_time: byTime}) => byTime) ?
      'Matched one to one by their time in common: over the samples of common runs, the sum of the smaller of both ' +
          'probabilities over the sum of the larger.' :
      'They have no common run, so they are matched one to one by the parameters.';
  const rest = ' Apart: root mean square difference of the parameters over their joint standard errors. ' +
      'Modes that agree do so in all parameters together at 95 %. Matched modes have one colour.';
  const ofModes = modeColours(data);
  section(
      'modes', 'Modes side by side', data.matches.map((match, i) => matchTables(data, match, i + 1, ofModes)),
      data.matches.some(({modes}) => modes.length) ? h('p', {class: 'caption'}, how + rest) : null);
}
