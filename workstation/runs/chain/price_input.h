// Price inputs of commands, minute and day-ahead: built-in or from files, checked, with --accept
// for intended findings.
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
#include "workstation/data/market/series/plausibility.h"

namespace bess {

// Default market of a run: one local year, so that every month occurs.

inline constexpr const char* kBuiltInMarketName = "built-in market";

MinuteSeries built_in_market();
/// Provenance line of its minute file.
std::string built_in_market_provenance();

/// Start of the provenance of simulated prices.
inline constexpr const char* kSimulatedProvenance = "Simulated, not real";

struct PriceInput {
  std::string accept;  ///< names of findings

  /// Declares --accept.
  void add(ProgramCommand& command);

  [[nodiscard]] AcceptedFindings accepted() const { return AcceptedFindings(accept); }
  /// A minute file.
  [[nodiscard]] MinuteSeries read(const std::string& path) const;
  /// Minute files and downloads in any mixture. Throws UserError as join_market() does.
  [[nodiscard]] JoinedMarket read_joined(const std::vector<std::string>& files,
                                         std::set<MarketSource>* sources = nullptr,
                                         const CustomCsvFormat& own = {}) const;
};

/// Prices as market steps; errors name the file `name`.
MarketSteps market_of(const MinuteSeries& series, const MarketOptions& options,
                      const std::string& name);

/// Checks the joined prices and the findings of the join. Reads the files again to name rows, only
/// if there are findings.
void judge_market(const MinuteSeries& series, std::vector<Finding> found,
                  const std::vector<std::string>& files, const AcceptedFindings& accepted);

/// Warning on stderr when months have no training day: months of the year if the student's context
/// is the month, else months of these prices.
void warn_untrained_months(const MarketSteps& market, bool learns_by_month);

// Option --day-ahead: day-ahead prices, checked and attached to the market.

/// Checked alone and against settled prices: prices filed under the wrong day would be look-ahead.
/// Throws UserError.
std::shared_ptr<const DayAheadPublication> read_day_ahead(const std::string& path,
                                                          const MinuteSeries& settled,
                                                          const AcceptedFindings& accepted,
                                                          int published_min);

struct DayAheadInput {
  std::string path;  ///< empty: none

  /// Declares --day-ahead.
  void add(ProgramCommand& command);
  /// Default context: outlook when day-ahead prices are given.
  [[nodiscard]] ContextKind context_unless_said() const {
    return path.empty() ? ContextKind::kLevel : ContextKind::kOutlook;
  }
  /// Attaches the prices of read_day_ahead(), if any.
  void attach_to(MarketSteps& market, const MinuteSeries& settled, const AcceptedFindings& accepted,
                 const MarketOptions& options) const;
};

/// Checks, writes and describes the prices joined from `files`. Throws UserError before writing.
void write_judged_day_ahead(const JoinedDayAhead& joined, const AcceptedFindings& accepted,
                            const std::vector<std::string>& files, const std::string& provenance,
                            const std::string& out);

}  // namespace bess
