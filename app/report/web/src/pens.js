// A pen that draws time plots on a canvas. A path is a function that calls moveTo, lineTo, arc, rect, ... on its
// argument.
const font = 'system-ui, "Segoe UI", "DejaVu Sans", sans-serif';
const dashes = {
  dash: [6, 4],
  dot: [2, 3]
};

/**
 * @typedef {{moveTo: (x: number, y: number) => void, lineTo: (x: number, y: number) => void, closePath: () => void,
 *   arc: (x: number, y: number, r: number, from: number, to: number) => void,
 *   rect: (x: number, y: number, w: number, h: number) => void}} PathContext
 * @typedef {(context: PathContext) => void} Path
 * @typedef {{colour: string, width?: number, dash?: 'dash'|'dot'}} Stroke
 * @typedef {{x: number, y: number, width: number, height: number}} Box
 * @typedef {{colour: string, size?: number, align?: 'left'|'center'|'right', bold?: boolean}} TextLook
 * @typedef {{line: (path: Path, look: Stroke) => void, area: (path: Path, colour: string) => void,
 *   boxes: (boxes: ArrayLike<number>, colour: string) => void,
 *   text: (text: string, x: number, y: number, look: TextLook) => number,
 *   within: (box: Box, body: () => void) => void}} Pen
 */

/**
 * @param {CanvasRenderingContext2D} context
 * @returns {Pen}
 */
export function canvasPen(context) {
  const drawn = (path) => {
    context.beginPath();
    path(context);
  };
  return {
    line: (path, {colour, width = 1, dash}) => {
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.setLineDash(dashes[dash] || []);
      drawn(path);
      context.stroke();
    },
    area: (path, colour) => {
      context.fillStyle = colour;
      drawn(path);
      context.fill();
    },
    // The pieces are many small paths. A single path with all pieces would take the browser ten times as long or more.
    boxes: (boxes, colour) => {
      context.fillStyle = colour;
      for (let i = 0; i < boxes.length; i += 4) context.fillRect(boxes[i], boxes[i + 1], boxes[i + 2], boxes[i + 3]);
    },
    text: (text, x, y, {colour, size = 11, align = 'left', bold}) => {
      context.font = `${bold ? 'bold ' : ''}${size}px ${font}`;
      context.fillStyle = colour;
      context.textAlign = align;
      context.fillText(text, x, y);
      return context.measureText(text).width;
    },
    within: ({x, y, width, height}, body) => {
      context.save();
      drawn((it) => it.rect(x, y, width, height));
      context.clip();
      body();
      context.restore();
    },
  };
}
