// Run manifest (run.json): inputs, and each finished stage with the hashes of its files. Rewritten
// after every stage, so that an interrupted run can be resumed. Times are in times.json: the same
// run gives the same manifest.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "shared/host/minute_file.h"
#include "workstation/base/answer.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {

// Run folder: file names of one run of the whole chain.

namespace run_file {
inline constexpr const char* kRecord = "run.json";
inline constexpr const char* kTimes = "times.json";
inline constexpr const char* kConfig = "config.toml";
inline constexpr const char* kSimulatedPrices = "prices.csv.gz";
inline constexpr const char* kTeacher = "teacher.bin";
inline constexpr const char* kCheckpoint = "teacher.checkpoint";
inline constexpr const char* kTrainingCurve = "training_curve.csv";
inline constexpr const char* kPlainStudent = "student_plain.json";
inline constexpr const char* kPlainViolations = "student_plain_violations.csv";
inline constexpr const char* kStudent = "student.json";
inline constexpr const char* kUnprovedStudent = "student_unproved.json";
inline constexpr const char* kUnprovedViolations = "student_unproved_violations.csv";
inline constexpr const char* kDistilCurve = "distil_curve.csv";
inline constexpr const char* kProofRounds = "proof_rounds.csv";
inline constexpr const char* kCheckpoints = "student_checkpoints.csv";
inline constexpr const char* kHeader = "student_weights.h";
inline constexpr const char* kTable = "evaluation.csv";
inline constexpr const char* kDays = "evaluation_days.csv";
inline constexpr const char* kSummary = "summary.txt";
inline constexpr const char* kReport = "report.html";
}  // namespace run_file

struct RunFolder {
  std::filesystem::path path;

  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return path / name; }
  [[nodiscard]] std::filesystem::path record() const { return file(run_file::kRecord); }
};

/// "crc32 1234abcd, 4711 bytes" of the file as stored; empty when it cannot be read.
std::string file_mark(const std::filesystem::path& path);
/// The files `names` of a folder and their marks.
Entries marks_of(const std::vector<std::string>& names, const RunFolder& folder);

struct StageRecord {
  std::string name;
  Entries inputs;       ///< files and their marks
  Entries outputs;      ///< the same
  bool failed = false;  ///< finished, but the student was not proved
};

/// Violations of one property or rule by the plain and the corrected student.
struct DemandFigures {
  std::string demand;
  std::int64_t violations_plain = 0;
  std::int64_t violations_corrected = 0;
};

/// Results of a finished run.
struct RunFigures {
  std::string provenance;
  std::string weights_hash;
  std::int64_t states_checked = 0;
  std::int64_t states_checked_plain = 0;  ///< fewer: a sample
  std::int64_t violations_plain = 0;
  std::int64_t violations_corrected = 0;
  std::vector<DemandFigures> demands = {};  ///< their sums are the violations
  std::string last_learnt_day = {};         ///< used for training or selection; empty: unknown
};

/// Adds them, without the last learnt day, to a manifest or an answer.
void add_figures(const RunFigures& figures, Json& json);

/// In `identity`, if there are rules: the text of a rule file.
inline constexpr const char* kRulesKey = "rules";
/// In `identity`, if there are day-ahead prices: their file's mark.
inline constexpr const char* kDayAheadKey = "day-ahead";
/// In `identity` of a run on one fold (run_backtest.h): its month or days.
inline constexpr const char* kFoldKey = "fold";
/// In `identity` of a lean run (no plain student, figures or page): "lean".
inline constexpr const char* kStagesKey = "stages";
inline constexpr const char* kLean = "lean";

struct RunRecord {
  std::string prices;          ///< minute file; without a folder if in the run's folder
  std::string prices_name;     ///< name in the provenance of students
  std::string teacher_file;    ///< given teacher; empty when the run trains its own
  Entries identity;            ///< all inputs of the run: options and keys
  std::string commit = {};     ///< of the bess-train that wrote it last; empty: unknown
  std::string day_ahead = {};  ///< day-ahead file, as `prices`; empty: none
  std::vector<StageRecord> stages;
  std::optional<RunFigures> figures;

  [[nodiscard]] std::string value(const std::string& key) const { return value_in(identity, key); }
  [[nodiscard]] bool is_lean() const { return value(kStagesKey) == kLean; }
  [[nodiscard]] RunConfig config(const RunFolder& folder) const;
  /// Null unless the stage is finished and its `inputs` and outputs are unchanged.
  [[nodiscard]] const StageRecord* holds(const std::string& stage,
                                         const std::vector<std::string>& inputs,
                                         const RunFolder& folder) const;
  /// Finished, but the student was not proved.
  [[nodiscard]] bool has_failed() const;
  /// "finished", or where it stopped.
  [[nodiscard]] std::string state() const;
};

/// Identity of a run of a configuration, with seed and threads.
Entries identity_of(const RunConfig& config, const std::string& prices_hash,
                    const std::string& teacher_hash);

/// "KEY is A there and B here; ...": empty when equal.
std::string differences(const Entries& there, const Entries& here,
                        const std::string& where_there = "there",
                        const std::string& where_here = "here");

/// Configuration keys of an identity.
Entries configuration_of(const Entries& identity);
/// Keys of the training scope: market, battery and costs.
Entries circumstances_of(const Entries& identity);

/// None without run.json. Throws UserError when it is malformed or of another version.
std::optional<RunRecord> load_run_record(const RunFolder& folder);
/// The same; throws UserError with a remedy when there is none.
RunRecord existing_run_record(const RunFolder& folder);
void save_run_record(const RunFolder& folder, const RunRecord& record);

// Training scope of a model: battery, market, costs and price regime, with warnings when it is used
// outside it. Source: the model file, else the run in its folder.

/// Training scope of a teacher: market, battery and costs of `config`, and prices_hash() of the
/// prices.
Entries learnt_for(const RunConfig& config, const std::string& prices);

/// Scope stored in the model file or the run in its folder; empty when unknown.
Entries learnt_for_of(const std::filesystem::path& model);

/// "KEY is A there and B here; ..." for each key of `here` with another value in `there`.
std::string learnt_otherwise(const Entries& there, const Entries& here);

/// Warning on stderr when `days` of `market` are in a price regime without training or validation
/// days in `fitting`.
void warn_unknown_regimes(const std::string& what, const MarketSteps& fitting,
                          const MarketSteps& market, const std::vector<MarketDay>& days);

/// Warning with remedy when the latest day of these prices is old at `now_utc_s` or in another
/// price regime; else empty.
std::string old_prices(const MinuteSeries& series, std::int64_t now_utc_s);

/// Warning on stderr when the scopes differ, or when `days` are in an unknown price regime.
void warn_learnt_otherwise(const std::filesystem::path& model, const Entries& here,
                           const MarketSteps& market = {}, const std::vector<MarketDay>& days = {});

}  // namespace bess
