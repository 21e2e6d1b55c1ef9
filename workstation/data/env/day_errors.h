// Standard errors of a mean over days: with independent days, and with the days of a local calendar
// month as one draw.
//
// Adjacent days are similar: an expensive week raises all of its days, and the plain error treats
// them as independent. Errors clustered by month allow any dependence within a month and none
// between months. With n days d_i of mean m in G months g:
//
//   plain       sqrt( sum_i (d_i - m)^2 / (n - 1) / n )
//   by month    sqrt( G / (G - 1) * sum_g S_g^2 ) / n,   S_g = sum over the days of g of (d_i - m)
//
// [Liang and Zeger 1986, for a mean; correction of Cameron and Miller 2015; with months of equal
// length the standard deviation of their means over sqrt(G)]. The test days of a month, 26 to the
// end, are three weeks from those of the next: months are already blocks. A moving-block bootstrap
// (Kuensch 1989) would join days that are not adjacent and replace a formula by random draws from
// equally few blocks.
//
// With few months the error itself is uncertain: its relative error is about 1 / sqrt(2 (G - 1)),
// 41 % with four. The mean divided by it follows Student's t with G - 1 degrees of freedom [Bester,
// Conley and Hansen 2011]. The interval uses this and is never narrower than the plain one, since
// the error of few months may be small by chance [Angrist and Pischke 2009, 8.2.3].
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace bess {

/// In the unit of the days; NaN if unknown: plain with one day, by_month with one month.
struct DayErrors {
  double plain = std::numeric_limits<double>::quiet_NaN();
  double by_month = std::numeric_limits<double>::quiet_NaN();
  int months = 0;  ///< number of months with days
  int days = 0;
};

/// Local date, "2023-01-31", and the day's value; days of a month need not be adjacent.
using DayValue = std::pair<std::string, double>;

double mean_of(const std::vector<DayValue>& days);
DayErrors day_errors(const std::vector<DayValue>& days);

/// Half-width of the interval that contains the true mean with probability `coverage` (0..1): the
/// larger of both errors, each times its Student's t. NaN if no error is known.
double interval_half_width(const DayErrors& errors, double coverage);

/// For tables: with `decimals`, or `unknown`.
std::string error_text(double error, int decimals, std::string_view unknown = "-");

/// Coverage at which a gain counts as shown, and the text for its interval.
inline constexpr double kShownCoverage = 0.95;
inline constexpr const char* kIntervalMeaning =
    "its 95 % interval, the wider of both errors by Student's t,";

/// Explanation of the error by month and its accuracy, for tables.
std::string by_month_meaning(int months);

}  // namespace bess
