// The section on the bank: its modes in words, in numbers and by label.
import {details, facts, h, note} from './elements.js';
import {roleNames} from './filters.js';
import {modeColour} from './look.js';
import {modeCell} from './mode_names.js';
import {byUse, hasLevels, motionsOf, othersName} from './modes.js';
import {section} from './page.js';
import {switching} from './run_switching.js';
import {table} from './table.js';

const list = (key, names) => names.map((name, i) => ({name, of: (row) => row[key] && row[key][i]}));
const which = {
  name: 'Mode',
  text: true,
  of: (row) => row.name,
  swatch: (row) => row.colour
};
const gains = (bank) => list('gains', bank.gain_names.map((name) => `steady gain ${name}`));

// Columns that describe a mode in words: its use, its motion, and the reliability of its band.
function wordColumns(bank) {
  const seen = bank.modes.some((row) => row.usage);
  return [
    which,
    {name: 'Used', of: (row) => row.use},
    ...(seen ? [{name: 'Stay', of: (row) => row.stay}] : []),
    {name: 'Time constants', of: (row) => row.decays},
    ...gains(bank),
    ...list('motion', bank.motion_names),
    ...(seen ?
            [
              {name: 'too far', of: (row) => row.too_far},
              {name: 'too close', of: (row) => row.too_close},
              {name: 'Band', text: true, of: (row) => row.verdict},
            ] :
            []),
  ];
}

function numberColumns(bank) {
  return [
    which,
    {name: 'Weight', of: (row) => row.weight},
    ...list('parameters', bank.parameter_names),
    {name: bank.noise_name, of: (row) => row.noise_sd},
    {name: 'Decay per sample', of: (row) => row.per_sample},
  ];
}

// All motions, as on the first screen.
function motionTable(bank) {
  const {told, others} = motionsOf(bank);
  const rows = [...told, ...others].map((row) => ({...row, colour: modeColour(row.lead)}));
  const columns = [
    {...which, name: 'Motion', of: (row) => row.title},
    {name: 'Used', of: (row) => row.use},
    {name: 'Stay', of: (row) => row.stay},
    {name: 'Time constant', of: (row) => row.decays},
    ...gains(bank),
  ];
  return table(columns, rows, {caption: 'Motions, most used first (their modes differ in noise)', sortable: true});
}

function modeTables(bank) {
  const named = (rows) => rows.map((row) => ({...row, name: modeCell(row.mode), colour: modeColour(row.mode)}));
  const baseline = bank.baseline ? [{...bank.baseline, name: 'baseline', colour: null}] : [];
  const {told, others} = byUse(bank);
  const caption = `Modes, most used first (± one standard error; ${roleNames[bank.role]})`;
  const all = [...named(bank.order.map((k) => bank.modes[k])), ...baseline];
  const each = table(wordColumns(bank), [...named(told), ...baseline], {caption, sortable: true});
  return [
    ...(hasLevels(bank) ? [motionTable(bank), details('Each mode', each)] : [each]),
    others.length ? details(
                        `${othersName(others.length)}, used less`,
                        table(wordColumns(bank), named(others), {caption: 'Other modes', sortable: true})) :
                    null,
    details(
        'Parameters of every mode in numbers',
        table(numberColumns(bank), all, {caption: 'Parameters (± one standard error)', sortable: true})),
  ];
}

function bankFacts(bank) {
  const refined = 'refined by expectation-maximisation, so they differ from the mixture’s components';
  return facts([
    ['Model', bank.model],
    ['Sample period', `${bank.dt_s.t} s`],
    [bank.noise_variance_name, bank.R.t],
    ['Modes are', bank.refined ? refined : 'the mixture’s components'],
  ]);
}

function screenedTable(screened) {
  if (!screened.length) return null;
  return table(
      [
        {name: 'Component', of: (row) => row.component},
        {name: 'Weight', of: (row) => row.weight},
        {name: 'Spectral radius', of: (row) => row.radius},
        {name: 'Left out because', prose: true, of: (row) => row.reason},
      ],
      screened, {caption: 'Components that were left out of the bank'});
}

// For each label, the most probable modes of its samples.
function confusionTable(bank) {
  const {confusion} = bank;
  if (!confusion) return null;
  const {told, others} = motionsOf(bank);
  const rest = others.length ? [{name: othersName(others.length), of: (row) => row.shares[told.length]}] : [];
  const columns = [
    {name: 'Label', text: true, of: (row) => row.label},
    {name: 'Samples', of: (row) => row.samples},
    ...told.map(({title}, f) => ({name: title, of: (row) => row.shares[f]})),
    ...rest,
  ];
  const caption = `Most probable mode of each label’s samples (${roleNames[confusion.role]})`;
  return [h('h3', {}, 'Modes and labels'), table(columns, confusion.rows, {caption})];
}

export function drawBank(bank) {
  if (!bank) return section('bank', 'The modes', note('This archive has no bank, because no modes were learned.'));
  return section(
      'bank', 'The modes', modeTables(bank), confusionTable(bank), switching(bank),
      details('The bank they make up', bankFacts(bank), screenedTable(bank.screened)));
}
