#include "workstation/runs/run/run_stages.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <utility>

#include "shared/host/command_line.h"
#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "workstation/correction/student/certificate.h"
#include "workstation/correction/student/correct_and_prove.h"
#include "workstation/correction/student/export.h"
#include "workstation/report/comparison.h"
#include "workstation/report/figures/curves.h"
#include "workstation/runs/chain/chain_steps.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/run/run_backtest.h"
#include "workstation/runs/run/run_record.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using namespace run_file;

constexpr std::string_view kTeacherStage = "teacher";
constexpr std::string_view kProofStage = "corrected student";
constexpr std::string_view kEvaluationStage = "evaluation";
constexpr std::string_view kReportStage = "report";
constexpr std::string_view kFailureStage = "report of the failed proof";

/// Adds or replaces seconds and end of a stage in times.json.
void note_time(const fs::path& path, const std::string& stage, double seconds) {
  Json times = Json::object();
  const Json before = fs::exists(path) ? Json::parse(read_file(path)) : Json::object();
  for (const JsonValue member : before.value()) {
    const auto took = member["seconds"].number();
    const char* end = member["finished_utc"].text();
    if (member.key() == stage || !took || end == nullptr) continue;
    times.set(std::string(member.key()).c_str(),
              Json::object({{"seconds", *took}, {"finished_utc", end}}));
  }
  times.set(stage.c_str(), Json::object({{"seconds", Decimals{seconds, 2}},
                                         {"finished_utc", utc_text(std::time(nullptr)).view()}}));
  write_file(path, times.text());
}

std::vector<DemandFigures> demand_figures(const Certificate& plain, const Certificate& corrected) {
  const std::vector<DemandCount> before = demand_counts(plain);
  const std::vector<DemandCount> after = demand_counts(corrected);
  std::vector<DemandFigures> figures;
  for (std::size_t d = 0; d < after.size(); ++d) {
    if (!after[d].binds_student) continue;
    figures.push_back(
        {after[d].label(), d < before.size() ? before[d].violations : 0, after[d].violations});
  }
  return figures;
}

/// Market of all prices, or of the record's fold.
MarketSteps market_of_run(const MinuteSeries& series, const RunConfig& config,
                          const RunRecord& record, const RunFolder& folder) {
  const std::string month = record.value(kFoldKey);
  MarketSteps market = market_of(series, config.market, record.prices_name);
  if (!record.day_ahead.empty()) {
    attach_day_ahead(market,
                     read_day_ahead(folder.path / record.day_ahead, series, AcceptedFindings::all(),
                                    config.market.day_ahead_published_min));
  }
  return month.empty() ? std::move(market) : market_of_fold(market, month);
}

/// Name of an unfinished file (file.cpp) of any process; safe because the folder is locked.
bool is_half_written(const std::string& name) {
  const std::size_t at = name.rfind(".part.");
  return at != name.npos && name.find_first_not_of("0123456789", at + 6) == name.npos;
}

}  // namespace

RunStages::RunStages(RunFolder folder, RunRecord record, const MinuteSeries& series,
                     std::FILE* messages)
    : folder_(std::move(folder)),
      record_(std::move(record)),
      config_(record_.config(folder_)),
      series_(series),
      market_(market_of_run(series, config_, record_, folder_)),
      messages_(messages) {}

void RunStages::report_line(const std::string& text) const {
  fmt::print(messages_, "      {}\n", text);
  std::fflush(messages_);
}

std::span<const RunStages::Stage> RunStages::stages() {
  using R = RunStages;
  using enum StageCondition;
  static const Stage kRows[] = {
      {"configuration", 1, "", &R::make_configuration, {}, {kConfig}},
      {"prices", 1, "", &R::make_prices, {}, {kSimulatedPrices}, kOnBuiltInPrices},
      {kTeacherStage,
       2,
       "train or copy the teacher",
       &R::make_teacher,
       {},
       {kTeacher, kTrainingCurve, kCheckpoint}},
      {"plain student",
       3,
       "distil without correction, for comparison",
       &R::make_plain_student,
       {kTeacher},
       {kPlainStudent, kPlainViolations},
       kUnlessLean},
      {kProofStage,
       4,
       "correct while distilling, and prove",
       &R::make_corrected_student,
       {kTeacher},
       {kStudent, kUnprovedStudent, kUnprovedViolations, kDistilCurve, kProofRounds, kCheckpoints}},
      {"header", 5, "export", &R::make_header, {kStudent}, {kHeader}},
      {kEvaluationStage,
       6,
       "evaluate on test days and write the report",
       &R::make_evaluation,
       {kTeacher, kPlainStudent, kStudent},
       {kTable, kDays}},
      {kReportStage,
       6,
       "",
       &R::make_report,
       {kTeacher, kPlainStudent, kPlainViolations, kStudent, kTrainingCurve, kDistilCurve, kDays},
       {kSummary, kReport},
       kUnlessLean},
      {kFailureStage,
       6,
       "report where the proof failed",
       &R::make_failure_report,
       {kTeacher, kPlainStudent, kPlainViolations, kUnprovedStudent},
       {kSummary, kReport},
       kAfterFailedProof},
  };
  return kRows;
}

const RunStages::Stage& RunStages::stage_named(std::string_view name) {
  return *std::ranges::find(stages(), name, &Stage::name);
}

int RunStages::count() { return stages().back().number; }

RunStages::Names RunStages::files() {
  Names files{kRecord, kTimes};
  for (const Stage& stage : stages()) {
    for (const std::string& file : stage.outputs) {
      if (std::ranges::find(files, file) == files.end()) files.push_back(file);
    }
  }
  return files;
}

std::string RunStages::help() {
  std::string text;
  for (const Stage& stage : stages()) {
    if (stage.condition == StageCondition::kAfterFailedProof) continue;  // the same files
    text +=
        fmt::format("  {}  {:<26}  {}\n", stage.number, stage.name, fmt::join(stage.outputs, ", "));
  }
  return text;
}

void RunStages::announce(const Stage& stage) const {
  if (*stage.text == '\0') return;
  fmt::print(messages_, "[{}/{}] {}\n", stage.number, count(), stage.text);
  std::fflush(messages_);
}

void RunStages::go_through(const Stage& row) {
  if (const StageRecord* done = record_.holds(std::string(row.name), row.inputs, folder_)) {
    if (done->failed) fail_the_proof();
    if (row.make != &RunStages::make_configuration) report_line(fmt::format("{}: kept", row.name));
    return;
  }
  const auto start = std::chrono::steady_clock::now();
  StageRecord stage{std::string(row.name), marks_of(row.inputs, folder_), {}, false};
  stage.outputs = marks_of((this->*row.make)(), folder_);
  stage.failed = std::exchange(unproved_, false);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  const bool failed = stage.failed;
  note(std::move(stage), taken.count());
  if (failed) fail_the_proof();
}

void RunStages::note(StageRecord stage, double seconds) {
  note_time(path(kTimes), stage.name, seconds);
  const auto before = std::ranges::find(record_.stages, stage.name, &StageRecord::name);
  if (before == record_.stages.end()) {
    record_.stages.push_back(std::move(stage));
  } else {
    *before = std::move(stage);
  }
  save_run_record(folder_, record_);
}

void RunStages::tidy() const {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_.path, error)) {
    if (is_half_written(entry.path().filename().string())) fs::remove(entry.path(), error);
  }
  if (record_.holds(std::string(kTeacherStage), {}, folder_) != nullptr)
    fs::remove(path(kCheckpoint), error);
}

void RunStages::finish() {
  tidy();
  const bool by_month = config_.train.context == ContextKind::kMonth;
  if (by_month || record_.value(kFoldKey).empty()) warn_untrained_months(market_, by_month);
  warn_unknown_regimes("this run", market_, market_, market_.days_of(Split::kTest));
  for (const Stage& stage : stages()) {
    if (!is_due(stage)) continue;
    announce(stage);
    go_through(stage);
    if (stage.name == kTeacherStage) tidy();  // not at the end: a failed proof throws before
  }
}

bool RunStages::is_due(const Stage& stage) const {
  using enum StageCondition;  // kAfterFailedProof: fail_the_proof() goes there
  return stage.condition == kAlways ||
         (stage.condition == kOnBuiltInPrices && record_.prices == kSimulatedPrices) ||
         (stage.condition == kUnlessLean && !record_.is_lean());
}

void RunStages::report_again() {
  const int proof = stage_named(kProofStage).number;
  for (const Stage& stage : stages()) {
    if (stage.number > proof || stage.condition == StageCondition::kOnBuiltInPrices) continue;
    if (record_.holds(std::string(stage.name), stage.inputs, folder_) != nullptr) continue;
    fail(
        "{}: the {} is missing or changed; regenerate it with 'bess-train run --resume --out "
        "{}'",
        folder_.path.string(), stage.name, folder_.path.string());
  }
  std::erase_if(record_.stages, [](const StageRecord& done) {
    return done.name == kReportStage || done.name == kFailureStage;
  });
  if (record_.has_failed()) return go_through(stage_named(kFailureStage));
  go_through(stage_named(kEvaluationStage));
  go_through(stage_named(kReportStage));
}

const Teacher& RunStages::teacher() {
  if (!teacher_) teacher_ = load_teacher(path(kTeacher));
  return *teacher_;
}

const Matrix& RunStages::visited() {
  if (!visited_) visited_ = visited_inputs(teacher(), market_, config_.battery, config_.distil);
  return *visited_;
}

RunStages::Names RunStages::make_configuration() {
  write_file(path(kConfig), format_run_config(config_));
  return {kConfig};
}

RunStages::Names RunStages::make_prices() {
  write_minute_file(path(kSimulatedPrices), series_, built_in_market_provenance());
  return {kSimulatedPrices};
}

RunStages::Names RunStages::make_teacher() {
  const bool is_taken = !record_.teacher_file.empty();
  report_line(is_taken ? "the teacher of " + record_.teacher_file
                       : "method " + std::string(method_name(config_.train.method)));
  return is_taken ? take_teacher() : train_teacher_here();
}

RunStages::Names RunStages::train_teacher_here() {
  std::string identity;
  for (const auto& [name, value] : record_.identity)
    identity += fmt::format("{} {}\n", name, value);
  const auto train = [&](bool resume) {
    return train_teacher(market_, config_.battery, config_.train, watch_from_first_call(),
                         {path(kCheckpoint), resume, identity});
  };
  const auto train_on = [&] {
    if (!fs::exists(path(kCheckpoint))) return train(false);
    try {
      return train(true);
    } catch (const CheckpointUnusable& error) {
      report_line(fmt::format("{}: training from the start", error.what()));
      fs::remove(path(kCheckpoint));
      return train(false);
    }
  };
  TrainResult trained = train_on();
  if (interruption()) {
    fmt::print(stderr, "{}\n", how_to_go_on(folder_, record_));
    throw Interrupted{};
  }
  end_when_interrupted(how_to_go_on(folder_, record_));
  warn_narrow_support(config_.train, trained);
  trained.teacher.provenance = training_provenance(record_.prices_name, config_.train, trained);
  trained.teacher.learnt_for =
      learnt_for(config_, record_.value(kFoldKey).empty()
                              ? prices_hash(series_)
                              : prices_hash(series_, market_.span_of(market_.fitted_days())));
  save_teacher(path(kTeacher), trained.teacher);
  (void)teacher();  // read now: by outlook it reuses the plans of the training
  write_file(path(kTrainingCurve), training_curve_csv(trained.curve));
  report_line(fmt::format("kept at step {}: {:.1f} EUR/day/MWh on validation days, {:.0f} s",
                          trained.best_step, trained.best_validation_eur_per_day_per_mwh,
                          trained.seconds));
  return {kTeacher, kTrainingCurve};
}

RunStages::Names RunStages::take_teacher() {
  Teacher taken = load_teacher(record_.teacher_file);
  if ((taken.outlook != nullptr) != (config_.train.context == ContextKind::kOutlook)) {
    fail("{}: {} by outlook, unlike this run: change [train] context or --day-ahead",
         record_.teacher_file, taken.outlook ? "decides" : "does not decide");
  }
  taken.learnt_for = learnt_for_of(record_.teacher_file);
  save_teacher(path(kTeacher), taken);
  write_file(path(kTrainingCurve), training_curve_csv({}));
  return {kTeacher, kTrainingCurve};
}

RunStages::Names RunStages::make_plain_student() {
  DistilOptions options = config_.distil;
  options.correct = false;
  const CorrectionResult plain = correct_and_prove(teacher(), visited(), options, interruption());
  const StudentFile& student = student_of(plain.verdict);
  save_student(path(kPlainStudent), student);
  write_file(path(kPlainViolations), counterexamples_csv(student.certificate.counterexamples));
  const std::string broken = round_of(student.certificate).text();
  report_line(fmt::format("{} violations in {} checked states{}", student.certificate.violations(),
                          student.certificate.states_checked, broken.empty() ? "" : ": " + broken));
  return {kPlainStudent, kPlainViolations};
}

RunStages::Names RunStages::make_corrected_student() {
  const CorrectionResult corrected =
      correct_and_prove(teacher(), visited(), config_.distil, interruption(),
                        validation_score(market_, config_.battery, config_.initial_soc_frac),
                        [&](const ProofRound& round, const RoundsState& state) {
                          if (state.done > 1 || round.violations() > 0)
                            report_line(round_line(round, state));
                        });
  const StudentFile& student = student_of(corrected.verdict);
  write_file(path(kProofRounds), proof_rounds_csv(corrected.rounds));
  write_file(path(kDistilCurve), distil_curve_csv(corrected.curve));
  write_file(path(kCheckpoints), student_checkpoints_csv(corrected.checkpoints));
  const auto* proved = std::get_if<ProvedStudent>(&corrected.verdict);
  unproved_ = proved == nullptr;
  if (unproved_) {
    save_student(path(kUnprovedStudent), student);
    write_file(path(kUnprovedViolations), counterexamples_csv(student.certificate.counterexamples));
    return {kUnprovedStudent, kUnprovedViolations, kDistilCurve, kProofRounds, kCheckpoints};
  }
  save_student(path(kStudent), student);
  proved_ = *proved;
  report_line(fmt::format("proved: no violation in {} states, {}",
                          student.certificate.states_checked,
                          counted(corrected.rounds.size(), "round")));
  return {kStudent, kDistilCurve, kProofRounds, kCheckpoints};
}

StudentFile RunStages::student_with(const char* violations, const char* name) const {
  StudentFile student = load_student(path(name));
  student.certificate.counterexamples =
      parse_counterexamples_csv(read_file(path(violations)), path(violations).string());
  return student;
}

void RunStages::fail_the_proof() {
  const std::string rounds = path(kProofRounds).string();
  const std::string what = describe_failed_proof(
      student_with(kUnprovedViolations, kUnprovedStudent),
      parse_proof_rounds_csv(read_file(rounds), rounds), config_.distil.method);
  if (record_.is_lean()) throw ProofFailed(what);
  const Stage& failure = stage_named(kFailureStage);
  announce(failure);
  go_through(failure);
  throw ProofFailed(what + fmt::format("\n  {} shows where; repeat the correction: bess-train run "
                                       "--from-teacher {} --config NEW --out ANOTHER",
                                       path(kReport).string(), folder_.path.string()));
}

/// The same page for an unproved student.
RunStages::Names RunStages::make_failure_report() {
  RunResults run = results(student_with(kUnprovedViolations, kUnprovedStudent));
  run.evaluations = evaluate_run(run, config_.train.threads);
  return write_run_report(std::move(run), config_, folder_);
}

RunStages::Names RunStages::make_header() {
  if (!proved_) {  // proved before a resume; export needs a new proof
    Verdict verdict = prove(load_student(path(kStudent)), config_.train.threads);
    auto* proved = std::get_if<ProvedStudent>(&verdict);
    if (proved == nullptr)
      fail("{}: not proved; remove it and resume the run", path(kStudent).string());
    proved_ = std::move(*proved);
  }
  write_file(path(kHeader), format_weight_header(*proved_));
  return {kHeader};
}

RunResults RunStages::results(StudentFile corrected) {
  const auto text = [&](const char* name) { return read_file(path(name)); };
  RunResults results{
      .market = market_,
      .battery = config_.battery,
      .initial_soc_frac = config_.initial_soc_frac,
      .training_curve =
          parse_training_curve_csv(text(kTrainingCurve), path(kTrainingCurve).string()),
      .distil_curve = parse_distil_curve_csv(text(kDistilCurve), path(kDistilCurve).string()),
      .teacher = teacher(),
      .corrected = std::move(corrected),
      .walk_forward = walk_forward_of(folder_, record_)};
  if (fs::exists(path(kCheckpoints))) {  // missing in older runs
    results.checkpoints = parse_student_checkpoints_csv(text(kCheckpoints), kCheckpoints);
  }
  if (!record_.is_lean()) results.plain = student_with(kPlainViolations, kPlainStudent);
  return results;
}

RunStages::Names RunStages::make_evaluation() {
  const RunResults run = results(load_student(path(kStudent)));
  const std::vector<NamedEvaluation> evaluations = evaluate_run(run, config_.train.threads);
  if (record_.is_lean()) record_.figures = figures_of(run);
  write_file(path(kTable), comparison_csv(evaluations));
  write_file(path(kDays), evaluation_days_csv(evaluations));
  return {kTable, kDays};
}

RunFigures RunStages::figures_of(const RunResults& run) const {
  const Certificate& certificate = run.corrected.certificate;
  const Certificate plain = run.plain ? run.plain->certificate : Certificate{};
  return {run.corrected.provenance,
          fmt::format("{:08x}", student_weights_hash(run.corrected.net)),
          certificate.states_checked,
          plain.states_checked,
          plain.violations(),
          certificate.violations(),
          demand_figures(plain, certificate),
          last_learnt_day(market_)};
}

RunStages::Names RunStages::make_report() {
  RunResults run = results(load_student(path(kStudent)));
  run.evaluations =
      parse_evaluation_days_csv(read_file(path(kDays)), path(kDays).string(), config_.battery);
  record_.figures = figures_of(run);
  return write_run_report(std::move(run), config_, folder_);
}

std::string how_to_go_on(const RunFolder& folder, const RunRecord& record) {
  if (!record.value(kFoldKey).empty() || record.is_lean()) {
    return "finished stages are kept: repeat the command to continue";
  }
  return fmt::format("finished stages are kept; to continue: bess-train run --resume --out {}",
                     folder.path.string());
}

}  // namespace bess
