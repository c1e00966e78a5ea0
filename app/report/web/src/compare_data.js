// Data of two runs with what both banks predicted.
import {controls, note} from './elements.js';
import {section} from './page.js';
import {colours, letters, pairLegend, stroke, symbols} from './pair.js';
import {ink} from './plots.js';
import {inputRows, nisRow, probabilityRow, stateRow} from './time_rows.js';
import {runChoice, timeControls, timePlot, TimeState} from './timeview.js';

// Runs that both hold, with as many samples: the data are A's.
function commonRuns(data) {
  const [a, b] = data.runs.map((run) => (run.data ? run.data.runs : []));
  return a.flatMap((run) => {
    const same = (other) =>
        other.name === run.name && other.time.samples === run.time.samples && other.state.length === run.state.length;
    const other = b.find(same);
    return other ? [{...run, truth: null, pair: [run.filters.bank, other.filters.bank]}] : [];
  });
}

const layers = letters.map((letter, k) => ({
                             of: (run) => run.pair[k],
                             prefix: `${letter} `,
                             band: colours[k],
                             opacity: 0.2,
                             line: colours[k],
                             nis: colours[k],
                             stroke: {color: stroke(k).color, dash: stroke(k).dash},
                             symbol: symbols[k],
                           }));

export function drawData(data) {
  const runs = commonRuns(data);
  if (!runs.length) {
    section('data', 'Data and predictions', note('No run is in both archives with the same samples.'));
    return;
  }
  const place = data.runs[0].data, state = new TimeState(runs);
  const probabilities = () => layers.filter(({of}) => (of(state.current) || {}).probability)
                                  .map(({of, prefix}) => probabilityRow(of, `P(mode) ${prefix.trim()}`));
  const rows = () =>
      [...place.states.map((_, i) => stateRow(place, i, layers, 240)),
       nisRow(place, layers),
       ...probabilities(),
       ...inputRows(place),
  ];
  const label = 'State with the predictions of both banks, their NIS and their mode probabilities over time';
  const plot = timePlot(
      state, label, rows,
      `Bands: ${
          100 * place.level} % of each bank's prediction. Dashed lines at the NIS: both bounds of a true filter.`);
  section(
      'data', 'Data and predictions', pairLegend(data.runs, [[ink(), 'measured']]),
      controls(runChoice(state), timeControls(state)), plot);
}
