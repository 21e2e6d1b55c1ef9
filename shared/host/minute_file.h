// Minute file: exchange format between markets, learning and evaluation. A dense series of minutes
// with the indicative price (known at the time) and the settled price (paid). File: CSV or .csv.gz,
// header `minute_utc,indicative_eur_mwh,settled_eur_mwh`, UTC with Z, strictly ascending; empty
// indicative = not published, empty settled = not settled. Lines starting with # are provenance
// comments.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

struct MinuteSeries {
  std::int64_t start_utc_s = 0;    ///< first minute, a multiple of 60
  std::vector<double> indicative;  ///< [minute] EUR/MWh, NaN = not published
  std::vector<double> settled;     ///< [minute] EUR/MWh of the minute's quarter-hour, NaN = unknown

  [[nodiscard]] std::size_t size() const { return settled.size(); }
  [[nodiscard]] std::int64_t utc_s(std::size_t minute) const {
    return start_utc_s + 60 * static_cast<std::int64_t>(minute);
  }
  /// True if a minute has neither price; files omit it.
  [[nodiscard]] bool is_empty(std::size_t minute) const {
    return std::isnan(indicative[minute]) && std::isnan(settled[minute]);
  }
};

/// True if no minute of a column has a price.
bool has_no_price(std::span<const double> prices);

/// True for a text with the header of a minute file.
bool is_minute_csv(std::string_view text);

/// Parses a minute file's text; `name` is used in messages. Throws UserError naming the line.
MinuteSeries parse_minute_csv(std::string_view text, std::string_view name);
MinuteSeries read_minute_file(const std::filesystem::path& path);

/// CSV text of a series, prices in the shortest exact form, without minutes that have no price.
/// `provenance` becomes # comment lines at the head (one per line of the string, may be empty).
std::string format_minute_csv(const MinuteSeries& series, std::string_view provenance);
void write_minute_file(const std::filesystem::path& path, const MinuteSeries& series,
                       std::string_view provenance);

}  // namespace bess
