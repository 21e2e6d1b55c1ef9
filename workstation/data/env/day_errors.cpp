#include "workstation/data/env/day_errors.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "workstation/base/student_t.h"

namespace bess {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
/// With this many months the error's own relative error is below a quarter.
constexpr int kMonthsEnough = 10;

/// "2023-01" of "2023-01-31".
std::string_view month_of(const std::string& date) { return std::string_view(date).substr(0, 7); }

}  // namespace

double mean_of(const std::vector<DayValue>& days) {
  double sum = 0;
  for (const auto& [date, value] : days) sum += value;
  return sum / static_cast<double>(days.size());
}

DayErrors day_errors(const std::vector<DayValue>& days) {
  if (days.empty()) return {};
  const auto n = static_cast<double>(days.size());
  const double mean = mean_of(days);
  double squares = 0;
  std::map<std::string_view, double> sums;  // deviations by month
  for (const auto& [date, value] : days) {
    squares += (value - mean) * (value - mean);
    sums[month_of(date)] += value - mean;
  }
  double month_squares = 0;
  for (const auto& [month, sum] : sums) month_squares += sum * sum;
  const auto g = static_cast<double>(sums.size());
  return {days.size() < 2 ? kUnknown : std::sqrt(squares / (n - 1) / n),
          sums.size() < 2 ? kUnknown : std::sqrt(g / (g - 1) * month_squares) / n,
          static_cast<int>(sums.size()), static_cast<int>(days.size())};
}

double interval_half_width(const DayErrors& errors, double coverage) {
  if (std::isnan(errors.plain)) return kUnknown;
  const double plain = student_t_within(coverage, errors.days - 1) * errors.plain;
  if (std::isnan(errors.by_month)) return plain;
  return std::max(plain, student_t_within(coverage, errors.months - 1) * errors.by_month);
}

std::string error_text(double error, int decimals, std::string_view unknown) {
  return std::isnan(error) ? std::string(unknown) : fmt::format("{:.{}f}", error, decimals);
}

std::string by_month_meaning(int months) {
  std::string text =
      "the standard error with the days of a month as one draw, since adjacent days are similar";
  if (months < 2) return text + "; unknown, as all days are in one month";
  if (months >= kMonthsEnough) return fmt::format("{}; {} months", text, months);
  return fmt::format("{}; from {} months, accurate only to {:.0f} %", text, months,
                     100 / std::sqrt(2.0 * (months - 1)));
}

}  // namespace bess
