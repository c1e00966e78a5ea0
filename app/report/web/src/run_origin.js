// The origin of the run, for those who want to check it. It opens at a click, at the end of the page.
import {controls, copyButton, details, facts, h, note} from './elements.js';
import {section} from './page.js';
import {table} from './table.js';

const changedColumns = [
  {name: 'Setting', text: true, of: (row) => row.key},
  {name: 'Value', text: true, of: (row) => row.value},
  {name: 'Default', text: true, of: (row) => row.standard},
];
const structureColumns = [
  {name: 'State lags', of: (row) => row.state_lags},
  {name: 'Input lags', of: (row) => row.input_lags},
  {name: 'Delay', of: (row) => row.input_delay},
  {name: 'Log score', of: (row) => row.log_score},
  {name: 'Below the best', of: (row) => row.loss},
  {name: 'RMSE', of: (row) => row.rmse},
  {name: 'Drifting', of: (row) => row.drifting},
  {name: 'One motion', of: (row) => row.one_motion},
  {name: 'Modes', of: (row) => row.modes},
  {name: 'Taken by', text: true, of: (row) => row.taken_by},
];
const fileColumns = [
  {name: 'File', text: true, of: (row) => row.path},
  {name: 'Bytes', of: (row) => row.bytes},
  {name: 'SHA-256', text: true, of: (row) => row.sha256},
];

export function drawOrigin(origin) {
  const code = (text) => h('code', {}, text), listing = (text) => h('pre', {tabindex: 0}, text);
  const changed = {caption: 'Settings that are not the defaults'};
  section(
      'origin', 'What was run', facts([['Made', `${origin.created} by modebank ${origin.version}`], ...origin.facts]),
      controls(copyButton('Copy the configuration', origin.config)),
      details('Command and hashes', facts([
                ['Command', code(origin.command)],
                ['Hash of settings', code(origin.config_hash)],
                ['Hash of data', code(origin.data_hash)],
              ])),
      details(
          'Settings',
          origin.changed.length ? table(changedColumns, origin.changed, changed) :
                                  note('All settings are the defaults.'),
          details('The whole configuration', listing(origin.config))),
      origin.structures.length ? details(
                                     'Lags and delay that were compared on training runs left out',
                                     table(structureColumns, origin.structures, {
                                       caption: 'Structures, scored as one motion, as one that drifts, as modes',
                                       chosen: (row) => row.chosen
                                     })) :
                                 null,
      details(`${origin.inputs.length} input files`, table(fileColumns, origin.inputs, {caption: 'Input files'})),
      details('Versions', facts(origin.versions)),
      details('The summary as the program prints it', listing(origin.summary)));
}
