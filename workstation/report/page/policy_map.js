// Policy maps: decisions over SoC (across) and price (up), as on the edge's page, evaluated exactly
// (student.js), in time slices so that sliders stay responsive.
"use strict";

const kSliceMs = 20;
const kPaintEveryMs = 120;
const kCoarseRows = 8;       // row stride of the first pass
const kWindowRoundTo = 10;   // EUR/MWh
const kMargin = {left: 60, right: 14, top: 10, bottom: 38};  // CSS pixels around a map
const kMarkPx = 3;           // minimum size of a violation
const kHatchPx = 8;          // distance of hatching lines
const kFillAlpha = 0x55;     // of an action

/** Map of one student: canvas and grid. */
class StudentMap {
  constructor(name, student, host) {
    this.name = name;
    this.student = student;
    const figure = document.createElement("figure"), caption = document.createElement("figcaption");
    caption.textContent = name;
    this.canvas = document.createElement("canvas");
    this.canvas.className = "map";
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute(
      "aria-label", `Decisions of the ${name} over price and state of charge`);
    this.found = document.createElement("p");
    this.found.className = "found";
    figure.append(caption, this.canvas, this.found);
    host.append(figure);
  }
}

class PolicyMap {
  constructor(data) {
    this.data = data;
    this.lattice = data.lattice;
    const host = document.getElementById("maps");
    this.maps = data.students.map(
      ({name, net}) => new StudentMap(name, new Student(net, data.lattice), host));
    this.context = {contextClass: data.first_map.context_class,
                    quarterHour: data.first_map.quarter_hour,
                    minute: data.first_map.minute};
    this.marked = null;
    this.nextViolation = 0;
    this.rules = new RuleBoxes(data.rules || [], data.lattice, (context) => {
      this.context = context;
      this.marked = null;
      this.show();
    });
    if (this.maps.length === 0) {
      document.getElementById("policy").hidden = true;
      return;
    }
    this.decisions = this.decisionWindow(this.maps[0].student);
    this.window = this.decisions;
    this.bind();
    this.show();
  }

  bind() {
    const slider = (id, key) => document.getElementById(id).addEventListener("input", (event) => {
      this.context[key] = Number(event.target.value);
      this.marked = null;
      this.show();
    });
    slider("context-slider", "contextClass");
    slider("quarter-slider", "quarterHour");
    slider("minute-slider", "minute");
    bindChoice("window-choice", "window", (value) => this.setWindow(
      value === "all" ? {first: this.lattice.price_min, last: this.lattice.price_max}
      : this.decisions));
    for (const id of ["price-from", "price-to"]) {
      const input = document.getElementById(id);
      input.min = String(this.lattice.price_min);
      input.max = String(this.lattice.price_max);
      input.addEventListener("change", () => this.readWindow());
    }
    document.getElementById("next-violation").addEventListener("click", () => this.showViolation());
    for (const map of this.maps) {
      map.canvas.addEventListener("pointermove", (event) => this.tell(map, event));
      map.canvas.addEventListener("pointerdown", (event) => this.tell(map, event));
      map.canvas.addEventListener("pointerleave", () => this.point(null));
    }
    for (const button of document.querySelectorAll("[data-broken]")) {
      button.addEventListener("click", () => {
        this.showLatticeState(this.data.broken[Number(button.dataset.broken)]);
        document.getElementById("policy").scrollIntoView();
      });
    }
    new ResizeObserver(() => this.paint()).observe(document.getElementById("maps"));
  }

  /**
   * Price range of nearly all decision boundaries over classes, hours and SoCs.
   */
  decisionWindow(student) {
    const {price_min, price_max, soc_count} = this.lattice;
    const borders = [];
    for (let contextClass = 1; contextClass <= 12; ++contextClass) {
      for (let quarterHour = 0; quarterHour < 96; quarterHour += 8) {
        for (const share of [.2, .4, .6, .8]) {
          student.beginRow(
            {contextClass, quarterHour, minute: 7}, Math.round(share * (soc_count - 1)));
          for (const level of [1, 0]) {  // lowest price at which the action is at most this
            let low = price_min, high = price_max;
            while (low < high) {
              const middle = (low + high) >> 1;
              if (student.decideInRow(middle) <= level) high = middle; else low = middle + 1;
            }
            borders.push(low);
          }
        }
      }
    }
    borders.sort((a, b) => a - b);
    const at = (share) => borders[Math.round(share * (borders.length - 1))];
    const room = Math.max(kWindowRoundTo, .1 * (at(.98) - at(.02)));
    const round = (price) => Math.round(price / kWindowRoundTo) * kWindowRoundTo;
    return {first: Math.max(price_min, round(at(.02) - room)),
            last: Math.min(price_max, round(at(.98) + room))};
  }

  setWindow(window) {
    this.window = window;
    this.show();
  }

  readWindow() {
    const value = (id) => Math.round(Number(document.getElementById(id).value));
    const clamp = (price) =>
      Math.min(Math.max(price, this.lattice.price_min), this.lattice.price_max);
    const first = clamp(value("price-from")), last = clamp(value("price-to"));
    pressChoice("window-choice", "window", "");
    this.setWindow(first < last ? {first, last} : this.window);
  }

  /** Shows the next counterexample. */
  showViolation() {
    const state = this.data.counterexamples[this.nextViolation];
    this.nextViolation = (this.nextViolation + 1) % this.data.counterexamples.length;
    this.showLatticeState(state);
  }

  showLatticeState([minute, quarterHour, contextClass, soc, price]) {
    this.showState(
      {minute, quarterHour, contextClass, price, soc: soc / (this.lattice.soc_count - 1)});
  }

  /** Shows a state and marks its price and SoC. */
  showState({contextClass, quarterHour, minute, price, soc}) {
    this.context = {contextClass, quarterHour, minute};
    this.marked = {price, soc};
    if (price < this.window.first || price > this.window.last) {
      const half = Math.round((this.decisions.last - this.decisions.first) / 2);
      const clamp = (edge) =>
        Math.min(Math.max(edge, this.lattice.price_min), this.lattice.price_max);
      this.window = {first: clamp(Math.round(price) - half), last: clamp(Math.round(price) + half)};
      pressChoice("window-choice", "window", "");
    }
    this.show();
  }

  showControls() {
    const {contextClass, quarterHour, minute} = this.context;
    const set = (id, value) => { document.getElementById(id).value = String(value); };
    set("context-slider", contextClass);
    set("quarter-slider", quarterHour);
    set("minute-slider", minute);
    set("context-text", this.data.contexts[contextClass - 1]);
    set("quarter-text", clockText(quarterHour * 15));
    set("minute-text", clockText(quarterHour * 15 + minute));
    set("price-from", this.window.first);
    set("price-to", this.window.last);
    const count = this.data.counterexamples.length,
          button = document.getElementById("next-violation");
    button.hidden = count === 0;
    button.textContent =
      `violation of the ${this.data.counterexamples_of} ` +
      `(${this.nextViolation + 1} of ${count} kept)`;
    this.rules.showLegend(document.getElementById("rule-keys"), this.context, () => this.paint());
  }

  show() {
    this.showControls();
    this.work = this.maps.map((map) => this.evaluation(map));
    this.paintedAt = 0;
    for (const map of this.maps) map.canvas.dataset.complete = "false";
    if (!this.ticking) this.tick();
  }

  /** One time slice of work, repeated in the next frame until finished. */
  tick() {
    const end = performance.now() + kSliceMs;
    while (this.work.length > 0 && performance.now() < end) {
      if (this.work[0].next().done) this.work.shift();
    }
    this.ticking = this.work.length > 0;
    if (this.ticking) requestAnimationFrame(() => this.tick());
    if (!this.ticking || end - this.paintedAt > kPaintEveryMs) {
      this.paintedAt = end;
      this.paint();
    }
  }

  /** Evaluates one map by rows: every eighth first, then the others. */
  *evaluation(map) {
    const {first, last} = this.window, context = {...this.context}, rows = this.lattice.soc_count;
    const width = last - first + 1, grid = new Int8Array(rows * width).fill(-1);
    const nextGrids = {};
    map.grid = grid;
    map.window = this.window;
    map.violations = null;
    const evaluateInto = (cells, at, soc) => {
      map.student.beginRow(at, soc);
      for (let column = 0; column < width; ++column) {
        cells[soc * width + column] = map.student.decideInRow(first + column);
      }
    };
    const evaluate = (soc) => evaluateInto(grid, context, soc);
    for (let soc = 0; soc < rows; soc += kCoarseRows) {
      evaluate(soc);
      yield;
    }
    for (let soc = 0; soc < rows; ++soc) {
      if (soc % kCoarseRows === 0) continue;
      evaluate(soc);
      yield;
    }
    for (const {direction: {input}} of this.rules.pairRules()) {
      const next = this.rules.nextContext(context, input);
      if (!next || nextGrids[input]) continue;
      nextGrids[input] = new Int8Array(rows * width);
      for (let soc = 0; soc < rows; ++soc) {
        evaluateInto(nextGrids[input], next, soc);
        yield;
      }
    }
    map.violations = violationsOf(grid, width, first, this.data.thresholds);
    map.violations.rules = this.rules.violations(grid, map.window, context, nextGrids);
    this.describe(map);
    map.canvas.dataset.complete = "true";
  }

  describe(map) {
    const {order, threshold, rules} = map.violations;
    const found = [[order.length, "neighbouring pairs out of order"],
                   [threshold.length, "states that violate a threshold"],
                   ...rules.map(({rule, cells}) =>
                     [cells.length, `states against \u201c${rule.name}\u201d`])];
    const some = found.filter(([count]) => count > 0);
    map.found.textContent = some.length === 0 ? "no violation in this range"
      : some.map(([count, what]) => `${count} ${what}`).join(", ");
    map.found.classList.toggle("some", some.length > 0);
  }

  /** Geometry of a canvas. */
  frame(map) {
    const width = map.canvas.clientWidth, height = map.canvas.clientHeight;
    const plot = {x: kMargin.left, y: kMargin.top, w: width - kMargin.left - kMargin.right,
                  h: height - kMargin.top - kMargin.bottom};
    const {first, last} = map.window, prices = last - first + 1, socs = this.lattice.soc_count;
    return {width, height, plot, prices, socs, cellW: plot.w / socs, cellH: plot.h / prices,
            xOf: (soc) => plot.x + (soc + .5) / socs * plot.w,
            yOf: (price) => plot.y + plot.h - (price - first + .5) / prices * plot.h};
  }

  paint() {
    for (const map of this.maps) if (map.grid && map.canvas.clientWidth > 0) this.paintMap(map);
  }

  paintMap(map) {
    const frame = this.frame(map), ratio = devicePixelRatio || 1, canvas = map.canvas;
    canvas.width = Math.round(frame.width * ratio);
    canvas.height = Math.round(frame.height * ratio);
    const ctx = canvas.getContext("2d");
    ctx.scale(ratio, ratio);
    this.paintCells(ctx, map, frame);
    if (map.violations) {
      this.paintBrokenRules(ctx, map, frame);
      this.paintViolations(ctx, map, frame);
    }
    this.rules.paint(ctx, frame, map.window, this.context);
    this.paintAxes(ctx, map, frame);
    if (this.marked) this.paintMarked(ctx, frame);
  }

  paintCells(ctx, map, {plot, prices, socs}) {
    const cells = new OffscreenCanvas(socs, prices), image = new ImageData(socs, prices);
    const pixels = new Uint32Array(image.data.buffer);
    const inks = kActions.map((name) => name === "idle" ? 0 : pixelOf(colour(name), kFillAlpha));
    for (let soc = 0; soc < socs; ++soc) {
      // The nearest evaluated SoC.
      const from = map.grid[soc * prices] < 0 ? soc - soc % kCoarseRows : soc;
      for (let price = 0; price < prices; ++price) {
        const action = map.grid[from * prices + price];
        if (action >= 0) pixels[(prices - 1 - price) * socs + soc] = inks[action];
      }
    }
    cells.getContext("2d").putImageData(image, 0, 0);
    ctx.imageSmoothingEnabled = false;
    ctx.drawImage(cells, plot.x, plot.y, plot.w, plot.h);
  }

  /** Hatching of states that break a rule; the action stays visible. */
  paintBrokenRules(ctx, map, {plot, prices, socs}) {
    if (map.violations.rules.length === 0) return;
    const cells = new OffscreenCanvas(socs, prices), image = new ImageData(socs, prices);
    const pixels = new Uint32Array(image.data.buffer), ink = pixelOf("#000000");
    for (const {cells: broken} of map.violations.rules) {
      for (const cell of broken)
        pixels[(prices - 1 - cell % prices) * socs + Math.floor(cell / prices)] = ink;
    }
    cells.getContext("2d").putImageData(image, 0, 0);
    const ratio = devicePixelRatio || 1;
    const lines = new OffscreenCanvas(Math.ceil(plot.w * ratio), Math.ceil(plot.h * ratio)),
          pen = lines.getContext("2d");
    pen.scale(ratio, ratio);
    pen.strokeStyle = colour("mark");
    pen.lineWidth = 1.5;
    pen.beginPath();
    for (let at = -plot.h; at < plot.w; at += kHatchPx) {
      pen.moveTo(at, plot.h);
      pen.lineTo(at + plot.h, 0);
    }
    pen.stroke();
    pen.globalCompositeOperation = "destination-in";
    pen.imageSmoothingEnabled = false;
    pen.drawImage(cells, 0, 0, plot.w, plot.h);
    ctx.drawImage(lines, plot.x, plot.y, plot.w, plot.h);
  }

  paintViolations(ctx, map, {plot, cellW, cellH, prices}) {
    ctx.save();
    ctx.beginPath();
    ctx.rect(plot.x, plot.y, plot.w, plot.h);
    ctx.clip();
    ctx.fillStyle = colour("mark");
    const w = Math.max(cellW, kMarkPx), h = Math.max(cellH, kMarkPx);
    const fill = (x, y) => ctx.fillRect(x - w / 2, y - h / 2, w, h);
    const left = (soc) => plot.x + soc * cellW,
          top = (column) => plot.y + (prices - 1 - column) * cellH;
    for (const {soc, column, towards} of map.violations.order) {  // on the border between the two
      fill(
        left(soc) + (towards === "soc" ? cellW : cellW / 2),
        top(column) + (towards === "price" ? 0 : cellH / 2));
    }
    for (const {soc, column} of map.violations.threshold)
      fill(left(soc) + cellW / 2, top(column) + cellH / 2);
    ctx.restore();
  }

  paintAxes(ctx, map, {plot, xOf, yOf}) {
    ctx.strokeStyle = colour("muted");
    ctx.lineWidth = 1;
    ctx.strokeRect(plot.x, plot.y, plot.w, plot.h);
    ctx.fillStyle = colour("muted");
    ctx.font = "12px system-ui, sans-serif";
    ctx.textAlign = "right";
    ctx.textBaseline = "middle";
    const {first, last} = map.window, step = niceStep((last - first) / (plot.h / 40));
    for (let price = Math.ceil(first / step) * step; price <= last; price += step) {
      ctx.fillText(trueMinus(price), plot.x - 6, yOf(price));
      ctx.fillRect(plot.x - 4, yOf(price) - .5, 4, 1);
    }
    ctx.textAlign = "center";
    ctx.textBaseline = "top";
    for (const percent of [0, 25, 50, 75, 100])
      ctx.fillText(percent, xOf(percent / 100 * (this.lattice.soc_count - 1)), plot.y + plot.h + 5);
    ctx.fillText("state of charge, %", plot.x + plot.w / 2, plot.y + plot.h + 20);
    ctx.save();
    ctx.translate(2, plot.y + plot.h / 2);
    ctx.rotate(-Math.PI / 2);
    ctx.fillText("price, EUR/MWh", 0, 0);
    ctx.restore();
    ctx.setLineDash([4, 4]);
    ctx.strokeStyle = colour("ink");
    const reserve = xOf(this.data.battery.soc_min * (this.lattice.soc_count - 1));
    ctx.beginPath();
    ctx.moveTo(reserve, plot.y);
    ctx.lineTo(reserve, plot.y + plot.h);
    ctx.stroke();
    ctx.setLineDash([]);
  }

  paintMarked(ctx, {xOf, yOf}) {
    const x = xOf(this.marked.soc * (this.lattice.soc_count - 1)), y = yOf(this.marked.price);
    for (const [ink, width] of [[colour("paper"), 5], [colour("ink"), 2]]) {
      ctx.strokeStyle = ink;
      ctx.lineWidth = width;
      ctx.beginPath();
      ctx.arc(x, y, 7, 0, 2 * Math.PI);
      ctx.stroke();
    }
  }

  /** Shows the actions at the pointer. */
  tell(map, event) {
    const {plot, prices, socs} = this.frame(map);
    const soc = Math.floor((event.offsetX - plot.x) / plot.w * socs);
    const column = prices - 1 - Math.floor((event.offsetY - plot.y) / plot.h * prices);
    if (column < 0 || column >= prices || soc < 0 || soc >= socs) {
      this.point(null);
      return;
    }
    const price = map.window.first + column;
    const actions = this.maps.map(
      ({name, student}) => `${name}: ${kActions[student.decide(this.context, soc, price)]}`);
    const rules = this.rules.atState(this.context, soc, price);
    const names = rules.map(({number, name}) => `${number} ${name}`);
    document.getElementById("map-readout").textContent =
      `${trueMinus(price)} EUR/MWh at ${(100 * soc / (socs - 1)).toFixed(1)} %: ` +
      actions.join(", ") +
      (names.length > 0 ? `. Rules that apply: ${names.join(", ")}` : "");
    this.point(rules.length > 0 ? rules.at(-1) : null);
  }

  /** Highlights a rule; null: none. */
  point(rule) {
    if (rule === this.rules.pointed) return;
    this.rules.pointed = rule;
    this.paint();
  }
}

/** Little-endian pixel value of "#rrggbb". */
function pixelOf(hex, alpha = 255) {
  const [red, green, blue] = [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
  return (alpha << 24 | blue << 16 | green << 8 | red) >>> 0;
}

/** Legend of the maps. */
function showMapKeys(hasRules) {
  const faint = (name) =>
    `color-mix(in srgb, var(--${name}) ${100 * kFillAlpha / 255}%, transparent)`;
  const keys = [[faint("charge"), "charge"], ["transparent", "idle"],
                [faint("discharge"), "discharge"], ["var(--mark)", "violation"],
                ["", "dashed line: minimum SoC"],
                ...(hasRules ? [["", "outlined with number: region of a rule, dashed if only " +
                                     "the guard enforces it; hatched: violations"]] : [])];
  document.getElementById("map-keys").replaceChildren(...keys.map(([background, text]) => {
    const item = document.createElement("li");
    if (background) {
      const swatch = document.createElement("i");
      swatch.style.background = background;
      item.append(swatch);
    }
    item.append(text);
    return item;
  }));
}
