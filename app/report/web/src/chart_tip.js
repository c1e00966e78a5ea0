// Tips for the point nearest to the pointer, and clicks on this point.
import {h} from './elements.js';

const near_px = 14;

let shared = null;
function tip() {
  if (!shared) {
    shared = h('div', {class: 'tip', hidden: true});
    document.body.append(shared);
  }
  return shared;
}

function show(event, said) {
  const label = tip();
  label.replaceChildren(...[].concat(said).map((line) => h('div', {}, line)));
  label.hidden = false;
  label.style.left = `${Math.max(4, Math.min(event.clientX + 14, innerWidth - label.offsetWidth - 8))}px`;
  label.style.top = `${Math.min(event.clientY + 14, innerHeight - label.offsetHeight - 8)}px`;
}

// Distance between a point of a mark and a pixel; 0 inside a bar or a cell.
function distance({kind, x, y, width}, i, px, py, to) {
  if (y[i] === null) return Infinity;
  if (kind === 'bars') return Math.abs(to.x(x[i]) - px) <= Math.abs(to.x(width) - to.x(0)) / 2 ? 0 : Infinity;
  return Math.hypot(to.x(x[i]) - px, to.y(y[i]) - py);
}

// The cell at a pixel as {mark, i}. The index i counts cells row by row.
function cellAt(mark, px, py, to) {
  const next = (list, toPixel, at) =>
      list.reduce((best, v, k) => (Math.abs(toPixel(v) - at) < Math.abs(toPixel(list[best]) - at) ? k : best), 0);
  return {mark, i: next(mark.y, to.y, py) * mark.x.length + next(mark.x, to.x, px)};
}

/** The point with a tip that is nearest to a pixel: {mark, i} or null. */
export function pointAt(panels, px, py) {
  const inside = ({at}) => px >= at.x - 4 && px <= at.x + at.width + 4 && py >= at.y && py <= at.y + at.height;
  const placed = panels.find(inside);
  if (!placed) return null;
  const {to, panel} = placed, telling = panel.marks.filter((mark) => mark.tip);
  let best = null, least = near_px;
  for (const mark of telling.filter(({kind}) => kind !== 'cells')) {
    for (let i = 0; i < mark.x.length; ++i) {
      const away = distance(mark, i, px, py, to);
      if (away < least) {
        least = away;
        best = {mark, i};
      }
    }
  }
  const grid = telling.find(({kind}) => kind === 'cells');
  return best || (grid ? cellAt(grid, px, py, to) : null);
}

export function readPoints(svg, {width, panels}) {
  const under = (event) => {
    const box = svg.getBoundingClientRect(), scale = width / box.width;
    return pointAt(panels, (event.clientX - box.left) * scale, (event.clientY - box.top) * scale);
  };
  const tell = (event) => {
    const found = under(event);
    svg.style.cursor = found && found.mark.pick ? 'pointer' : '';
    if (found) {
      show(event, found.mark.tip(found.i));
    } else {
      tip().hidden = true;
    }
    return found;
  };
  svg.addEventListener('pointermove', tell);
  svg.addEventListener('pointerleave', () => {
    tip().hidden = true;
  });
  svg.addEventListener('click', (event) => {
    const found = tell(event);
    if (found && found.mark.pick) found.mark.pick(found.i);
  });
}
