// The modes of a bank as the page's sections list them: most used first, those hardly used as one.
import {legend} from './elements.js';
import {modeColour, palette} from './look.js';
import {modeTitle} from './mode_names.js';

/** Rows of the modes listed one by one, and those of the others. */
export function byUse(bank) {
  const rows = bank.order.map((k) => bank.modes[k]);
  return {told: rows.slice(0, bank.told), others: rows.slice(bank.told)};
}

export const othersName = (count) => `${count} other${count === 1 ? '' : 's'}`;

/** The legend of a bank; `bank` may be missing. */
export function modeLegend(bank) {
  if (!bank || bank.modes.length < 2) return null;
  const {told, others} = byUse(bank);
  const rest = others.length ? [[palette.unclustered, othersName(others.length)]] : [];
  return legend([...told.map(({mode}) => [modeColour(mode), modeTitle(mode)]), ...rest], 'Colours of modes');
}
