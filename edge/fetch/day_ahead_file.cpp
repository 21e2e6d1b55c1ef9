#include "edge/fetch/day_ahead_file.h"

#include <charconv>
#include <cstdio>

#include "edge/log/text_checksum.h"
#include "edge/log/whole_file.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::string_view kHead =
    "# bess day-ahead 1: quarter-hour, hundredths of EUR/MWh, received\n";
constexpr std::size_t kUtcBytes = 20;
constexpr std::size_t kLineBytesMax = 2 * kUtcBytes + 12;
constexpr std::size_t kFileBytesMax =
    kHead.size() + DayAheadBook::kPricesMax * kLineBytesMax + sizeof "# crc32=01234567\n";

/// One reader and one writer, at different times: before the loop, and the fetching thread.
char* file_text() {
  static char text[kFileBytesMax];
  return text;
}

/// False for a line that none of ours is.
bool parse_line(std::string_view line, KnownPrice& price) {
  const std::size_t first = line.find(' ');
  const std::size_t last = line.rfind(' ');
  if (first == line.npos || first == last) return false;
  const std::string_view centi = line.substr(first + 1, last - first - 1);
  const auto read =
      std::from_chars(centi.data(), centi.data() + centi.size(), price.centi_eur_per_mwh);
  return read.ec == std::errc{} && read.ptr == centi.data() + centi.size() &&
         parse_utc(line.substr(0, first), price.utc_s) &&
         parse_utc(line.substr(last + 1), price.received_utc_s);
}

}  // namespace

bool keep_day_ahead(const char* path, const DayAheadBook& book) {
  char* const text = file_text();
  std::size_t size = kHead.copy(text, kHead.size());
  for (const KnownPrice& price : book.prices()) {
    if (price.utc_s == 0 || price.is_assumed) continue;
    size += static_cast<std::size_t>(std::snprintf(
        text + size, kFileBytesMax - size, "%s %d %s\n", utc_text(price.utc_s).c_str(),
        price.centi_eur_per_mwh, utc_text(price.received_utc_s).c_str()));
  }
  const FixedText<31> end = checksum_end({text, size}, kCommentChecksum);
  size += end.view().copy(text + size, kFileBytesMax - size);
  return replace_file_durably(path, {text, size});
}

int restore_day_ahead(const char* path, DayAheadBook& book) {
  char* const text = file_text();
  const ssize_t size = read_beginning(path, {text, kFileBytesMax}, Links::kRefused);
  if (size <= 0) return 0;
  std::string_view rest(text, static_cast<std::size_t>(size));
  if (!rest.starts_with(kHead) || check_text(rest, kCommentChecksum) != TextState::kIntact)
    return 0;
  rest = without_checksum(rest, kCommentChecksum).substr(kHead.size());
  int prices = 0;
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    KnownPrice price;
    if (parse_line(rest.substr(0, end), price) && book.restore(price)) ++prices;
    rest = end == rest.npos ? std::string_view{} : rest.substr(end + 1);
  }
  return prices;
}

}  // namespace bess
