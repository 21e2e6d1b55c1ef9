// The door through which prices come in: what is implausible about them is an error that names file
// and row, or, when it is a warning or the user accepted it, one line on the standard error.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/data/market/series/plausibility.h"

namespace bess {

/// Names of findings that the user means: their errors become warnings.
class AcceptedFindings {
 public:
  AcceptedFindings() = default;
  /// `list` is NAME[,NAME]; throws UserError when a name is none.
  explicit AcceptedFindings(std::string_view list);
  /// For commands that describe prices instead of using them.
  static AcceptedFindings all();
  [[nodiscard]] bool accepts(std::string_view name) const;

 private:
  std::vector<std::string> names_;
};

/// Where the prices came from, so that a finding can name the row.
struct PriceText {
  std::string name;
  std::string_view text;
};

/// Throws UserError with the first error that is not accepted; prints all else, a line each.
void judge(const std::vector<Finding>& findings, const AcceptedFindings& accepted,
           const std::vector<PriceText>& texts);

/// Number of the row that holds the time, counted from 1 with comments and header; 0 when none
/// does.
std::size_t row_of_time(std::string_view text, std::int64_t utc_s);

/// Reads a minute file and judges it.
MinuteSeries read_judged_minutes(const std::filesystem::path& path,
                                 const AcceptedFindings& accepted);
/// Judges what was read from a minute file's text.
void judge_minutes(const MinuteSeries& series, const PriceText& text,
                   const AcceptedFindings& accepted);

}  // namespace bess
