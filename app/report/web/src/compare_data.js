// The data of the runs, with the predictions of all banks.
import {controls, note} from './elements.js';
import {INK} from './look.js';
import {section} from './page.js';
import {colours, dashes, letters, modeColours, pairLegend, symbols} from './pair.js';
import {inNaturalOrder} from './run_names.js';
import {inputRows, nisRow, probabilityRow, stateRow} from './time_rows.js';
import {runChoice, timeControls, timePlot, TimeState} from './timeview.js';

// Runs with the same samples in all archives. For these, the data of A are also the data of the others.
function commonRuns(data) {
  if (data.verdicts.some(({runs}) => runs === 0)) return [];  // the runs have equal names but not equal samples
  const [a, ...others] = data.runs.map((run) => (run.data ? inNaturalOrder(run.data.runs) : []));
  return a.flatMap((run) => {
    const same = (other) =>
        other.name === run.name && other.time.samples === run.time.samples && other.state.length === run.state.length;
    const found = others.map((list) => list.find(same));
    return found.every(Boolean) ? [{...run, truth: null, pair: [run, ...found].map((one) => one.filters.bank)}] : [];
  });
}

const layersOf = (data) => data.runs.map((_, k) => ({
                                           of: (run) => run.pair[k],
                                           prefix: `${letters[k]} `,
                                           band: colours[k],
                                           opacity: 0.2,
                                           line: colours[k],
                                           nis: colours[k],
                                           // A is drawn first and with a wider line, so that it remains visible behind
                                           // the others.
                                           stroke: {dash: dashes[k], width: k ? 1.4 : 3},
                                           symbol: symbols[k],
                                         }));

export function drawData(data) {
  const runs = commonRuns(data);
  if (!runs.length) {
    section('data', 'Data and predictions', note('No run is in all archives with the same samples.'));
    return;
  }
  const place = data.runs[0].data, state = new TimeState(runs), layers = layersOf(data);
  const ofModes = modeColours(data);
  const probabilities = () => layers.flatMap(({of, prefix}, k) => {
    if (!(of(state.current) || {}).probability) return [];
    return [probabilityRow(of, `probability of the modes of ${prefix.trim()}`, ofModes[k])];
  });
  const rows = () =>
      [...place.states.map((_, i) => stateRow(place, i, layers, 240)),
       nisRow(place, layers),
       ...probabilities(),
       ...inputRows(place),
  ];
  const label = 'State with the predictions of all banks, their NIS and their mode probabilities over time';
  const caption =
      `Bands: ${100 * place.level} % of each bank's prediction. Dashed lines at the NIS: both bounds of a ` +
      'true filter. Modes that are matched have the same colour.';
  const plot = timePlot(state, label, rows, caption);
  section(
      'data', 'Data and predictions', pairLegend(data.runs, [[INK, 'measured']]),
      controls(runChoice(state), timeControls(state)), plot);
}
