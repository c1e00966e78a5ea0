// The panels of a chart as SVG: axes with titles, and the marks inside.
import {line_px, text_px} from './chart_layout.js';
import {markShapes} from './chart_marks.js';
import {s} from './elements.js';

let clips = 0;

const lines = (texts, x, y, attributes) =>
    s('text', {x, y, ...attributes}, texts.map((text, i) => s('tspan', {x, dy: i ? line_px : 0}, text)));

function axes({panel, across, ticks, tilt, up, deep, titles, side, left, at, to}) {
  const floor = at.y + at.height, end = at.x + at.width, sideX = at.x - left + text_px, middle = at.y + at.height / 2;
  const flat = (y) => Math.round(y) + 0.5;
  const grid = [
    ...up.ticks.map(({at: v}) => `M${at.x} ${flat(to.y(v))}H${end}`),
    ...across.ticks.map(({at: v}) => `M${flat(to.x(v))} ${at.y}V${floor + 4}`),
  ];
  const below = (v) => {
    const x = to.x(v), y = floor + 6 + text_px - (tilt ? 4 : 0);
    if (!tilt) return {x, y, 'text-anchor': 'middle'};
    return {x, y, 'text-anchor': 'end', transform: `rotate(-45 ${x} ${y - 4})`};
  };
  return [
    s('path', {d: grid.join(''), class: 'grid'}),
    up.ticks.map(({at: v, text}) => s('text', {x: at.x - 6, y: to.y(v) + 4, 'text-anchor': 'end'}, text)),
    ticks.map(({at: v, text}) => s('text', below(v), text)),
    lines(titles, at.x + at.width / 2, floor + 6 + deep + text_px, {'text-anchor': 'middle', class: 'axis-title'}),
    lines(side, sideX, middle, {
      'text-anchor': 'middle',
      class: 'axis-title',
      transform: `rotate(-90 ${sideX} ${middle})`,
    }),
    panel.title ? s('text', {x: at.x, y: at.y - 6, class: 'panel-title'}, panel.title) : null,
  ];
}

function panelShapes(placed) {
  const {panel, at, to} = placed, id = `frame${++clips}`;
  return s(
      'g', {}, axes(placed), s('clipPath', {id}, s('rect', {...at})),
      s('g', {'clip-path': `url(#${id})`}, panel.marks.map((mark) => markShapes(mark, to, at))));
}

/** The SVG of the parts that layoutOf() placed. */
export function drawChart({width, height, panels}) {
  return s('svg', {viewBox: `0 0 ${width} ${height}`, 'aria-hidden': 'true'}, panels.map(panelShapes));
}
