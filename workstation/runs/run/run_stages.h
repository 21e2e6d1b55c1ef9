// Stages of a run, each from files of the run folder to files of it. Finished and unchanged stages
// are kept, the others run in order. Every stage reads its inputs from disk, so that a resumed run
// ends with the same bytes as an uninterrupted one.
#pragma once

#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/minute_file.h"
#include "workstation/correction/student/prove.h"
#include "workstation/runs/run/run_record.h"
#include "workstation/runs/run/run_report.h"

namespace bess {

class RunStages {
 public:
  /// Progress goes to `messages`. The caller locks the folder.
  RunStages(RunFolder folder, RunRecord record, const MinuteSeries& series, std::FILE* messages);

  /// Runs all stages. Throws ProofFailed when the corrected student was not proved, now or before.
  void finish();
  /// Regenerates the report. Throws UserError naming missing stages.
  void report_again();
  /// Market of the days that the run may use.
  [[nodiscard]] const MarketSteps& market() const { return market_; }

  using Names = std::vector<std::string>;
  enum class StageCondition { kAlways, kOnBuiltInPrices, kUnlessLean, kAfterFailedProof };
  struct Stage {
    std::string_view name;       ///< in run.json and times.json
    int number;                  ///< of the announced stages
    const char* text;            ///< empty: not announced
    Names (RunStages::*make)();  ///< returns the written files
    Names inputs;                ///< kept while their marks are unchanged
    Names outputs;               ///< possible files, without figures and their tables
    StageCondition condition = StageCondition::kAlways;
  };
  /// In order; used for resuming, progress, help and the list of files.
  static std::span<const Stage> stages();
  /// All files that a run writes, except the figures.
  static Names files();
  /// Number of the last announced stage; stage 1 is the prices.
  static int count();
  /// One line per stage: number, name and files.
  static std::string help();

 private:
  static const Stage& stage_named(std::string_view name);
  [[nodiscard]] bool is_due(const Stage& stage) const;
  /// Keeps or runs a stage. Throws ProofFailed.
  void go_through(const Stage& stage);
  /// Records a finished stage.
  void note(StageRecord stage, double seconds);
  void announce(const Stage& stage) const;
  void report_line(const std::string& text) const;
  /// Removes unfinished files and an obsolete checkpoint.
  void tidy() const;

  Names make_configuration();
  Names make_prices();
  Names make_teacher();
  Names train_teacher_here();
  Names take_teacher();
  Names make_plain_student();
  Names make_corrected_student();
  [[noreturn]] void fail_the_proof();
  /// Student `name` with the violations of another file.
  [[nodiscard]] StudentFile student_with(const char* violations, const char* name) const;
  Names make_failure_report();
  Names make_header();
  Names make_evaluation();
  Names make_report();

  [[nodiscard]] std::filesystem::path path(const char* name) const { return folder_.file(name); }
  const Teacher& teacher();
  const Matrix& visited();
  RunResults results(StudentFile corrected);
  [[nodiscard]] RunFigures figures_of(const RunResults& run) const;

  RunFolder folder_;
  RunRecord record_;
  RunConfig config_;
  const MinuteSeries& series_;
  MarketSteps market_;
  std::FILE* messages_;
  std::optional<Teacher> teacher_;       ///< loaded on demand
  std::optional<Matrix> visited_;        ///< computed on demand
  std::optional<ProvedStudent> proved_;  ///< if proved in this process
  bool unproved_ = false;                ///< the current stage ended without a proof
};

/// How to continue an interrupted run, in one line.
std::string how_to_go_on(const RunFolder& folder, const RunRecord& record);

}  // namespace bess
