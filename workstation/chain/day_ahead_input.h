// --day-ahead: the outlook that policies may plan on, read, judged and given to the market.
#pragma once

#include <memory>
#include <string>

#include "shared/context_classes.h"
#include "shared/host/command_line.h"
#include "workstation/chain/price_input.h"
#include "workstation/market/feed/day_ahead_rows.h"
#include "workstation/market/series/day_ahead_publication.h"

namespace bess {

/// Judged by itself and by what was settled: prices filed under the wrong day are look-ahead.
/// Throws UserError.
std::shared_ptr<const DayAheadPublication> read_day_ahead(const std::string& path,
                                                          const MinuteSeries& settled,
                                                          const AcceptedFindings& accepted,
                                                          int published_min);

class DayAheadInput {
 public:
  DayAheadInput() = default;
  explicit DayAheadInput(std::string path) : path_(std::move(path)) {}
  /// Declares --day-ahead.
  void add(ProgramCommand& command);
  [[nodiscard]] const std::string& path() const { return path_; }
  /// What is learnt where no configuration says otherwise: by outlook when prices are given.
  [[nodiscard]] ContextKind context_unless_said() const {
    return path_.empty() ? ContextKind::kLevel : ContextKind::kOutlook;
  }
  /// Nothing when none is given, else read_day_ahead().
  [[nodiscard]] std::shared_ptr<const DayAheadPublication> read(const MinuteSeries& settled,
                                                                const AcceptedFindings& accepted,
                                                                int published_min) const;

 private:
  std::string path_;
};

/// Judges what was joined of `files`, writes it and says what it is. Throws UserError, and nothing
/// is written.
void write_judged_day_ahead(const JoinedDayAhead& joined, const AcceptedFindings& accepted,
                            const std::vector<std::string>& files, const std::string& provenance,
                            const std::string& out);

}  // namespace bess
