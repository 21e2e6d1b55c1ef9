// Evaluation and report of one run from its folder, with the provenance for its page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/report/comparison.h"
#include "workstation/report/report.h"
#include "workstation/report/report_tables.h"
#include "workstation/runs/chain/run_config.h"
#include "workstation/runs/run/run_record.h"

namespace bess {

// Provenance of a run's page: date, run, host, command, program and prices.

/// "bess-train 0.1.0, BUILD"
std::string program_text();

/// Reads prices from run.json and stage times from times.json, if present. With SOURCE_DATE_EPOCH
/// (reproducible-builds.org) run, host, command and times are left out: the same run gives the same
/// bytes.
Entries run_facts(const RunConfig& config, const MarketSteps& market, const RunFolder& folder);

// Results of finished runs, for `run --json` and `runs compare`.

struct RunSummary {
  RunFolder folder;
  RunRecord record;
  std::vector<NamedEvaluation> evaluations;  ///< empty unless the run is finished and unedited
  std::string trouble{};                     ///< why a finished run has none, without a full stop
};

/// Throws UserError with a remedy when there is no finished run.
RunSummary load_run_summary(const RunFolder& folder);

/// One object: run, figures and every policy in both accountings.
Json summary_json(const RunSummary& run);

/// Value of a key as readable text in one line.
std::string value_text(const RunRecord& record, const std::string& key);
/// Keys whose values differ between runs.
std::vector<std::string> differing_keys(const std::vector<RunSummary>& runs);

/// Gain over another run; none without the same days.
std::optional<PairedDifference> gain_over_run(const Evaluation& run, const Evaluation& first);

/// One line per run, and the different settings.
std::string format_runs_table(const std::vector<RunSummary>& runs);

// Page of many runs: profit, proof, rules and settings, with a link to each run's
// report. Failed, stopped and edited runs are listed with their state.

/// Throws UserError only when the folder contains no run.
RunSummary load_any_run(const RunFolder& folder);

/// Gains are over the first finished run. Links are relative to the folder of `page`.
std::string runs_page(const std::vector<RunSummary>& runs, const std::filesystem::path& page);

/// Throws UserError naming `prices`. Call before training.
void require_test_days(const MarketSteps& market, const std::string& prices);

/// Test days in both accountings: rule-based first, then other baselines, teacher, plain student if
/// any, corrected student and foresight.
std::vector<NamedEvaluation> evaluate_run(const RunResults& run, int threads);

/// Completes the results and writes figures with CSV files, report.html and summary; returns their
/// names in order. Precondition: there are evaluations and a plain student.
std::vector<std::string> write_run_report(RunResults run, const RunConfig& config,
                                          const RunFolder& folder);

}  // namespace bess
