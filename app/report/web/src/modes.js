// The modes of a bank in the order of the page's lists: by motion, the most used motion first. Rarely used motions
// form one entry.
import {legend} from './elements.js';
import {modeColour, palette} from './look.js';

/** Rows of the modes listed one by one, and those of the others. */
export function byUse(bank) {
  const rows = bank.order.map((k) => bank.modes[k]);
  return {told: rows.slice(0, bank.told), others: rows.slice(bank.told)};
}

/** The motions that stand one by one, each with `lead`, its most used mode, and those of the others. */
export function motionsOf(bank) {
  const all = bank.motions.map((motion) => ({...motion, lead: motion.modes[0]}));
  return {told: all.slice(0, bank.told_motions), others: all.slice(bank.told_motions)};
}

/** Whether some motion has several modes. */
export const hasLevels = (bank) => bank.motions.length < bank.modes.length;

export const othersName = (count) => `${count} other${count === 1 ? '' : 's'}`;

/** The legend of a bank; `bank` may be missing. */
export function modeLegend(bank) {
  if (!bank || bank.modes.length < 2) return null;
  const {told, others} = motionsOf(bank);
  const rest = others.length ? [[palette.unclustered, othersName(others.length)]] : [];
  return legend([...told.map(({lead, title}) => [modeColour(lead), title]), ...rest], 'Colours of modes');
}
