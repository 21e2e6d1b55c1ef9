// Prices as commands take them, minutes and day-ahead: built-in or from files, checked, with
// --accept for findings that are intended.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "shared/context_classes.h"
#include "shared/host/command_line.h"
#include "shared/host/minute_file.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/data/market/feed/day_ahead_rows.h"
#include "workstation/data/market/feed/market_files.h"
#include "workstation/data/market/series/day_ahead.h"
#include "workstation/data/market/series/judged_prices.h"

namespace bess {

// The market of a run that was given no prices: one local year, so that every month is seen.

inline constexpr const char* kBuiltInMarketName = "built-in market";

MinuteSeries built_in_market();
/// What its minute file says about it.
std::string built_in_market_provenance();

/// How the provenance of made-up prices begins.
inline constexpr const char* kSimulatedProvenance = "Simulated, not real";

class PriceInput {
 public:
  /// Declares --accept.
  void add(ProgramCommand& command);

  [[nodiscard]] AcceptedFindings accepted() const { return AcceptedFindings(accept_); }
  /// A minute file.
  [[nodiscard]] MinuteSeries read(const std::string& path) const;
  /// Minute files and downloads in any mixture. Throws UserError as join_market() does.
  [[nodiscard]] JoinedMarket read_joined(const std::vector<std::string>& files,
                                         std::set<MarketSource>* sources = nullptr,
                                         const OwnForm& own = {}) const;

 private:
  std::string accept_;
};

/// The prices as decisions; what is wrong with them as a whole is told by `name`, that of their
/// file.
MarketSteps market_of(const MinuteSeries& series, const MarketOptions& options,
                      const std::string& name);

/// Judges what was made of `files` by its prices and by what was found while joining; rows are
/// named by reading the files once more, which happens only when there is something to say.
void judge_market(const MinuteSeries& series, std::vector<Finding> found,
                  const std::vector<std::string>& files, const AcceptedFindings& accepted);

/// One line on the standard error when months have no training day: months of the year when the
/// student learns by month, otherwise months of these prices.
void warn_untrained_months(const MarketSteps& market, bool learns_by_month);

// --day-ahead: the outlook that policies may plan on, read, judged and given to the market.

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
