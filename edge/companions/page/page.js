// Page script: shows bess-edge status every ten seconds, the rest once per control cycle.
"use strict";

const kEveryMs = 10000;
const kStepMs = 120000;
const kHourMs = 3600000;
const kDayMs = 24 * kHourMs;
/** Reasons whose cycle had no price, or not a current one: it is not drawn as a price. */
const kWithoutPrice = new Set(["no_price", "price_age", "price_qh", "frozen_price", "stand_in"]);
const isPriced = (reason) => !kWithoutPrice.has(reason);
Chart.defaults.plugins.legend.position = "bottom";
let shownCycle = null;
let state = null;  // newest answer of api/status
let shownDay = null;  // "2026-11-23", or null: the last 24 hours
let isAsking = false;  // one request at a time, also when it hangs

const byId = (id) => document.getElementById(id);
const clock = (time) => new Date(time).toLocaleTimeString(
  "en-GB", {timeZone: "Europe/Brussels", hour: "2-digit", minute: "2-digit"});
const moment = (time) =>
  new Date(time).toLocaleString("sv-SE", {timeZone: "Europe/Brussels"}).slice(0, 16);

/** "−1,200 W"; a dash without a number. */
function say(value, decimals = 0, unit = "") {
  if (typeof value !== "number") return "\u2013";
  const digits = {minimumFractionDigits: decimals, maximumFractionDigits: decimals};
  return value.toLocaleString("en", digits).replace("-", "\u2212") + (unit && "\u00a0" + unit);
}
const price = (value) => say(value, 2, "EUR/MWh");
/** "180.20 EUR/MWh at 2026-11-23 18:00"; a dash without day-ahead prices. */
const ahead = (at) =>
  at ? `${price(at.eur_per_mwh)} at ${moment(at.utc)}` : "\u2013";
const percent = (value) => say(value, 1, "%");
const eur = (value) => say(value, 2, "EUR");

function element(name, text = "", ...children) {
  const made = document.createElement(name);
  made.append(text, ...children);
  return made;
}
const fill = (id, elements) => byId(id).replaceChildren(...elements);
/** Text of a program without its marks of commands. */
const plain = (text) => text.replaceAll("`", "");
const lines = (id, texts, name) =>
  fill(id, texts.filter((text) => text).map((text) => element(name, plain(text))));

async function ask(path) {
  const answer = await fetch(path, {cache: "no-store", redirect: "error"});
  const text = await answer.text();
  if (answer.status === 503) throw new Error(JSON.parse(text).trouble);
  if (!answer.ok) throw new Error(`${path}: ${text}`);
  return answer.headers.get("Content-Type").startsWith("text/csv") ? text : JSON.parse(text);
}

const does = (watts) => watts > 0 ? `charges at ${say(watts, 0, "W")}`
  : watts < 0 ? `discharges at ${say(-watts, 0, "W")}` : "is idle";
const isRunning = () => state.health !== "not running";

function showStatus(status) {
  const last = status.last || {};
  const kind = {ok: "good", degraded: "fair"}[status.health] || "bad";
  document.title = byId("name").textContent = status.name || "Battery";
  byId("health").textContent = status.health;
  byId("health").className = "badge " + kind;
  lines("problems", [...status.health_reasons, status.unknown,
                     status.contact && "Call: " + status.contact], "li");
  for (const problem of byId("problems").children) {
    problem.classList.toggle("bad", problem.textContent.startsWith("CRITICAL"));
  }
  showFlow(last);
  const facts = {
    mode: last.mode, version: status.version, battery: status.battery, map: status.map,
    since: status.start_utc && moment(status.start_utc), update: status.update,
    "trained on prices of":
      status.trained_from && `${status.trained_from} to ${status.trained_until}`,
    retrain: status.retrain, student: status.student};
  fill("facts", Object.entries(facts).filter(([, value]) => value).flatMap(
    ([name, value]) => [element("dt", name), element("dd", value)]));
  showNext(status.next, status.no_effect);
}

function drawn(name, attributes, text = "") {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = text;
  return made;
}

/** Power between grid, house and battery, W: house = grid - battery, where a meter knows it. */
function showFlow(last) {
  const battery = last.has_measurement ? last.battery_power_w : undefined;
  const grid = last.has_grid_power ? last.grid_power_w : undefined;
  const nodes = [
    {x: 60, name: "Grid", watts: grid ?? battery, value: say(grid ?? undefined, 0, "W"),
     note: last.has_price && isPriced(last.reason) ? price(last.price_centi_eur_per_mwh / 100)
       : "no current price"},
    {x: 300, name: "Battery", watts: battery, value: say(battery, 0, "W"),
     note: last.has_measurement ? percent(last.soc_e4 / 100) : "not measured"}];
  if (grid !== undefined && battery !== undefined) {
    nodes[1].x = 180;
    nodes.push({x: 300, name: "House", watts: grid - battery, value: say(grid - battery, 0, "W"),
                note: grid < battery ? "feeds in" : "load"});
  }
  byId("measured").textContent = !last.has_measurement ? "" :
    `Power measured at ${clock(Date.parse(last.utc))}, before the order of that control cycle.`;
  fill("flow", nodes.flatMap(({x, name, watts, value, note}) => {
    const isBack = name === "Grid" ? watts < 0 : watts > 0;  // the line starts at the node
    const flows = Math.abs(watts) >= 1 ? "flows" + (isBack ? " back" : "") : "";
    return [drawn("line", {x1: x, y1: 88, x2: x, y2: 158, class: flows}),
            drawn("circle", {cx: x, cy: 50, r: 38}),
            drawn("text", {x, y: 42}, name), drawn("text", {x, y: 60, class: "value"}, value),
            drawn("text", {x: x + 5, y: 112, class: "note"}, note)];
  }).concat(drawn("line", {x1: 60, y1: 158, x2: nodes.at(-1).x, y2: 158})));
}

function showNext(next, noEffect) {
  const texts = [];
  if (!next) {
    texts.push("No next decision.");
  } else if (next.action === null) {
    texts.push(`At ${next.local}: no decision without a price and a reading of the battery.`);
  } else {
    texts.push(
      `At ${next.local} it ${does(next.power_w)} if price and state of charge stay.`);
  }
  if (next?.reason) texts.push(`${next.reason} overrides it${next.ends && ", " + next.ends}.`);
  for (const change of next?.reserve_changes || []) {
    texts.push(`Reserve from ${moment(change.utc)}: ${percent(change.soc_percent)}.`);
  }
  if (typeof next?.full_charge_in_days === "number") {
    texts.push(`Days to the next full charge: ${next.full_charge_in_days}.`);
  }
  lines("next", [...texts, ...noEffect.map((key) => `Set, but without effect: ${key}`)], "li");
}

function showWhy(why) {
  const at = why.margins;
  const cause = why.reason !== "student"
    ? `${why.meaning} (${why.reason}) since ${moment(why.since_utc)}`
    : `the price of ${price(why.price_eur_per_mwh)} is ` +
      (why.ordered_power_w > 0 ? "low" : why.ordered_power_w < 0 ? "high" : "neither low nor high");
  const what = !isRunning()
    ? "No controller is running; the battery's state is unknown. Last decision"
    : why.mode !== "running" ? `No control, mode ${why.mode}`
    : state.control ? `The battery ${does(why.ordered_power_w)}`
    : `Read-only, nothing is written; decided: ${say(why.ordered_power_w, 0, "W")}`;
  byId("sentence").textContent = plain(`${what}: ${cause}${why.ends && ", " + why.ends}.`);
  const texts = [
    `${why.local}: ${isPriced(why.reason) ? "" : "last "}price ` +
    `${price(why.price_eur_per_mwh)}, state of charge ${percent(why.soc_percent)}. ` +
    (why.student ? `Student: ${why.student}.` : "No student decision.")];
  if (at) {
    texts.push(`It charges up to ${price(at.charge_up_to_eur_per_mwh)} and discharges from ` +
              `${price(at.discharge_from_eur_per_mwh)}; in between it is idle.`);
  }
  if (at?.charge_up_to_soc_percent != null) {
    texts.push(`At this price it charges up to ${percent(at.charge_up_to_soc_percent)}.`);
  }
  if (at?.discharge_from_soc_percent != null) {
    texts.push(`At this price it discharges from ${percent(at.discharge_from_soc_percent)}.`);
  }
  const outlook = why.outlook;
  if (outlook) {
    texts.push(`Plan: break-even ${price(outlook.break_even_eur_per_mwh)}; highest price ` +
              `${ahead(outlook.dearest)}, lowest ${ahead(outlook.cheapest)}.`);
  }
  lines("why", texts, "p");
}

const kColumns = [  // head, key, decimals
  ["earned, EUR", "earned_eur", 2], ["of which estimated", "estimated_eur", 2],
  ["charged, kWh", "charged_kwh", 1], ["discharged, kWh", "discharged_kwh", 1],
  ["full cycles", "full_cycles", 2], ["EUR/MWh, mean", "mean_price_eur_per_mwh", 2],
  ["control cycles driven", "driven_cycles", 0]];

function showMonth(month) {
  byId("money").textContent =
    `${eur(month.earned_eur)} earned, of which ${eur(month.estimated_eur)} estimated: ` +
    `${say(month.settled_quarter_hours)} of ${say(month.quarter_hours)} quarter-hours are at ` +
    "their settled price. At equal state of charge: " +
    `${eur(month.earned_at_equal_soc_eur)}. ` +
    `In control ${percent(100 * month.stops.driven_share)} of the time.` +
    (month.stops.by_reason.length > 0 ? " Control cycles by other reasons than the student:" : "");
  lines("stops", month.stops.by_reason.map(
    (stop) => `${stop.meaning} (${stop.reason}): ${say(stop.cycles)}, ` +
      `${say(stop.not_driven)} of them not driven`), "li");
  lines("columns", ["day", ...kColumns.map(([head]) => head)], "th");
  fill("days", month.days.map((day) => element("tr", "", element("th", day.date),
    ...kColumns.map(([head, key, decimals]) => {
      const cell = element("td", say(day[key], decimals));
      cell.dataset.label = head;
      return cell;
    }))));
}

/** Linear axis with a title, or without where it is empty. */
const scale = (title, options) => axis({
  type: "linear", title: title ? axisTitle(title) : {}, ...options,
  ticks: {...kFewTicks, ...options?.ticks}});
const strip = (title, stackWeight, options) =>
  scale(title, {axis: "y", stack: "day", stackWeight, offset: true, ...options});
const line = (label, name, data, more) => ({
  label, data, borderColor: colour(name), backgroundColor: colour(name), borderWidth: 1.6,
  pointRadius: 0, ...more});

/** Steps through the control cycles; a gap in the log is a gap in the line. */
function steps(cycles, value) {
  return cycles.flatMap((cycle, index) => {
    const x = cycle.time, y = value(cycle), next = cycles[index + 1];
    const isHole = !next || next.time - x > kStepMs;
    return isHole ? [{x, y}, {x: x + kStepMs, y}, {x: x + kStepMs, y: NaN}] : [{x, y}];
  });
}

function cyclesOf(csv) {
  const [head, ...rows] = csv.trim().split("\n").map((row) => row.split(","));
  const column = (name) => head.indexOf(name);
  const number = (row, name, divisor) => Number(row[column(name)]) / divisor;
  const priced = (row) => row[column("price_minute_utc")] !== "none" &&
    isPriced(row[column("reason")]);
  return rows.filter((row) => row[column("mode")] !== "stopping").map((row) => ({
    time: Date.parse(row[column("utc")]),
    price: priced(row) ? number(row, "price_centi_eur_per_mwh", 100) : NaN,
    breakEven: row[column("outlook")] === "none" ? NaN : number(row, "break_even_centi", 100),
    // Without a measurement the column is 0.
    soc: number(row, "soc_e4", 100) || NaN,
    measured: number(row, "soc_e4", 1) ? number(row, "battery_power_w", 1000) : NaN,
    ordered: row[column("written")] === "1" ? number(row, "ordered_power_w", 1000) : NaN,
  })).sort((a, b) => a.time - b.time);
}

/** Highest and lowest price of the plan, which may be tomorrow's; none on an earlier day. */
function planned() {
  const last = state.last;
  if (shownDay || !last?.outlook_quarter_hours) return [];
  return ["cheapest", "dearest"].map((name) => ({
    x: Date.parse(last[name + "_utc"]), y: last[name + "_centi"] / 100})).sort((a, b) => a.x - b.x);
}

function drawDay(csv) {
  const cycles = cyclesOf(csv);
  const plan = planned();
  const stepped = {stepped: true};
  const hours = (scale) => {  // every third full hour, or more of a young log
    const span = scale.max - scale.min;
    const step = span > 6 * kHourMs ? kHourMs : span > 2 * kHourMs ? kHourMs / 2 : kHourMs / 6;
    const all = [];
    for (let t = Math.ceil(scale.min / step) * step; t <= scale.max; t += step) {
      if (step < kHourMs || Number(clock(t).slice(0, 2)) % 3 === 0) all.push({value: t});
    }
    scale.ticks = all;
  };
  const isPlanned = cycles.some(({breakEven}) => !Number.isNaN(breakEven));
  drawChart("day", () => ({
    type: "line",
    data: {datasets: [
      line("price", "ink", steps(cycles, (c) => c.price), {...stepped, yAxisID: "price"}),
      ...(isPlanned ? [line("break-even price", "mark", steps(cycles, (c) => c.breakEven),
                            {...stepped, yAxisID: "price", borderDash: [5, 4]})] : []),
      ...(plan.length ? [line("planned lowest and highest price", "mark", plan,
                              {yAxisID: "price", showLine: false, pointRadius: 5})] : []),
      line("state of charge", "good", steps(cycles, (c) => c.soc), {yAxisID: "soc"}),
      line("power measured", "muted", steps(cycles, (c) => c.measured),
           {...stepped, yAxisID: "power"}),
      line("power ordered: charging", "charge", steps(cycles, (c) => c.ordered),
           {...stepped, yAxisID: "power", borderWidth: 0,
            fill: {target: "origin", above: colour("charge"), below: colour("discharge")}}),
      line("discharging", "discharge", [], {yAxisID: "power"})]},
    options: {
      parsing: false, normalized: false,
      scales: {
        x: scale("", {bounds: "data", afterBuildTicks: hours, ticks: {callback: clock}}),
        power: strip("kW", 2), soc: strip("%", 2, {min: 0, max: 100}), price: strip("EUR/MWh", 4),
      },
      plugins: {tooltip: {callbacks: {title: ([item]) => clock(item.parsed.x)}}},
    },
  }));
}

const dayPath = () => shownDay ? `api/day?date=${shownDay}` : "api/log";

/** Shows the local day that is `days` later than the one shown, today's as the last 24 hours. */
async function turnTo(days) {
  const today = moment(state?.last?.utc ?? Date.now()).slice(0, 10);
  const noon = Date.parse((shownDay ?? today) + "T12:00:00Z") + days * kDayMs;
  const day = new Date(noon).toISOString().slice(0, 10);
  shownDay = day < today ? day : null;
  byId("day-title").textContent = shownDay ?? "Last 24 hours";
  byId("day-after").disabled = !shownDay;
  await show(dayPath(), "log-trouble", drawDay);
}

function drawMap({columns}) {
  if (columns.length === 0) return "No student decision in this control cycle.";
  const last = state.last;
  const now = {x: last.has_measurement ? last.soc_e4 / 100 : NaN,
               y: isPriced(last.reason) ? last.price_centi_eur_per_mwh / 100 : NaN};
  const points = (key) => columns.map((column) => ({x: column.soc_percent, y: column[key]}));
  const shown = [now, ...points("charge_up_to_eur_per_mwh"),
                 ...points("discharge_from_eur_per_mwh")];
  const prices = shown.map(({y}) => y).filter((y) => !Number.isNaN(y));
  const min = 50 * Math.floor(Math.min(...prices) / 50 - 1);
  const max = 50 * Math.ceil(Math.max(...prices) / 50 + 1);
  drawChart("map", () => ({
    type: "line",
    data: {datasets: [
      line("now", "ink", [now], {pointRadius: 6, showLine: false}),
      line("charges below", "charge", points("charge_up_to_eur_per_mwh"),
           {fill: "start", stepped: "middle", backgroundColor: colour("charge") + "55"}),
      line("discharges above", "discharge", points("discharge_from_eur_per_mwh"),
           {fill: "end", stepped: "middle", backgroundColor: colour("discharge") + "55"})]},
    options: {
      parsing: false, normalized: false,
      interaction: {mode: "nearest", axis: "x", intersect: false},
      scales: {x: scale("state of charge, %", {min: 0, max: 100}),
               y: scale("price, EUR/MWh", {min, max})},
      plugins: {tooltip: {callbacks: {title: ([item]) => percent(item.parsed.x)}}},
    },
  }));
}

/** Fetches and shows; false after an error. Element `trouble` shows it, or the text of `draw`. */
async function show(path, trouble, draw) {
  try {
    byId(trouble).textContent = draw(await ask(path)) || "";
    return true;
  } catch (error) {
    byId(trouble).textContent = error.message;
    return false;
  }
}

/** Marks the data as old, with the reason. */
function markOld(why) {
  const last = state?.last?.utc;
  byId("old").textContent = why && (last ? `${why} Data of ${moment(last)}.` : why);
  byId("old").hidden = !why;
  document.body.classList.toggle("old", Boolean(why));
}

async function renew() {
  if (document.hidden || isAsking) return;
  isAsking = true;
  try {
    state = await ask("api/status");
    showStatus(state);
    const cycle = `${state.health} ${state.last?.utc}`;
    if (cycle !== shownCycle) {
      const shown = await Promise.all([
        show("api/why", "why-trouble", showWhy),
        shownDay || show("api/log", "log-trouble", drawDay),
        show("api/map", "map-trouble", drawMap), show("api/month", "month-trouble", showMonth)]);
      shownCycle = shown.every(Boolean) ? cycle : null;
    }
    markOld(isRunning() ? "" : "No controller is running.");
  } catch (error) {
    markOld(`The controller does not answer: ${error.message}.`);
    if (!state) byId("health").textContent = "unknown";
  }
  isAsking = false;
  document.documentElement.dataset.ready = "true";
}

onColourScheme(redrawCharts);
byId("day-before").addEventListener("click", () => turnTo(-1));
byId("day-after").addEventListener("click", () => turnTo(1));
document.addEventListener("visibilitychange", renew);
setInterval(renew, kEveryMs);
renew();
