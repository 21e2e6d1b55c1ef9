// Sortable tables (class "sortable"): by column head, or by a list on narrow screens.
"use strict";

/**
 * Sorts rows by `data-sort` of a column, numerically if possible; empty values come last.
 */
function sortTable(table, column, descending) {
  const value = (row) => row.cells[column].dataset.sort;
  const filled = [...table.tBodies[0].rows].filter((row) => value(row) !== "");
  const empty = [...table.tBodies[0].rows].filter((row) => value(row) === "");
  const numeric = filled.every((row) => Number.isFinite(Number(value(row))));
  const compare = (a, b) => numeric ? Number(value(a)) - Number(value(b))
                                    : value(a).localeCompare(value(b), "en", {numeric: true});
  filled.sort((a, b) => (descending ? compare(b, a) : compare(a, b)));
  table.tBodies[0].append(...filled, ...empty);
  [...table.tHead.rows[0].cells].forEach((head, c) => {
    if (c === column) head.setAttribute("aria-sort", descending ? "descending" : "ascending");
    else head.removeAttribute("aria-sort");
  });
}

for (const table of document.querySelectorAll("table.sortable")) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => head.querySelector("button").addEventListener(
    "click", () => sortTable(table, column, head.getAttribute("aria-sort") === "ascending")));
  const list = document.createElement("select");
  list.setAttribute("aria-label", "Sort by");
  list.append(new Option("sort by \u2026", ""), ...heads.flatMap((head, column) => [
    new Option(`${head.textContent}, smallest first`, `${column}+`),
    new Option(`${head.textContent}, largest first`, `${column}-`)]));
  list.className = "sorting";
  list.addEventListener("change", () => {
    if (list.value !== "") sortTable(table, parseInt(list.value, 10), list.value.endsWith("-"));
  });
  table.before(list);
}
document.documentElement.dataset.ready = "true";
