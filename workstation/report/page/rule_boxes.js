// Operator rules on the maps: region, violations and legend (rules_json() in page_data.h).
"use strict";

const kRuleBadgePx = 16;
// Directions across maps.
const kHeldByAPair = ["minute", "quarterHour", "contextClass"];

class RuleBoxes {
  /** `show(context)` opens another map. */
  constructor(rules, lattice, show) {
    this.rules = rules.map((rule, i) => ({...rule, number: i + 1}));
    this.lattice = lattice;
    this.show = show;
    this.pointed = null;  // rule under the pointer
  }

  /** True if a rule applies at this hour and context class. */
  isAt(rule, {quarterHour, contextClass}) {
    if (!rule.hours) return false;
    const [first, count] = rule.hours, since = (quarterHour - first + 96) % 96;
    return since < count && (rule.classes >> (contextClass - 1) & 1) === 1;
  }

  /** Rules with a region on this map. */
  at(context) {
    return this.rules.filter((rule) => rule.price && this.isAt(rule, context));
  }

  /** Rules of this map that apply at a price and SoC. */
  atState(context, soc, price) {
    return this.at(context).filter((rule) => price >= rule.price[0] && price <= rule.price[1] &&
                                             soc >= rule.soc[0] && soc <= rule.soc[1]);
  }

  /**
   * Rules that compare this map with that of the next minute, quarter-hour or class.
   */
  pairRules() {
    return this.rules.filter((rule) =>
      rule.binds_student && rule.direction && kHeldByAPair.includes(rule.direction.input));
  }

  /** Next context along an input; null after its last value. */
  nextContext(context, input) {
    const last = {minute: 14, quarterHour: 95, contextClass: 12}[input];
    return context[input] === last ? null : {...context, [input]: context[input] + 1};
  }

  /**
   * Cells with violations, by rule: [{rule, cells}], without empty ones. `nextGrids[input]` is the
   * same part of the next context's map, for pairRules(). Directions of price and SoC are property
   * 3.
   */
  violations(grid, {first, last}, context, nextGrids) {
    const width = last - first + 1, found = [];
    for (const rule of this.at(context)) {
      if (!rule.binds_student || !rule.forbidden) continue;
      const cells = [];
      for (let soc = rule.soc[0]; soc <= rule.soc[1]; ++soc) {
        for (let price = Math.max(first, rule.price[0]); price <= Math.min(last, rule.price[1]);
             ++price) {
          const cell = soc * width + price - first;
          if (rule.forbidden.includes(grid[cell])) cells.push(cell);
        }
      }
      if (cells.length > 0) found.push({rule, cells});
    }
    for (const rule of this.pairRules()) {
      const next = nextGrids[rule.direction.input], cells = [];
      if (!next) continue;
      for (let cell = 0; cell < grid.length; ++cell) {
        if ((next[cell] - grid[cell]) * rule.direction.sign < 0) cells.push(cell);
      }
      if (cells.length > 0) found.push({rule, cells});
    }
    return found;
  }

  /**
   * Nearest context in time at which a rule applies; null for a rule without a region.
   */
  contextOf(rule, context) {
    if (!rule.price) return null;
    for (let away = 0; away < 12; ++away) {
      const contextClass = (context.contextClass - 1 + away) % 12 + 1;
      for (let later = 0; later < 96; ++later) {
        const other = {...context, contextClass, quarterHour: (context.quarterHour + later) % 96};
        if (this.isAt(rule, other)) return other;
      }
    }
    return null;
  }

  /** Outlines with numbers; the one under the pointer is thicker and named. */
  paint(ctx, frame, window, context) {
    const {plot, cellW, cellH} = frame;
    ctx.save();
    ctx.beginPath();
    ctx.rect(plot.x - 2, plot.y - 2, plot.w + 4, plot.h + 4);
    ctx.clip();
    const badges = [];
    for (const rule of this.at(context)) {
      const first = Math.max(rule.price[0], window.first),
            last = Math.min(rule.price[1], window.last);
      if (first > last) continue;
      const x = plot.x + rule.soc[0] * cellW, w = (rule.soc[1] - rule.soc[0] + 1) * cellW;
      const y = plot.y + (window.last - last) * cellH, h = (last - first + 1) * cellH;
      const pointed = this.pointed === rule;
      for (const [ink, width] of [[colour("paper"), pointed ? 7 : 4.5],
                                  [colour("ink"), pointed ? 3.5 : 2]]) {
        ctx.strokeStyle = ink;
        ctx.lineWidth = width;
        ctx.setLineDash(rule.binds_student || width > 4 ? [] : [7, 5]);
        ctx.strokeRect(x, y, w, h);
      }
      badges.push({rule, x, y});
    }
    ctx.setLineDash([]);
    const taken = [];
    for (const badge of badges) this.paintBadge(ctx, badge, plot, taken);
    ctx.restore();
  }

  /**
   * Number of the rule in the upper left corner of its region, with its name under the pointer.
   */
  paintBadge(ctx, {rule, x, y}, plot, taken) {
    const pointed = this.pointed === rule;
    ctx.font = `${pointed ? "600 " : ""}12px system-ui, sans-serif`;
    ctx.textAlign = "left";
    ctx.textBaseline = "middle";
    const text = pointed ? `${rule.number} ${rule.name}` : String(rule.number);
    const width = Math.min(ctx.measureText(text).width + 8, plot.w);
    const left = Math.max(plot.x, Math.min(x, plot.x + plot.w - width));
    let top = Math.max(plot.y, Math.min(y, plot.y + plot.h - kRuleBadgePx));
    const overlaps = (other) =>
      left < other.right && other.left < left + width && Math.abs(top - other.top) < kRuleBadgePx;
    while (taken.some(overlaps) && top + 2 * kRuleBadgePx < plot.y + plot.h)
      top += kRuleBadgePx + 1;
    taken.push({left, right: left + width, top});
    ctx.fillStyle = colour("ink");
    ctx.fillRect(left, top, width, kRuleBadgePx);
    ctx.fillStyle = colour("paper");
    ctx.fillText(text, left + 4, top + kRuleBadgePx / 2 + .5, width - 8);
  }

  /**
   * Legend: each rule with number, text, and whether it applies on this map.
   */
  showLegend(host, context, repaint) {
    host.hidden = this.rules.length === 0;
    host.replaceChildren(...this.rules.map((rule) => {
      const item = document.createElement("li"), button = document.createElement("button");
      const badge = document.createElement("b"), name = document.createElement("strong");
      button.type = "button";
      badge.textContent = String(rule.number);
      name.textContent = rule.name;
      const elsewhere = this.contextOf(rule, context);
      const here = rule.direction ? "applies everywhere, no region"
        : !rule.price ? "outside the prices of the map"
        : this.isAt(rule, context) ? "applies on this map"
        : "does not apply at this time: click to go to a time when it does";
      const text = rule.text.replace(/(^|\s)-(?=\d)/g, "$1\u2212");
      button.append(badge, name, ` ${text}. Enforced by: ${rule.held_by}; ${here}.`);
      button.disabled = elsewhere === null;
      button.addEventListener("click", () => {
        this.pointed = rule;
        this.show(elsewhere);
      });
      for (const [kind, pointed] of [["pointerenter", rule], ["pointerleave", null]]) {
        button.addEventListener(kind, (event) => {
          if (event.pointerType !== "mouse") return;
          this.pointed = pointed;
          repaint();
        });
      }
      item.append(button);
      return item;
    }));
  }
}
