// A folder of recorded days, one file a local day: 2025-06-15.csv. Local, because Elia's
// near-real-time datasets begin anew at local midnight, because `prices fetch` and the split into
// training, validation and test count local days, and because the file of a day then holds what
// that day's policy saw: 1,380, 1,440 or 1,500 minutes. Times inside are UTC. Files only grow. A
// line is on the disk when append() returns; what a crash tore off is cut when the day is opened
// again. One folder belongs to one recorder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "workstation/market/feed/recorded_day.h"
#include "workstation/market/series/local_date.h"

namespace bess {

/// What the file holds of a minute: the newest of each value.
struct RecordedMinute {
  std::optional<double> price_eur_per_mwh, system_imbalance_mw;  ///< NaN = published without one
  QualityStatus quality;
  bool had_price = false;  ///< one of its lines has one
};

/// A day that is over, for the user.
struct RecordedDaySummary {
  std::string file;
  std::int64_t minutes_with_price, minutes;  ///< of the day
};

class RecordingFolder {
 public:
  /// Makes the folder if need be and locks it. `source` is named at the head of new files. Throws
  /// UserError when another recorder holds it.
  RecordingFolder(
      std::filesystem::path folder, std::string source,
      std::function<void(const std::string& file, const std::string& what)> tell_mended);
  ~RecordingFolder();
  RecordingFolder(const RecordingFolder&) = delete;
  RecordingFolder& operator=(const RecordingFolder&) = delete;

  /// What is recorded of a minute; opens its day.
  [[nodiscard]] RecordedMinute recorded(std::int64_t minute_utc_s);
  /// Throws UserError when they cannot be written; then none of its day's is.
  void append(std::span<const RecordedLine> lines);
  /// Days that ended an hour before `newest_minute_utc_s` are closed; those appended to are told
  /// of.
  std::vector<RecordedDaySummary> close_days_before(std::int64_t newest_minute_utc_s);

 private:
  class Day;
  class Lock;
  Day& day_of(std::int64_t minute_utc_s);

  std::filesystem::path folder_;
  std::string source_;
  std::function<void(const std::string&, const std::string&)> tell_mended_;
  std::unique_ptr<Lock> lock_;
  std::map<LocalDate, std::unique_ptr<Day>> days_;
};

}  // namespace bess
