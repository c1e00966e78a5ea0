// The page of one run.
import { copyButton, data, draw, facts, h, head, note, section, table, value } from './common.js';

const filterNames = { bank: 'Bank', baseline: 'Baseline (one Kalman filter)', noise_only: 'Noise only' };

function drawOrigin(origin) {
  section('origin', 'What was run',
    facts([['Command', h('code', {}, origin.command)], ['Made', `${origin.created} by modebank ${origin.version}`],
      ['Configuration', h('code', {}, origin.config_hash)], ['Data', h('code', {}, origin.data_hash)]]),
    origin.changed.length ? table([{ name: 'Setting', text: true, of: (row) => row.key }, { name: 'Value', text: true, of: (row) => row.value },
      { name: 'Default', text: true, of: (row) => row.standard }], origin.changed, { caption: 'Settings that are not the defaults' }) : note('All settings are the defaults.'),
    h('details', {}, h('summary', {}, 'The whole configuration'), copyButton('Copy the configuration', origin.config), h('pre', { tabindex: 0 }, origin.config)),
    h('details', {}, h('summary', {}, `${origin.inputs.length} input files`),
      table([{ name: 'File', text: true, of: (row) => row.path }, { name: 'Bytes', of: (row) => row.bytes }, { name: 'SHA-256', text: true, of: (row) => row.sha256 }], origin.inputs, { caption: 'Input files' })),
    h('details', {}, h('summary', {}, 'Versions'), facts(origin.versions)),
    h('details', {}, h('summary', {}, 'The summary as the program prints it'), h('pre', { tabindex: 0 }, origin.summary)));
}

function drawVerdict(verdict) {
  const cards = verdict.numbers.map((row) => h('li', {}, h('div', { class: 'name' }, row.name + (row.unit ? ` [${row.unit}]` : '')),
    h('div', { class: 'big' }, value(row.values.bank)),
    Object.keys(row.values).filter((name) => name !== 'bank').map((name) => h('div', { class: 'soft' }, `${filterNames[name]}: `, value(row.values[name]))),
    h('div', { class: 'soft' }, row.better)));
  section('verdict', 'Verdict', h('p', { class: `verdict ${verdict.good === true ? 'good' : verdict.good === false ? 'bad' : ''}` }, verdict.text),
    Object.keys(verdict.numbers[0].values).length ? h('ul', { class: 'numbers' }, cards) : null);
}

draw(async () => {
  head(data.file, `Run of ${data.origin.created}`);
  drawOrigin(data.origin);
  drawVerdict(data.verdict);
});
