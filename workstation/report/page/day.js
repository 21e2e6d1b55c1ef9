// Day view: prices, power, state of charge and profit of the run's own policies, step by step.
"use strict";

const kOrdinaryShare = 20 / 24;  // of the day's steps, shown without extreme prices
const kLaneNamePx = 17;              // above a lane of the power chart
const kDayCharts = ["chart-price", "chart-power", "chart-soc", "chart-eur"];

class DayView {
  /** `showOnMap(state)` receives the state of a step. */
  constructor(data, days, showOnMap) {
    this.data = data;
    this.days = days;
    this.scale = "ordinary";
    this.step = 0;
    const select = document.getElementById("day-select");
    select.replaceChildren(...days.map((day) => new Option(day.date, day.date)));
    select.addEventListener("change", () => this.open(select.value));
    const click = (id, action) => document.getElementById(id).addEventListener("click", action);
    click("day-before", () => this.openAt(this.index - 1));
    click("day-after", () => this.openAt(this.index + 1));
    click("day-worst", () => this.openAt(this.extreme((day) => -this.earned(day))));
    click("day-best", () => this.openAt(this.extreme((day) => this.earned(day))));
    click("day-widest", () => this.openAt(this.widest()));
    click("step-to-map", () => showOnMap(this.state()));
    document.getElementById("step-slider")
      .addEventListener("input", (event) => this.moveTo(Number(event.target.value)));
    bindChoice("scale-choice", "scale", (scale) => {
      this.scale = scale;
      this.draw();
    });
  }

  /** Profit of the first policy, EUR. */
  earned(day) {
    return day.policies[0].profit.reduce((sum, eur) => sum + eur, 0);
  }

  /** Index of the day with the largest `value`. */
  extreme(value) {
    const values = this.days.map(value);
    return values.indexOf(Math.max(...values));
  }

  widest() {
    return this.extreme((day) => Math.max(...day.paid) - Math.min(...day.paid));
  }

  open(date) {
    this.openAt(this.days.findIndex((day) => day.date === date));
  }

  /** Links of the page to a day, or to a minute of one (UTC, since 1970). */
  openByLinks() {
    for (const link of document.querySelectorAll("a[data-day]")) {
      link.addEventListener("click", () => {
        this.open(link.dataset.day);
        if (link.dataset.minute && this.day.date === link.dataset.day) {
          this.moveTo(Math.max(0, this.day.minute.indexOf(Number(link.dataset.minute))));
        }
      });
    }
  }

  openAt(index) {
    if (index < 0 || index >= this.days.length) return;
    this.index = index;
    this.day = this.days[index];
    document.getElementById("day-select").value = this.day.date;
    document.getElementById("day-before").disabled = index === 0;
    document.getElementById("day-after").disabled = index + 1 === this.days.length;
    document.getElementById("step-slider").max = String(this.day.steps - 1);
    this.hours = Array.from(this.day.minute, (minute) => (minute - this.day.minute[0]) / 60);
    this.earnings = this.day.policies.map((policy) => cumulative(policy.profit));
    this.step = Math.min(this.step, this.day.steps - 1);
    this.draw();
    this.moveTo(this.step);
  }

  /** State of the selected step, for the policy map. */
  state() {
    const {day, step} = this;
    return {contextClass: day.contextClass[step],
            quarterHour: Math.floor(day.localMinute[step] / 15),
            minute: day.localMinute[step] % 15, price: day.observed[step],
            soc: day.policies[0].soc[step]};
  }

  draw() {
    this.describe();
    this.drawPrices();
    this.drawPower();
    this.drawSteps(
      "chart-soc", (policy) => Array.from(policy.soc, (soc) => 100 * soc),
      "%", {min: 0, max: 100});
    this.drawSteps("chart-eur", (_, p) => this.earnings[p], "EUR of this battery", {});
  }

  describe() {
    const earned = this.data.archive.policies.map(
      (name, p) => `${name} ${signed(this.earnings[p].at(-1), 0)} EUR of this battery`);
    const left = this.data.archive.days_left_out;
    document.getElementById("day-note").textContent = `${this.day.date}: ${earned.join(", ")}.` +
      (left > 0
        ? ` ${left} of the test days are not on this page, which has only the newest and the worst.`
        : "");
  }

  /**
   * Ends of the price axis, for all prices or without extreme ones.
   */
  priceRange() {
    const sorted = [...this.day.observed, ...this.day.paid].sort((a, b) => a - b);
    const tail = this.scale === "all" ? 0 : Math.floor(sorted.length * (1 - kOrdinaryShare) / 2);
    const low = sorted[tail], high = sorted[sorted.length - 1 - tail];
    const room = .08 * Math.max(high - low, 1);
    return {low: low - room, high: high + room, beyond: 2 * tail};
  }

  drawPrices() {
    const {low, high} = this.priceRange();
    const beyond = Array.from(this.day.paid).filter((price) => price < low || price > high).length;
    document.getElementById("price-note").textContent = "EUR/MWh" + (beyond > 0
      ? `; ${beyond} steps outside this scale are marked at its edge: paid ` +
        `${trueMinus(Math.min(...this.day.paid).toFixed(0))} to ` +
        `${trueMinus(Math.max(...this.day.paid).toFixed(0))}`
      : "");
    drawChart("chart-price", () => ({
      type: "line",
      data: {
        datasets: [
          this.line("paid", Array.from(this.day.paid), colour("ink"),
                    {borderWidth: 2, stepped: "before"}),
          this.line("observed", Array.from(this.day.observed), colour("line-1"),
                    {borderWidth: 1, stepped: "before"}),
        ],
      },
      options: this.options({min: low, max: high, title: axisTitle("EUR/MWh")}),
      plugins: [this.cursorPlugin(), this.edgePlugin(low, high)],
    }));
  }

  /** One lane per policy, shaded by power. */
  drawPower() {
    drawChart("chart-power", () => ({
      type: "line",
      data: {datasets: []},
      options: this.options({min: 0, max: this.day.policies.length, ticks: {display: false},
                             grid: {display: false}}),
      plugins: [this.lanesPlugin(), this.cursorPlugin()],
    }));
  }

  /** One line per policy; the first is the widest. */
  drawSteps(id, valuesOf, unit, y) {
    drawChart(id, () => ({
      type: "line",
      data: {
        datasets: this.day.policies.map((policy, p) => this.line(
          this.data.archive.policies[p], valuesOf(policy, p),
          policyColour(this.data.archive.policies[p]),
          {borderWidth: p === 0 ? 2.5 : 1.2, borderDash: p === 2 ? [4, 3] : [], order: p})),
      },
      options: this.options({...y, title: axisTitle(unit)}),
      plugins: [this.cursorPlugin()],
    }));
  }

  line(label, values, ink, more) {
    return {label, data: values.map((y, i) => ({x: this.hours[i], y})), borderColor: ink,
            backgroundColor: ink,
            pointRadius: 0, ...more};
  }

  /** Options of a chart over the day's hours; `y`: options of the other axis. */
  options(y) {
    const end = this.hours.at(-1) + 2 / 60;
    return {
      parsing: false, events: ["mousemove", "click", "touchstart", "touchmove"],
      onHover: (event, _, chart) =>
        this.moveTo(this.stepAt(chart.scales.x.getValueForPixel(event.x))),
      plugins: {tooltip: {enabled: false},
                legend: {labels: {color: colour("ink"), boxWidth: 14, boxHeight: 3}}},
      scales: {
        x: axis({type: "linear", min: 0, max: end,
                 ticks: {stepSize: 3, callback: (hour) => this.timeAt(hour)}}),
        y: axis({...y, ticks: {maxTicksLimit: 6, includeBounds: false, ...y.ticks},
                 afterFit: (scale) => { scale.width = 78; }}),
      },
    };
  }

  /** Local time of an hour after the start of the day. */
  timeAt(hour) {
    return hour >= this.hours.at(-1) ? "24:00" : clockText(this.day.localMinute[this.stepAt(hour)]);
  }

  stepAt(hour) {
    const step = this.hours.findIndex((begin) => begin > hour + 1e-9);
    return Math.max(0, (step < 0 ? this.day.steps : step) - 1);
  }

  /** Selects a step: cursor line and numbers. */
  moveTo(step) {
    this.step = step;
    const {day} = this;
    document.getElementById("step-slider").value = String(step);
    document.getElementById("step-time").textContent = clockText(day.localMinute[step]);
    const text = (head, rest) => {
      const line = document.createElement("span"), strong = document.createElement("b");
      strong.textContent = head + " ";
      line.append(strong, rest);
      return line;
    };
    document.getElementById("step-readout").replaceChildren(
      text("price", trueMinus(`observed ${day.observed[step].toFixed(1)}, ` +
                              `paid ${day.paid[step].toFixed(1)} EUR/MWh`)),
      ...day.policies.map((policy, p) => text(
        this.data.archive.policies[p],
        `${kActions[policy.action[step]]}, ` +
        `${(Math.abs(policy.power[step]) / 1e6).toPrecision(3)} MW at ` +
        `${(100 * policy.soc[step]).toFixed(1)} %, ` +
        `${signed(this.earnings[p][step], 1)} EUR of this battery so far`)));
    for (const id of kDayCharts) shownCharts.get(id).chart.draw();
  }

  lanesPlugin() {
    return {
      id: "lanes",
      beforeDatasetsDraw: (chart) => {
        const {ctx, chartArea, scales} = chart, count = this.day.policies.length;
        const height = (chartArea.bottom - chartArea.top) / count, strip = height - kLaneNamePx;
        const most = this.data.battery.power_w;
        const charging = colour("charge"), discharging = colour("discharge");
        ctx.save();
        ctx.font = "11px system-ui, sans-serif";
        ctx.textBaseline = "top";
        this.day.policies.forEach(({power}, p) => {
          const top = chartArea.top + p * height;
          ctx.globalAlpha = 1;
          ctx.fillStyle = colour("muted");
          ctx.fillText(this.data.archive.policies[p], chartArea.left + 4, top + 2);
          ctx.fillStyle = colour("shade");
          ctx.fillRect(chartArea.left, top + kLaneNamePx, chartArea.right - chartArea.left, strip);
          for (let s = 0; s < this.day.steps; ++s) {
            if (power[s] === 0) continue;
            const x = scales.x.getPixelForValue(this.hours[s]),
                  end = scales.x.getPixelForValue(this.hours[s] + 2 / 60);
            ctx.globalAlpha = .25 + .75 * Math.abs(power[s]) / most;
            ctx.fillStyle = power[s] > 0 ? charging : discharging;
            ctx.fillRect(x, top + kLaneNamePx, end - x + .3, strip);
          }
        });
        ctx.restore();
      },
    };
  }

  cursorPlugin() {
    return {
      id: "cursor",
      afterDatasetsDraw: (chart) => {
        const {ctx, chartArea, scales} = chart;
        const x = scales.x.getPixelForValue(this.hours[this.step]);
        ctx.save();
        ctx.strokeStyle = colour("muted");
        ctx.setLineDash([3, 3]);
        ctx.beginPath();
        ctx.moveTo(x, chartArea.top);
        ctx.lineTo(x, chartArea.bottom);
        ctx.stroke();
        ctx.restore();
      },
    };
  }

  /** Marks at the edge for steps outside the scale. */
  edgePlugin(low, high) {
    return {
      id: "edge",
      afterDatasetsDraw: (chart) => {
        const {ctx, chartArea, scales} = chart;
        ctx.save();
        ctx.fillStyle = colour("line-2");
        for (let s = 0; s < this.day.steps; ++s) {
          const price = this.day.paid[s];
          if (price >= low && price <= high) continue;
          const x = scales.x.getPixelForValue(this.hours[s]);
          ctx.fillRect(x - 1, price > high ? chartArea.top : chartArea.bottom - 5, 2.5, 5);
        }
        ctx.restore();
      },
    };
  }
}
