// Prices as the commands take them: read, judged, and with --accept for what is meant.
#pragma once

#include <string>
#include <vector>

#include "shared/host/command_line.h"
#include "workstation/env/market_steps.h"
#include "workstation/market/feed/market_files.h"
#include "workstation/market/series/judged_prices.h"

namespace bess {

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

}  // namespace bess
