// Charts with Chart.js in the page's colours, redrawn when the colour scheme changes.
"use strict";

const shownCharts = new Map();  // canvas id -> {chart, configure}

/** A number's hyphen as a minus sign: at the start, behind a space or a bracket. */
function trueMinus(text) {
  return String(text).replace(/(^|[\s(])-(?=[\d.])/g, "$1\u2212");
}

for (const kind of ["linear", "logarithmic"]) {
  const {ticks} = Chart.defaults.scales[kind], plain = ticks.callback;
  ticks.callback = function (...about) { return trueMinus(plain.apply(this, about)); };
}
{
  const {callbacks} = Chart.defaults.plugins.tooltip, plain = callbacks.label;
  callbacks.label = function (item) { return trueMinus(plain.call(this, item)); };
}

/** Value of a colour variable of the style sheet. */
function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
}

/** Few enough that Chart.js drops none. */
const kFewTicks = {maxTicksLimit: 7};

/** Axis in the style of the page. */
function axis(options = {}) {
  const {ticks, grid, ...rest} = options;
  return {
    ...rest,
    ticks: {color: colour("muted"), maxRotation: 0, autoSkipPadding: 14, ...ticks},
    grid: {color: colour("grid"), borderColor: colour("muted"), tickLength: 4, ...grid},
  };
}

function axisTitle(text) {
  return {display: true, text, color: colour("muted")};
}

/** Options of all charts. */
function baseOptions(options) {
  return {
    responsive: true, maintainAspectRatio: false, animation: false, normalized: true,
    interaction: {mode: "index", intersect: false},
    ...options,
    plugins: {
      legend: {labels: {color: colour("ink"), boxWidth: 14, boxHeight: 10}},
      ...(options.plugins || {}),
    },
  };
}

/** Vertical lines; `marks`: [label index, text] each. */
const marksDrawn = marks => ({
  id: "marks",
  afterDatasetsDraw({ctx, chartArea: {top, bottom}, scales: {x}}) {
    ctx.save();
    ctx.strokeStyle = ctx.fillStyle = colour("muted");
    ctx.setLineDash([4, 4]);
    for (const [place, what] of marks) {
      const at = x.getPixelForValue(place), toTheLeft = at > (x.left + x.right) / 2;
      ctx.beginPath();
      ctx.moveTo(at, top);
      ctx.lineTo(at, bottom);
      ctx.stroke();
      ctx.textAlign = toTheLeft ? "right" : "left";
      ctx.fillText(what, at + (toTheLeft ? -4 : 4), bottom - 6);
    }
    ctx.restore();
  },
});

/**
 * Draws the chart of a canvas; `configure` returns its configuration, again for each colour scheme.
 */
function drawChart(id, configure) {
  const before = shownCharts.get(id);
  if (before) before.chart.destroy();
  const config = configure();
  config.options = baseOptions(config.options || {});
  const chart = new Chart(document.getElementById(id), config);
  shownCharts.set(id, {chart, configure});
  return chart;
}

function redrawCharts() {
  for (const [id, {configure}] of [...shownCharts]) drawChart(id, configure);
}

/** Calls back when the colour scheme changes. */
function onColourScheme(callback) {
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", callback);
}

/** "+12.3" */
function signed(value, digits = 1) {
  return (value >= 0 ? "+" : "\u2212") + Math.abs(value).toFixed(digits);
}

/** Two digits. */
function padded(number) {
  return String(number).padStart(2, "0");
}

/** "12:07" of a minute of the day. */
function clockText(minute) {
  return padded(Math.floor(minute / 60)) + ":" + padded(minute % 60);
}

/** Buttons of a choice; calls `chosen` with the value of the pressed one. */
function bindChoice(id, key, chosen) {
  const buttons = [...document.querySelectorAll(`#${id} button`)];
  for (const button of buttons) {
    button.addEventListener("click", () => {
      pressChoice(id, key, button.dataset[key]);
      chosen(button.dataset[key]);
    });
  }
}

/** Shows the button of `value` as pressed, if any. */
function pressChoice(id, key, value) {
  for (const button of document.querySelectorAll(`#${id} button`)) {
    button.setAttribute("aria-pressed", String(button.dataset[key] === value));
  }
}
