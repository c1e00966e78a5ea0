// The section that answers whether the best setting of a study is better than the next settings.
import {h} from './elements.js';
import {section} from './page.js';
import {table} from './table.js';

const verdicts = {
  worse: 'worse than the best',
  better: 'better than the best',
  'cannot tell': 'cannot be told from the best',
  'the same': 'as good (less than 0.001 apart)',
};

function settingColumn(study) {
  return study.varied.map(({key}, i) => ({name: key, text: true, of: (rival) => rival.varied[i]}));
}

function columnsOf(study, showRun) {
  const show = (rival) => h(
      'button', {type: 'button', 'aria-label': `Show run ${rival.row}`, onclick: () => showRun(study.rows[rival.row])},
      `run ${rival.row}`);
  return [
    {name: 'Best is ahead by [nats/sample]', of: (rival) => rival.gain},
    {name: 'needed for 95 %', of: (rival) => rival.margin},
    {name: 'It is', text: true, of: (rival) => verdicts[rival.verdict] || rival.verdict},
    ...settingColumn(study),
    {name: 'error from', text: true, of: (rival) => rival.by},
    {name: 'Look', text: true, of: show},
  ];
}

// A sentence that summarises the table.
function sentence({rivals, settings}) {
  const undecided = rivals.filter((rival) => rival.verdict !== 'worse').length;
  const all = settings - 1 > rivals.length ? `the next ${rivals.length} of ${settings - 1} settings` :
                                             `the other ${rivals.length} settings`;
  if (undecided === 0) return `The best setting is better than ${all}, by more than chance explains.`;
  return `Of ${all}, ${
      undecided} cannot be told from the best: choose among them by what else matters, e.g. fewer modes.`;
}

export function drawBetter(study, showRun) {
  const {better} = study, title = 'Is the best better?';
  if (!better) {
    section('better', title, h('p', {}, 'Fewer than two settings have a score.'));
    return;
  }
  const how =
      'Differences of the log score, each sample against the same sample; the error is clustered by run (of the ' +
      'first repeat), so that a long run counts once. The gain is the mean over repeats; their variance is in the ' +
      'error. The best setting was chosen by these same scores, so its score ' +
      'is a little too good.';
  section(
      'better', title, h('p', {class: 'verdict'}, sentence(better)),
      table(columnsOf(study, showRun), better.rivals, {caption: 'The next best settings against the best'}),
      h('p', {class: 'caption'}, how));
}
