/** Shapes as SVG, in CSS pixels. As logic/drawing/canvas.py, whose boxes, points and words these are. */

/** Half the height of a capital letter, in font sizes. */
const ASCENT = 0.36;

const fixed = (value) => value.toFixed(1);
const listed = (points) => points.map((point) => point.map(fixed).join(",")).join(" ");
const escaped = (words) => words.replace(/[&<>"']/g, (letter) => `&#${letter.charCodeAt(0)};`);
const paint = (fill, stroke = "", width = 1) =>
  `fill="${fill || "none"}"${stroke && ` stroke="${stroke}" stroke-width="${Number(width.toPrecision(2))}"`}`;

export const part = (name, shapes) => `<g data-part="${escaped(name)}">${shapes.join("")}</g>`;

export const block = ([x0, y0, x1, y1], fill, stroke = "", width = 1, radius = 0) =>
  `<rect x="${fixed(x0)}" y="${fixed(y0)}" width="${fixed(x1 - x0)}" height="${fixed(y1 - y0)}" rx="${fixed(radius)}" ${paint(fill, stroke, width)}/>`;

export const oval = ([x0, y0, x1, y1], stroke, width) =>
  `<ellipse cx="${fixed((x0 + x1) / 2)}" cy="${fixed((y0 + y1) / 2)}" rx="${fixed((x1 - x0) / 2)}" ry="${fixed((y1 - y0) / 2)}" ${paint("", stroke, width)}/>`;

export const line = (points, stroke, width) => `<polyline points="${listed(points)}" ${paint("", stroke, width)}/>`;

export const curve = ([first, ...others], stroke, width) =>
  `<path d="M${listed([first])}C${listed(others)}" ${paint("", stroke, width)}/>`;

/** All that any of these boxes covers, as one path, so that no joint shows. */
export const union = (boxes, fill) =>
  `<path d="${boxes.map(([x0, y0, x1, y1]) => `M${listed([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])}Z`).join("")}" fill="${fill}"/>`;

/** Words whose middle stands at a height; `halo`: a rim in another colour. */
export function text([x, y], words, size, fill, anchor = "middle", halo = "") {
  const place = `x="${fixed(x)}" y="${fixed(y + ASCENT * size)}" font-size="${Number(size.toPrecision(6))}" text-anchor="${anchor}" pointer-events="none"`;
  const rim = `${paint(fill, halo, size / 4)} paint-order="stroke" stroke-linejoin="round"`;
  return `<text ${place} ${halo ? rim : paint(fill)}>${escaped(words)}</text>`;
}

/** How wide words are; `widths`: of letters in font sizes, and what is added for pairs of them. */
export const widthOf = (widths) => (words, size) => [...words].reduce((sum, letter, place, all) =>
  sum + (widths[letter] ?? widths.m) + (widths[letter + all[place + 1]] ?? 0), 0) * size;
