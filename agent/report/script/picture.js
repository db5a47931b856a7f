/* ---- the picture of an episode at a step ---- */

const HEADINGS = [[1, 0], [1, -1], [0, -1], [-1, -1], [-1, 0], [-1, 1], [0, 1], [1, 1]];
const SOUGHT = 1; // goal_kind: a viewpoint; 2: where it believes the target to be
const FORWARD = 2;

/** Colours of a map's ground, as red, green, blue and how much hides the house. */
const GROUND = [[70, 78, 92, 150], [110, 165, 215, 95], [255, 255, 255, 0], [25, 30, 38, 215]];
const BELIEF = [18, 148, 86];
const COLOURS = {
  ray: "rgb(84 108 140 / 50%)", fan: "rgb(84 108 140 / 12%)", hit: "#e07a14", path: "#1f5ea8", body: "#1f5ea8",
  target: "#f5b22d", edge: "#8a5a04", view: "#8c46a0", veto: "#c22a3c",
};

/** Draws on the canvas over a plan; Episode says of what. */
class EpisodePicture {
  /** The eye's place at a state, metres. */
  eye(t) {
    const { origin, sensor } = this.trace;
    const shift = this.heading[t] % 2 ? sensor.eye[1] - sensor.eye[0] : 0;
    return [origin[0] + this.east[t] * sensor.step + shift, origin[1] + this.south[t] * sensor.step + shift];
  }

  /** The place in the map's pictures of what it knew at a state. */
  frame(t) {
    return Math.min(Math.floor(Math.min(t, this.trace.length - 1) / this.trace.map.every), this.map.count - 1);
  }

  draw() {
    const box = this.stage.getBoundingClientRect();
    const density = window.devicePixelRatio || 1;
    const [width, height] = [Math.round(box.width * density), Math.round(box.height * density)];
    if (!width || !height) return;
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    const pen = this.canvas.getContext("2d");
    const shown = (layer) => this.layers[layer].checked;
    const zoom = this.plan.getBoundingClientRect().width / this.width;
    this.plan.style.visibility = "visible";
    if (!shown("house")) this.plan.style.visibility = "hidden";
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, width, height);
    // From here on lengths are metres, as the house has them.
    const px = density * zoom;
    pen.setTransform(px * this.scale, 0, 0, px * this.scale, px * this.left, px * this.top);
    pen.lineJoin = pen.lineCap = "round";
    if (shown("map")) this.drawMap(pen);
    if (shown("belief")) this.drawBelief(pen);
    if (shown("target")) this.drawTarget(pen);
    if (shown("path")) this.drawPath(pen);
    if (shown("vetoes")) this.drawVetoes(pen);
    if (shown("rays")) this.drawRays(pen);
    if (shown("goal")) this.drawGoal(pen);
    this.drawBody(pen);
  }

  /** A picture of cells: ``colour`` gives red, green, blue and alpha of a value. */
  drawCells(pen, values, colour) {
    const { map } = this.trace;
    const [, height, width] = map.ground.shape;
    const image = new ImageData(width, height);
    const from = this.frame(this.step) * width * height;
    for (let k = 0; k < width * height; k++) image.data.set(colour(values[from + k]), 4 * k);
    this.cells ??= made("canvas");
    Object.assign(this.cells, { width, height });
    this.cells.getContext("2d").putImageData(image, 0, 0);
    pen.imageSmoothingEnabled = false;
    pen.drawImage(this.cells, map.west, map.north, width * map.cell, height * map.cell);
  }

  drawMap(pen) {
    this.drawCells(pen, this.map.ground, (kind) => GROUND[kind]);
  }

  drawBelief(pen) {
    this.drawCells(pen, this.map.belief, (count) => [...BELIEF, count && 30 + 1.3 * count]);
  }

  drawTarget(pen) {
    const [x, y] = this.trace.targets[this.found[this.step]];
    const side = this.trace.sensor.target;
    pen.fillStyle = COLOURS.target;
    pen.strokeStyle = COLOURS.edge;
    pen.lineWidth = 0.03;
    pen.fillRect(x - side / 2, y - side / 2, side, side);
    pen.strokeRect(x - side / 2, y - side / 2, side, side);
  }

  drawPath(pen) {
    pen.beginPath();
    for (let t = 0; t <= this.step; t++) pen.lineTo(...this.eye(t));
    pen.strokeStyle = COLOURS.path;
    pen.globalAlpha = 0.55;
    pen.lineWidth = 0.04;
    pen.stroke();
    pen.globalAlpha = 1;
  }

  drawVetoes(pen) {
    pen.strokeStyle = COLOURS.veto;
    for (const t of this.vetoes) {
      if (t > this.step) break;
      const [x, y] = this.eye(t);
      const arm = t === this.step ? 0.3 : 0.1;
      pen.lineWidth = t === this.step ? 0.08 : 0.035;
      const heading = HEADINGS[this.heading[t]];
      const ahead = this.wanted[t] === FORWARD ? 0.3 / Math.hypot(...heading) : 0;
      const [u, v] = [x + heading[0] * ahead, y + heading[1] * ahead];
      pen.beginPath();
      pen.moveTo(u - arm, v - arm);
      pen.lineTo(u + arm, v + arm);
      pen.moveTo(u - arm, v + arm);
      pen.lineTo(u + arm, v - arm);
      pen.stroke();
    }
  }

  drawRays(pen) {
    const { sensor } = this.trace;
    const [x, y] = this.eye(this.step);
    const bytes = Math.ceil(sensor.rays / 8);
    const ends = Array.from({ length: sensor.rays }, (_, ray) => {
      const angle = ((45 * this.heading[this.step] + sensor.first_ray - sensor.ray_spacing * ray) * Math.PI) / 180;
      const far = (this.distance[this.step * sensor.rays + ray] / 65535) * sensor.range;
      const hits = (this.hits[this.step * bytes + (ray >> 3)] >> (7 - (ray & 7))) & 1;
      return [x + Math.cos(angle) * far, y - Math.sin(angle) * far, hits];
    });
    pen.beginPath();
    pen.moveTo(x, y);
    for (const [u, v] of ends) pen.lineTo(u, v);
    pen.closePath();
    pen.fillStyle = COLOURS.fan;
    pen.fill();
    for (const [u, v, hits] of ends) {
      pen.beginPath();
      pen.moveTo(x, y);
      pen.lineTo(u, v);
      pen.strokeStyle = hits ? COLOURS.hit : COLOURS.ray;
      pen.lineWidth = hits ? 0.03 : 0.015;
      pen.stroke();
    }
  }

  drawGoal(pen) {
    const t = Math.min(this.step, this.trace.length - 1);
    const kind = this.goal_kind[t];
    if (!kind) return;
    const [x, y] = [this.goal[2 * t] / 100, this.goal[2 * t + 1] / 100];
    pen.strokeStyle = kind === SOUGHT ? COLOURS.view : COLOURS.edge;
    pen.lineWidth = 0.06;
    pen.setLineDash([0.15, 0.12]);
    pen.beginPath();
    pen.moveTo(...this.eye(this.step));
    pen.lineTo(x, y);
    pen.stroke();
    pen.setLineDash([]);
    pen.beginPath();
    pen.arc(x, y, 0.2, 0, 2 * Math.PI);
    pen.stroke();
    pen.beginPath();
    pen.arc(x, y, 0.06, 0, 2 * Math.PI);
    pen.fillStyle = pen.strokeStyle;
    pen.fill();
  }

  drawBody(pen) {
    const { sensor } = this.trace;
    const diagonal = this.heading[this.step] % 2;
    const [x, y] = this.eye(this.step);
    const side = sensor.body[diagonal];
    const [west, north] = [x - sensor.eye[diagonal], y - sensor.eye[diagonal]];
    pen.fillStyle = COLOURS.body;
    pen.strokeStyle = "#ffffff";
    pen.lineWidth = 0.025;
    pen.fillRect(west, north, side, side);
    pen.strokeRect(west, north, side, side);
    pen.save();
    pen.translate(west + side / 2, north + side / 2);
    pen.rotate((-this.heading[this.step] * Math.PI) / 4);
    pen.beginPath();
    pen.moveTo(0.4 * side, 0);
    pen.lineTo(-0.25 * side, 0.3 * side);
    pen.lineTo(-0.25 * side, -0.3 * side);
    pen.closePath();
    pen.fillStyle = "#ffffff";
    pen.fill();
    pen.restore();
  }
}
