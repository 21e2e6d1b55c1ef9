// Tear sheet: profit of the exported policy and baselines over the test days.
"use strict";

const kReferenceWear = 10;  // EUR/MWh
const kBars = 14;

/** "2023-01-26" in two lines, for narrow screens. */
const kTwoLineDates = {
  callback(value) {
    const date = this.getLabelForValue(value);
    return date.length === 10 ? [date.slice(0, 4), date.slice(5)] : date;
  },
};

class TearSheet {
  /** `days`: of unpackDays. */
  constructor(data, days) {
    this.data = data;
    this.days = days;
    this.wear = data.battery.wear_eur_per_mwh;
    bindChoice("wear-choice", "wear", (value) => {
      this.wear = value === "configured" ? data.battery.wear_eur_per_mwh : kReferenceWear;
      this.draw();
    });
  }

  /** Evaluated policies among `names`. */
  policies(names) {
    return names.map((name) => this.data.policies.find((policy) => policy.name === name))
      .filter(Boolean);
  }

  /** The first `count` baselines, or all. */
  rivals(count) {
    return this.policies(this.data.rivals.slice(0, count).map((rival) => rival.name));
  }

  /** EUR per MWh of capacity, by day. */
  profits(policy) {
    const {capacity_mwh, wear_eur_per_mwh} = this.data.battery;
    return policy.profit_eur.map(
      (eur, d) => (eur - (this.wear - wear_eur_per_mwh) * policy.throughput_mwh[d]) / capacity_mwh);
  }

  draw() {
    const exported = this.policies([this.data.exported])[0] || this.data.policies[0];
    if (exported) {
      this.drawCumulative(exported);
      this.drawMonths(exported);
      this.drawDistribution(exported);
      this.drawDrawdown(exported);
    }
    this.drawHours();
  }

  drawCumulative(exported) {
    drawChart("chart-cumulative", () => ({
      type: "line",
      plugins: [marksDrawn(this.data.marks)],
      data: {
        labels: this.data.dates,
        datasets: [exported, ...this.rivals()].map((policy) => ({
          label: policy.name, data: cumulative(this.profits(policy)),
          borderColor: policyColour(policy.name),
          backgroundColor: policyColour(policy.name), pointRadius: 0, pointHitRadius: 8,
          borderWidth: policy === exported ? 3 : 1.5, hidden: policy.name === this.data.foresight,
          borderDash: policy.name === this.data.foresight ? [5, 4] : [],
        })),
      },
      options: {scales: {x: axis({ticks: kTwoLineDates}), y: axis({title: axisTitle(kSumUnit)})}},
    }));
  }

  /**
   * By day: cumulative profit minus its earlier maximum, starting at 0.
   */
  drawdowns(policy) {
    let peak = 0;
    return cumulative(this.profits(policy)).map((sum) => sum - (peak = Math.max(peak, sum)));
  }

  drawDrawdown(exported) {
    const falls =
      [exported, ...this.rivals(1)].map((policy) => [policy.name, this.drawdowns(policy)]);
    const anyFalls = falls.some(([, values]) => Math.min(...values) < 0);
    document.getElementById("drawdown-none").hidden = anyFalls;
    document.getElementById("chart-drawdown").closest("figure").hidden = !anyFalls;
    if (anyFalls) this.drawBars("chart-drawdown", this.data.dates, falls, "", kSumUnit, {max: 0});
  }

  drawMonths(exported) {
    const months = [...new Set(this.data.dates.map((date) => date.slice(0, 7)))];
    const means = (policy) => {
      const profits = this.profits(policy);
      return months.map((month) => {
        const own = profits.filter((_, d) => this.data.dates[d].startsWith(month));
        return own.reduce((sum, profit) => sum + profit, 0) / own.length;
      });
    };
    this.drawBars("chart-months", months, [exported, ...this.rivals(2)].map(
      (policy) => [policy.name, means(policy)]), "", kProfitUnit);
  }

  drawDistribution(exported) {
    const shown = [exported, ...this.rivals(1)];
    const all = shown.map((policy) => this.profits(policy));
    const low = Math.min(...all.flat()), high = Math.max(...all.flat());
    const width = niceStep((high - low) / kBars), first = Math.floor(low / width) * width;
    const count = Math.floor((high - first) / width) + 1;
    const labels = Array.from({length: count}, (_, b) => trueMinus(Math.round(first + b * width)));
    this.drawBars("chart-days", labels, shown.map((policy, p) => {
      const bins = new Array(count).fill(0);
      for (const profit of all[p]) ++bins[Math.floor((profit - first) / width)];
      return [policy.name, bins];
    }), kSumUnit, "days");
  }

  /** Means of the exported policy over the days of the page. */
  profitByHour() {
    const charging = new Array(24).fill(0), discharging = new Array(24).fill(0);
    const share = 1 / (this.days.length * this.data.battery.capacity_mwh);
    for (const day of this.days) {
      const {profit, power} = day.policies[0];
      for (let s = 0; s < day.steps; ++s) {
        const sums = power[s] > 0 ? charging : discharging;
        sums[Math.floor(day.localMinute[s] / 60)] += profit[s] * share;
      }
    }
    return {charging, discharging, net: charging.map((eur, h) => eur + discharging[h])};
  }

  drawHours() {
    const {charging, discharging, net} = this.profitByHour();
    drawChart("chart-hours", () => ({
      data: {
        labels: charging.map((_, hour) => padded(hour)),
        datasets: [
          {type: "line", label: "total", data: net, borderColor: colour("ink"),
           backgroundColor: colour("ink"),
           borderWidth: 2, pointRadius: 2, order: 0},
          {type: "bar", label: "charging", data: charging, backgroundColor: colour("charge"),
           stack: "eur", order: 1},
          {type: "bar", label: "discharging", data: discharging,
           backgroundColor: colour("discharge"), stack: "eur",
           order: 1},
        ],
      },
      options: {scales: {x: axis({stacked: true, title: axisTitle("local hour")}),
                         y: axis({stacked: true, title: axisTitle(kProfitUnit),
                                  ticks: kFewTicks})}},
    }));
  }

  /** Grouped bars; `series`: [name, values] each; `x`, `y`: titles; `more`: options of y. */
  drawBars(id, labels, series, x, y, more = {}) {
    drawChart(id, () => ({
      type: "bar",
      data: {
        labels,
        datasets: series.map(([name, values]) => ({label: name, data: values,
                                                   backgroundColor: policyColour(name)})),
      },
      options: {scales: {x: axis({title: {...axisTitle(x), display: x !== ""},
                                  ticks: kTwoLineDates}),
                         y: axis({title: axisTitle(y), ticks: {precision: 0}, ...more})}},
    }));
  }
}

/** 1, 2 or 5 times a power of ten, not less than `rough`. */
function niceStep(rough) {
  const power = 10 ** Math.floor(Math.log10(Math.max(rough, 1e-9)));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= rough * (1 - 1e-12));
}
