#include "tools/market_sim/minute_file.h"

#include <sys/stat.h>
#include <zlib.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "shared/utc_text.h"
#include "tools/sim/sim_error.h"

namespace bess {
namespace {

constexpr std::string_view kHeader = "minute_utc,indicative_eur_mwh,settled_eur_mwh";

std::string read_plain_or_gzip(const std::string& path) {
  struct stat info {};
  if (stat(path.c_str(), &info) == 0 && S_ISDIR(info.st_mode)) {
    sim_fail("{}: is a folder, not a file", path);
  }
  gzFile file = gzopen(path.c_str(), "rb");  // reads plain files as they are
  if (file == nullptr) sim_fail("{}: cannot open: {}", path, std::strerror(errno));
  std::string text;
  std::vector<char> buffer(1 << 20);
  int got = 0;
  while ((got = gzread(file, buffer.data(), static_cast<unsigned>(buffer.size()))) > 0) {
    text.append(buffer.data(), static_cast<std::size_t>(got));
  }
  int error = Z_OK;
  gzerror(file, &error);
  const bool bad = got < 0 || error == Z_BUF_ERROR;
  if (gzclose(file) == Z_BUF_ERROR || bad) {
    sim_fail("{}: truncated or damaged gzip file; fetch or copy it again", path);
  }
  return text;
}

/// Takes the text up to the next `separator` off the front of `rest`.
std::string_view take_field(std::string_view& rest, char separator) {
  const std::size_t end = rest.find(separator);
  const std::string_view field = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  return field;
}

bool parse_price(std::string_view text, double& price) {
  price = std::numeric_limits<double>::quiet_NaN();
  if (text.empty()) return true;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), price);
  return error == std::errc{} && end == text.data() + text.size() && std::isfinite(price);
}

MinutePrice parse_line(std::string_view line, const std::string& name, int number) {
  std::string_view rest = line;
  MinutePrice price{};
  const std::string_view time = take_field(rest, ',');
  const std::string_view indicative = take_field(rest, ',');
  const std::string_view settled = take_field(rest, ',');
  if (!parse_utc_text(time, price.minute_utc_s) || price.minute_utc_s % 60 != 0 ||
      !time.ends_with('Z')) {
    sim_fail("{}:{}: \"{}\" is not a UTC minute such as 2023-01-01T00:00:00Z", name, number, time);
  }
  if (!rest.empty()) sim_fail("{}:{}: more than three columns", name, number);
  if (!parse_price(indicative, price.indicative_eur_per_mwh)) {
    sim_fail("{}:{}: \"{}\" is not a price", name, number, indicative);
  }
  if (!parse_price(settled, price.settled_eur_per_mwh)) {
    sim_fail("{}:{}: \"{}\" is not a price", name, number, settled);
  }
  return price;
}

}  // namespace

std::vector<MinutePrice> parse_minute_prices(std::string_view text, const std::string& name) {
  std::vector<MinutePrice> prices;
  bool has_header = false;
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // spreadsheets put one there
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  for (int number = 1; !text.empty(); ++number) {
    std::string_view line = take_field(text, '\n');
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || line.starts_with('#')) continue;
    if (!has_header) {
      if (line != kHeader) sim_fail("{}:{}: the header must be {}", name, number, kHeader);
      has_header = true;
      continue;
    }
    prices.push_back(parse_line(line, name, number));
    if (prices.size() > 1 && prices.back().minute_utc_s <= prices[prices.size() - 2].minute_utc_s) {
      sim_fail("{}:{}: minutes must ascend; sort the file", name, number);
    }
  }
  if (prices.empty()) sim_fail("{}: holds no minutes", name);
  return prices;
}

std::vector<MinutePrice> read_minute_prices(const std::string& path) {
  return parse_minute_prices(read_plain_or_gzip(path), path);
}

}  // namespace bess
