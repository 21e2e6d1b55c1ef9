// Evaluation and report of one run, from the content of its folder, and the facts of the run for
// its page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/report/comparison.h"
#include "workstation/report/evaluation_days.h"
#include "workstation/report/figures/curves.h"
#include "workstation/report/report.h"
#include "workstation/report/report_tables.h"
#include "workstation/runs/chain/run_config.h"
#include "workstation/runs/run/run_folder.h"
#include "workstation/runs/run/run_record.h"

namespace bess {

// Where a run's page comes from: when, where and by what it was made, and from which prices.

/// When, where, by which command and how long; with SOURCE_DATE_EPOCH set the date alone.
std::vector<Fact> making_facts(const RunFolder& folder);
/// "bess-train 0.1.0, BUILD"
std::string program_text();

/// Reads run.json of `folder` for the prices and, where there is one, times.json for its stages'
/// times. With SOURCE_DATE_EPOCH in the environment (reproducible-builds.org) that is the date, and
/// what differs from one making to the next, host, command and times, is left out: the same run
/// gives the same bytes.
std::vector<Fact> run_facts(const RunConfig& config, const MarketSteps& market,
                            const RunFolder& folder);

// Finished runs as figures: what `run --json` prints and `runs compare` lines up.

/// The policy that a run is about: what would be exported.
inline constexpr const char* kExportedPolicy = "corrected student";

struct RunSummary {
  RunFolder folder;
  RunRecord record;
  std::vector<NamedEvaluation> evaluations;
};

/// The days that it is judged by.
JudgedDays judged_days_of(const RunSummary& run);

/// Throws UserError when there is no run or it is not finished, saying how to go on.
RunSummary load_run_summary(const RunFolder& folder);

/// One object: the run, its figures and every policy in both ways of counting.
Json summary_json(const RunSummary& run);

/// The value of a key for people, in one line; rules by what they say.
std::string value_text(const RunRecord& record, const std::string& key);
/// The keys, of any run, of which the runs have not all the same value.
std::vector<std::string> differing_keys(const std::vector<const RunRecord*>& runs);

/// A line a run, and what the runs differ in.
std::string format_runs_table(const std::vector<RunSummary>& runs);

struct RunResults {
  const RunConfig& config;
  const MarketSteps& market;
  const Teacher& teacher;
  std::optional<StudentFile> plain;  ///< none of a lean run
  StudentFile corrected;             ///< both with the certificate of the proof that the run made
  std::vector<CurvePoint> training_curve;
  std::vector<DistilPoint> distil_curve;
  WalkForwardOfRun walk_forward;  ///< of the same prices and configuration
  std::vector<StudentCheckpoint> checkpoints = {};
};

/// Throws UserError, which names `prices`: asked before anything is trained.
void require_test_days(const MarketSteps& market, const std::string& prices);

/// Test days, day reset and carried over: rule-based first, then the other baselines, the teacher,
/// the plain and the corrected student, and foresight last. Without a plain student,
/// what stands on it is left out.
std::vector<NamedEvaluation> evaluate_run(const RunResults& run);

/// Precondition: there is a plain student. Writes the figures with their CSV files, report.html and
/// the summary; returns the names of all.
std::vector<std::string> write_run_report(const RunResults& run,
                                          const std::vector<NamedEvaluation>& evaluations,
                                          const RunFolder& folder);

}  // namespace bess
