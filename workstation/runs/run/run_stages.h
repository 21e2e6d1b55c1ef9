// A run as stages, each from files of the run's folder to files of it: what is done and whole is
// kept, what is not is done, in order. Every stage reads its inputs from the disk, so that a run
// that was interrupted anywhere ends with the same bytes as one that was not.
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
  /// What it is about goes to `messages`. The folder is locked by the caller.
  RunStages(RunFolder folder, RunRecord record, const MinuteSeries& series, std::FILE* messages);

  /// Every stage. Throws ProofFailed when the corrected student was not proved, now or before.
  void finish();
  /// The report once more. Throws UserError naming what is missing.
  void report_again();
  /// The closing table.
  [[nodiscard]] std::string summary() const;
  /// Of the days that the run may see.
  [[nodiscard]] const MarketSteps& market() const { return market_; }

  using Names = std::vector<std::string>;
  enum class When { kAlways, kOnBuiltInPrices, kUnlessLean, kAfterFailedProof };
  struct Stage {
    std::string_view name;  ///< in run.json and times.json
    int number;             ///< of those that are announced
    const char* text;       ///< empty: not announced, it goes with the one before
    When when;
    Names (RunStages::*make)();  ///< the files that it wrote
    Names inputs;                ///< by whose marks it is kept
    Names outputs;               ///< at most; figures and their tables not named
  };
  /// In order. Resuming, progress, help and the list of a run's files go by these rows.
  static std::span<const Stage> stages();
  /// All files that a run writes, but for the figures.
  static Names files();
  /// The number of the last stage that is announced; the first are the prices.
  static int count();
  /// A line a stage: its number, its name and what it writes.
  static std::string help();

 private:
  static const Stage& stage_named(std::string_view name);
  [[nodiscard]] bool is_due(const Stage& stage) const;
  /// Keeps what is whole, else makes it. Throws ProofFailed.
  void go_through(const Stage& stage);
  /// Notes that the stage is done and took `seconds`.
  void note(StageRecord stage, double seconds);
  void announce(const Stage& stage) const;
  void tell(const std::string& text) const;
  /// Removes what was left behind half-written, and a checkpoint that has served.
  void tidy() const;

  Names make_configuration();
  Names make_prices();
  Names make_teacher();
  Names train_teacher_here();
  Names take_teacher();
  Names make_plain_student();
  Names make_corrected_student();
  [[noreturn]] void fail_the_proof();
  void report_the_failure();
  [[nodiscard]] StudentFile unproved_student() const;
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
  std::optional<Teacher> teacher_;       ///< once it is needed
  std::optional<Matrix> visited_;        ///< the same
  std::optional<ProvedStudent> proved_;  ///< when it was proved just now
  bool unproved_ = false;                ///< the stage that is being made ended without a proof
};

/// One line for whoever interrupts the run.
std::string how_to_go_on(const RunFolder& folder, const RunRecord& record);

}  // namespace bess
