#include "tools/hil_runner/run/run_scenario.h"

#include <fmt/core.h>

#include <chrono>

#include "edge/core/control/policy.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "tools/hil_runner/run/agreement.h"
#include "tools/hil_runner/scenario/edge_settings.h"
#include "tools/hil_runner/scenario/publication.h"
#include "tools/hil_runner/virtual/virtual_world.h"

namespace bess {
namespace {

void run_and_judge(const Scenario& scenario, const WallSite& site, Outcome& outcome,
                   WorkFolder& folder) {
  if (scenario.day_ahead && student_outlook() == nullptr) {
    fail(
        "{}: [day_ahead] needs a student with context outlook, which this program does not have: "
        "use "
        "bess-hil-outlook",
        scenario.path);
  }
  outcome.prices = scenario_prices(scenario);
  const EdgeConfig config = load_edge_settings(scenario, folder.file("judge.toml"),
                                               edge_settings(scenario, outcome.prices, {}));
  outcome.evidence = outcome.is_virtual ? run_virtual(scenario, outcome.prices, config)
                                        : run_wall(scenario, outcome.prices, site, folder);
  if (outcome.is_virtual) outcome.signature = signature_of(outcome.evidence);
  outcome.findings = judge({scenario, outcome.prices, config, outcome.evidence});
}

}  // namespace

std::string complaint(const Outcome& outcome) {
  if (!outcome.error.empty()) return outcome.error;
  if (outcome.findings.empty()) return "";
  const Finding& first = outcome.findings.front();
  const double minute = static_cast<double>(first.utc_s - outcome.scenario.start_utc_s) / 60;
  const std::string more =
      outcome.findings.size() > 1 ? fmt::format(", and {} more", outcome.findings.size() - 1) : "";
  return fmt::format("{}: expected {}, seen {}, at {} (minute {:.1f}){}", first.rule,
                     first.expected, first.seen, utc_text(first.utc_s).view(), minute, more);
}

Outcome run_scenario(const Scenario& scenario, bool in_virtual_time, const WallSite& site) {
  Outcome outcome;
  outcome.scenario = site.battery ? on_real_battery(scenario, *site.battery) : scenario;
  outcome.is_virtual = in_virtual_time;
  outcome.is_real = site.battery.has_value();
  if (in_virtual_time && !scenario.runs_virtual) outcome.skipped = "for wall time";
  if (!in_virtual_time && !scenario.runs_wall) outcome.skipped = "for virtual time";
  if (site.battery && outcome.skipped.empty()) {
    outcome.skipped = why_not_real(scenario, *site.battery);
  }
  if (!in_virtual_time && outcome.skipped.empty()) outcome.skipped = why_not_wall(scenario);
  if (!outcome.skipped.empty()) return outcome;
  const auto begin = std::chrono::steady_clock::now();
  WorkFolder folder;
  try {
    run_and_judge(outcome.scenario, site, outcome, folder);
  } catch (const HostTooSlow& late) {
    outcome.error = late.what();
    outcome.is_late = true;
  } catch (const std::exception& error) {
    outcome.error = error.what();
  }
  if (!in_virtual_time && outcome.failed()) {
    folder.keep();
    outcome.kept_folder = folder.file("");
  }
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return outcome;
}

}  // namespace bess
