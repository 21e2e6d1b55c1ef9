// What a run's folder says about itself (run.json): what the run is made of, and each stage that is
// done, with the hashes of what it read and wrote. Written anew after every stage, so that a run
// that ends anywhere can be taken up where it was. Times are elsewhere (times.json): the same run
// gives the same record.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shared/host/json.h"
#include "workstation/base/answer.h"
#include "workstation/runs/chain/run_config.h"
#include "workstation/runs/run/run_folder.h"

namespace bess {

/// "crc32 1234abcd, 4711 bytes" of the file as it lies on the disk; empty when there is none to
/// read.
std::string file_mark(const std::filesystem::path& path);

struct StageRecord {
  std::string name;
  Entries inputs;       ///< files of the folder and their marks
  Entries outputs;      ///< the same
  bool failed = false;  ///< it ran to its end and the student was not proved
};

/// What one property or rule came to: its label, and its violations in the plain and in the
/// corrected student.
struct DemandFigures {
  std::string demand;
  std::int64_t violations_plain = 0;
  std::int64_t violations_corrected = 0;
};

/// A list of objects.
Json demands_json(const std::vector<DemandFigures>& demands);

/// What a finished run comes to.
struct RunFigures {
  std::string provenance;
  std::string weights_hash;
  std::int64_t states_checked = 0;
  std::int64_t states_checked_plain = 0;  ///< fewer: it is only looked at
  std::int64_t violations_plain = 0;
  std::int64_t violations_corrected = 0;
  std::vector<DemandFigures> demands = {};  ///< of which the violations are the sums
  std::string last_learnt_day = {};         ///< trained or chosen on; empty: not told
};

/// In `identity`: the text of a rule file, if there are any rules.
inline constexpr const char* kRulesKey = "rules";
/// In `identity` where there are day-ahead prices: their file's mark.
inline constexpr const char* kDayAheadKey = "day-ahead";
/// In `identity` of a run on one fold of a walk-forward alone (run_backtest.h): its month or days.
inline constexpr const char* kFoldKey = "fold";
/// In `identity` of a lean run, which makes no plain student, no figures and no page: "lean".
inline constexpr const char* kStagesKey = "stages";
inline constexpr const char* kLean = "lean";

struct RunRecord {
  std::string prices;          ///< the minute file; without a folder when it is the run's own
  std::string prices_name;     ///< as students tell where they come from
  std::string teacher_file;    ///< that the run began with; empty when it trains its own
  Entries identity;            ///< all that the run's bytes depend on: options and every key
  std::string commit = {};     ///< of the bess-train that wrote it last; empty: not told
  std::string day_ahead = {};  ///< the day-ahead file, as `prices`; empty: there are none
  std::vector<StageRecord> stages;
  std::optional<RunFigures> figures;

  [[nodiscard]] std::string value(const std::string& key) const;  ///< of `identity`; or empty
  [[nodiscard]] bool is_lean() const { return value(kStagesKey) == kLean; }
  [[nodiscard]] RunConfig config(const RunFolder& folder) const;
  /// Null unless the stage was done with these `inputs` as they are now, and its outputs are as
  /// they were.
  [[nodiscard]] const StageRecord* holds(const std::string& stage,
                                         const std::vector<std::string>& inputs,
                                         const RunFolder& folder) const;
  /// It ran to its end, and its student was not proved.
  [[nodiscard]] bool has_failed() const;
  /// "finished", or where it stopped.
  [[nodiscard]] std::string state() const;
};

/// The run of a configuration, seed and threads included.
Entries identity_of(const RunConfig& config, const std::string& prices_hash,
                    const std::string& teacher_hash);

/// "KEY is A there and B here; ...": empty when they are the same.
std::string differences(const Entries& there, const Entries& here,
                        const std::string& where_there = "there",
                        const std::string& where_here = "here");

/// The keys of a configuration alone.
Entries configuration_of(const Entries& identity);
/// Of these, what a policy is learnt for: market, battery and costs.
Entries circumstances_of(const Entries& identity);

/// None when the folder has no run.json. Throws UserError when that is not a run's, or of another
/// bess-train.
std::optional<RunRecord> load_run_record(const RunFolder& folder);
void save_run_record(const RunFolder& folder, const RunRecord& record);

}  // namespace bess
