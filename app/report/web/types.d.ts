// Types of Debian's modules, which have none themselves.
interface Uint8ArrayConstructor { fromBase64?(text: string): Uint8Array; }
declare class DecompressionStream implements GenericTransformStream {
  constructor(format: string);
  readonly readable: ReadableStream;
  readonly writable: WritableStream;
}

declare module 'd3-path' {
  export function path(): import('./src/pens.js').PathContext & {toString(): string};
}

interface D3Scale {
  (value: number): number;
  invert(pixel: number): number;
  domain(range: [number, number]): this;
  range(pixels: [number, number]): this;
  clamp(on: boolean): this;
  ticks(count: number): number[];
  tickFormat(count: number): (value: number) => string;
}
declare module 'd3-scale/src/linear.js' { export default function linear(): D3Scale; }
declare module 'd3-scale/src/log.js' { export default function log(): D3Scale; }
