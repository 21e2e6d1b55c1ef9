// Start of the page: data, charts, day and maps. Errors are shown on the page.
"use strict";

/** Colours of the run's own policies; openPage adds those of the baselines. */
const kPolicyColours = {"corrected student": "line-1", "unproved student": "line-1",
                        "plain student": "line-2", "teacher": "line-3"};

const kProfitUnit = "EUR/day/MWh of capacity", kSumUnit = "EUR/MWh of capacity";

/** Colour of a policy on the whole page. */
function policyColour(name) {
  return colour(kPolicyColours[name] || "muted");
}

/** State for tests and the console. */
const page = {};

async function openPage() {
  page.data = JSON.parse(document.getElementById("data").textContent);
  for (const rival of page.data.rivals) kPolicyColours[rival.name] = rival.colour;
  showMapKeys((page.data.rules || []).length > 0);
  drawTraining(page.data.learning);
  drawCheckpoints(page.data.learning);
  drawDistillation(page.data.learning);
  drawPriceHistogram(page.data.prices);
  page.map = new PolicyMap(page.data);
  page.days = await unpackDays(page.data.archive);
  page.day = new DayView(page.data, page.days, (state) => {
    page.map.showState(state);
    document.getElementById("policy").scrollIntoView();
  });
  page.day.openAt(page.day.widest());
  page.day.openByLinks();
  page.tearSheet = new TearSheet(page.data, page.days);
  page.tearSheet.draw();
  onColourScheme(() => {
    redrawCharts();
    page.map.paint();
  });
  document.documentElement.dataset.ready = "true";
}

openPage().catch((error) => {
  const text = document.createElement("p");
  text.className = "failure";
  text.textContent =
    `Part of this page could not be shown: ${error.message}. Use a browser of 2023 or newer.`;
  document.querySelector("main").prepend(text);
  throw error;
});
