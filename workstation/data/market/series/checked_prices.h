// Price input gate: implausible prices are errors with file and row. Warnings and accepted errors
// are one line each on standard error.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/data/market/series/plausibility.h"

namespace bess {

/// Names of accepted findings: their errors become warnings.
class AcceptedFindings {
 public:
  AcceptedFindings() = default;
  /// `list` is NAME[,NAME]; throws UserError for an unknown name.
  explicit AcceptedFindings(std::string_view list);
  /// For commands that only describe prices.
  static AcceptedFindings all();
  [[nodiscard]] bool accepts(std::string_view name) const;

 private:
  std::vector<std::string> names_;
};

/// Text of the prices, so that a finding can name the row.
struct PriceText {
  std::string name;
  std::string_view text;
};

/// Throws UserError for the first error that is not accepted; prints the others, one per line.
void judge(const std::vector<Finding>& findings, const AcceptedFindings& accepted,
           const std::vector<PriceText>& texts);

/// Row number of a time, counted from 1 with comments and header; 0 if not found.
std::size_t row_of_time(std::string_view text, std::int64_t utc_s);

/// Reads a minute file and checks it.
MinuteSeries read_judged_minutes(const std::filesystem::path& path,
                                 const AcceptedFindings& accepted);
/// Checks the series of a minute file's text.
void judge_minutes(const MinuteSeries& series, const PriceText& text,
                   const AcceptedFindings& accepted);

}  // namespace bess
