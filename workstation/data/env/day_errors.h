// How sure a mean over days is: its standard error as if each day were drawn by itself, and with
// the days of a local calendar month taken as one draw.
//
// Days side by side are alike: a dear week lifts all of its days, and the plain error takes them
// for so many witnesses. Errors clustered by month let the days of a month depend on each other in
// any way, and only the months not. With n days d_i of mean m in G months g:
//
//   plain       sqrt( sum_i (d_i - m)^2 / (n - 1) / n )
//   by month    sqrt( G / (G - 1) * sum_g S_g^2 ) / n,   S_g = sum over the days of g of (d_i - m)
//
// (Liang and Zeger 1986, for a mean, with the correction of Cameron and Miller 2015; of months of
// equal length it is the deviation of their means over sqrt(G).) The test days of a month, 26 to
// the end, lie three weeks from those of the next: months are blocks already. A moving-block
// bootstrap (Kuensch 1989) would join days that are no neighbours, and draw from as few blocks,
// with a seed, what is a formula here.
//
// Of few months the error itself is hardly known: its relative error is about 1 / sqrt(2 (G - 1)),
// 41 % of four. The mean over it is then Student's t with G - 1 degrees (Bester, Conley and Hansen
// 2011), which the interval counts with. It is never narrower than the plain one, since the error
// by few months may be small by chance (Angrist and Pischke 2009, 8.2.3).
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace bess {

/// In the unit of the days; NaN where it cannot be known: plain of one day, by_month of one month.
struct DayErrors {
  double plain;
  double by_month;
  int months;  ///< that the days lie in
  int days;
};

/// A local date, "2023-01-31", and what that day brought; days of a month need not lie together.
using DayValue = std::pair<std::string, double>;

DayErrors day_errors(const std::vector<DayValue>& days);

/// Half of the interval that holds the true mean with probability `coverage` (0..1): the wider one
/// of both errors, each times Student's t. NaN where no error is known.
double interval_half_width(const DayErrors& errors, double coverage);

/// For a table: with so many decimals, or `unknown`.
std::string error_text(double error, int decimals, std::string_view unknown = "-");

/// The coverage at which a gain is called shown, and what lies within it, for people.
inline constexpr double kShownCoverage = 0.95;
inline constexpr const char* kIntervalMeaning =
    "its interval of 95 %, the wider one of both errors by Student's t,";

/// What the error by month is, and how well so many months can tell it: for people, below where it
/// stands.
std::string by_month_meaning(int months);

}  // namespace bess
