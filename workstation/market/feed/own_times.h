// Times of price files that are nobody's download: dates in a named order, with their UTC offset or
// by a named clock. Nothing is guessed: what could be two instants is refused, naming the line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

enum class WallClock { kUtc, kLocal };

struct OwnTimes {
  std::string date_format = "yyyy-mm-dd";
  std::optional<WallClock> clock{};  ///< of times without an offset
};

/// A line or a part of one, and the line's number.
struct TextLine {
  std::size_t number;
  std::string_view text;
};

/// The instants in UTC, one of each text. Of a local hour that comes twice, in autumn, the order of
/// the rows tells which is which. Throws UserError.
std::vector<std::int64_t> read_times(const std::vector<TextLine>& texts, std::string_view name,
                                     const OwnTimes& form);

/// Seconds between prices, 60 or 900: what most neighbours are apart. Throws UserError for others.
std::int64_t step_of_times(std::vector<std::int64_t> utc_s, std::string_view name);

}  // namespace bess
