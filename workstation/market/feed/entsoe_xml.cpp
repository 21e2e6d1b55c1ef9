#include "workstation/market/feed/entsoe_xml.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "shared/host/minute_file.h"
#include "shared/host/plain_text.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

constexpr std::int64_t kPeriodSecondsMax = 366LL * 86'400;  // the platform answers a year at most

struct Tag {
  std::string_view name;  ///< without namespace prefix and attributes
  bool closing;
  std::string_view text;  ///< up to the next tag
};

/// Next tag of the document; comments, processing instructions and empty elements are passed over.
bool take_tag(std::string_view& rest, Tag& tag) {
  while (true) {
    const std::size_t open = rest.find('<');
    if (open == std::string_view::npos) return false;
    rest.remove_prefix(open);
    const bool comment = rest.starts_with("<!--");
    const std::size_t end = comment ? rest.find("-->") : rest.find('>');
    if (end == std::string_view::npos) return false;
    const std::string_view inside = rest.substr(1, end - 1);
    rest.remove_prefix(end + (comment ? 3 : 1));
    if (inside.empty() || inside[0] == '!' || inside[0] == '?' || inside.back() == '/') continue;
    tag.closing = inside[0] == '/';
    tag.name = inside.substr(tag.closing ? 1 : 0);
    tag.name = tag.name.substr(0, tag.name.find_first_of(" \t\r\n"));
    const std::size_t prefix = tag.name.find(':');
    if (prefix != std::string_view::npos) tag.name.remove_prefix(prefix + 1);
    tag.text = rest.substr(0, rest.find('<'));
    return true;
  }
}

struct Prices {
  double long_eur_per_mwh = kNotPublished;
  double short_eur_per_mwh = kNotPublished;

  /// The one price; NaN when there are two different ones.
  [[nodiscard]] double single() const {
    if (!is_published(long_eur_per_mwh)) return short_eur_per_mwh;
    if (!is_published(short_eur_per_mwh)) return long_eur_per_mwh;
    return long_eur_per_mwh == short_eur_per_mwh ? long_eur_per_mwh : kNotPublished;
  }
};

/// Which party a point's price is for; documents of some areas name none.
enum Category { kBoth, kLong, kShort, kCategoryCount };

class DocumentReader {
 public:
  explicit DocumentReader(std::string_view name) : name_(name) {}
  void read(std::string_view text);
  [[nodiscard]] MarketRows rows() const;

 private:
  struct Point {
    std::int64_t position = 0;
    double amount = kNotPublished;
    Category category = kBoth;
  };

  void open(const Tag& tag);
  void close(const Tag& tag);
  void finish_period();
  void set_prices(std::int64_t first_utc_s, const Point& point);
  [[noreturn]] void refuse_acknowledgement(std::string_view rest) const;
  void require_unit(std::string_view unit, std::string_view wanted) const;
  [[nodiscard]] std::int64_t time_of(std::string_view text) const;
  template <typename Number>
  [[nodiscard]] Number number_of(std::string_view text) const;

  std::string_view name_;
  bool is_document_ = false;
  bool repeats_ = false;  ///< curveType A03
  std::int64_t start_utc_s_ = 0, end_utc_s_ = 0, resolution_s_ = 0;
  Point point_;
  std::vector<Point> points_;
  std::map<std::int64_t, Prices> prices_;
};

/// Everything here reckons in EUR/MWh.
void DocumentReader::require_unit(std::string_view unit, std::string_view wanted) const {
  if (unit == wanted) return;
  fail("{}: prices in or per \"{}\" where {} is needed; use an area that publishes EUR per MWH",
       name_, one_line(unit, 20), wanted);
}

std::int64_t DocumentReader::time_of(std::string_view text) const {
  std::int64_t utc_s = 0;
  if (!parse_utc(text, utc_s) || utc_s % kSecondsPerQuarterHour != 0) {
    fail("{}: \"{}\" is not the UTC start of a quarter-hour; download the file again", name_,
         one_line(text, 40));
  }
  return utc_s;
}

template <typename Number>
Number DocumentReader::number_of(std::string_view text) const {
  Number value{};
  const char* text_end = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), text_end, value);
  if (error != std::errc{} || end != text_end || !std::isfinite(static_cast<double>(value))) {
    fail("{}: \"{}\" is not a number; download the file again", name_, one_line(text, 40));
  }
  return value;
}

void DocumentReader::open(const Tag& tag) {
  if (tag.name == "Balancing_MarketDocument") is_document_ = true;
  if (tag.name == "TimeSeries") repeats_ = false;
  if (tag.name == "curveType") repeats_ = tag.text == "A03";
  if (tag.name == "Period") points_.clear(), start_utc_s_ = end_utc_s_ = resolution_s_ = 0;
  if (tag.name == "start") start_utc_s_ = time_of(tag.text);
  if (tag.name == "end") end_utc_s_ = time_of(tag.text);
  if (tag.name == "resolution") {
    resolution_s_ = tag.text == "PT15M" ? 900 : tag.text == "PT30M" ? 1800 : 3600;
    if (resolution_s_ == 3600 && tag.text != "PT60M" && tag.text != "PT1H") {
      fail("{}: resolution \"{}\" is not known; PT15M, PT30M and PT60M are", name_,
           one_line(tag.text, 20));
    }
  }
  if (tag.name == "currency_Unit.name") require_unit(tag.text, "EUR");
  if (tag.name == "price_Measure_Unit.name") require_unit(tag.text, "MWH");
  if (tag.name == "Point") point_ = {};
  if (tag.name == "position") point_.position = number_of<std::int64_t>(tag.text);
  if (tag.name == "imbalance_Price.amount") point_.amount = number_of<double>(tag.text);
  if (tag.name == "imbalance_Price.category") {
    point_.category = tag.text == "A04" ? kLong : tag.text == "A05" ? kShort : kBoth;
  }
}

void DocumentReader::close(const Tag& tag) {
  if (tag.name == "Point") points_.push_back(point_);
  if (tag.name == "Period") finish_period();
}

/// A price of a longer interval is that of each of its quarter-hours.
void DocumentReader::set_prices(std::int64_t first_utc_s, const Point& point) {
  for (std::int64_t part_s = 0; part_s < resolution_s_; part_s += kSecondsPerQuarterHour) {
    Prices& prices = prices_[first_utc_s + part_s];
    if (point.category != kShort) prices.long_eur_per_mwh = point.amount;
    if (point.category != kLong) prices.short_eur_per_mwh = point.amount;
  }
}

void DocumentReader::finish_period() {
  const std::int64_t span_s = end_utc_s_ - start_utc_s_;
  if (resolution_s_ == 0 || span_s <= 0 || span_s > kPeriodSecondsMax) {
    fail("{}: a period without start, end or resolution; download the file again", name_);
  }
  // Some documents list all long prices, then all short ones.
  std::stable_sort(points_.begin(), points_.end(),
                   [](const Point& a, const Point& b) { return a.position < b.position; });
  if (!points_.empty() && points_.front().position < 1) {
    fail("{}: positions start at 1; download the file again", name_);
  }
  // Where points repeat, one holds until the next of its own category.
  std::array<std::optional<Point>, kCategoryCount> current;
  std::size_t next = 0;
  for (std::int64_t position = 1; position <= span_s / resolution_s_; ++position) {
    if (!repeats_) current = {};
    for (; next < points_.size() && points_[next].position <= position; ++next) {
      current[points_[next].category] = points_[next];
    }
    const std::int64_t first_utc_s = start_utc_s_ + (position - 1) * resolution_s_;
    for (const std::optional<Point>& point : current) {
      if (point) set_prices(first_utc_s, *point);
    }
  }
  if (next < points_.size()) {
    fail("{}: a point lies outside its period; download the file again", name_);
  }
}

/// What ENTSO-E answers instead of data: the rest of the document holds its reason.
void DocumentReader::refuse_acknowledgement(std::string_view rest) const {
  Tag tag{};
  std::string reason;
  while (take_tag(rest, tag)) {
    if (tag.name == "text" && !tag.closing) reason += std::string(tag.text) + " ";
  }
  fail("{}: ENTSO-E sent no prices but a reason: \"{}\"", name_, one_line(reason, 200));
}

void DocumentReader::read(std::string_view text) {
  Tag tag{};
  while (take_tag(text, tag)) {
    if (tag.closing) {
      close(tag);
    } else {
      open(tag);
    }
    if (tag.name == "Acknowledgement_MarketDocument") refuse_acknowledgement(text);
    if (!is_document_) {
      fail("{}: not an ENTSO-E balancing document (A85) but \"{}\"", name_, one_line(tag.name, 60));
    }
  }
  if (prices_.empty()) {
    fail("{}: holds no imbalance prices, or is cut short; download it again", name_);
  }
}

MarketRows DocumentReader::rows() const {
  MarketRows rows;
  rows.sources = {MarketSource::kEntsoe};
  for (const auto& [utc_s, prices] : prices_) {
    QuarterHour quarter_hour;
    quarter_hour.utc_s = utc_s;
    quarter_hour.price_eur_per_mwh = prices.single();
    if (!is_published(quarter_hour.price_eur_per_mwh)) {
      rows.dual_priced_quarter_hours.insert(utc_s);
    }
    rows.quarter_hours.push_back(quarter_hour);
  }
  return rows;
}

}  // namespace

bool looks_like_xml(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '<';
}

MarketRows parse_entsoe_xml(std::string_view text, std::string_view name) {
  if (text.find("</Balancing_MarketDocument") == std::string_view::npos &&
      text.find(":Balancing_MarketDocument>") == std::string_view::npos &&
      text.find("<Balancing_MarketDocument") != std::string_view::npos) {
    fail("{}: the document is cut short; download it again", name);
  }
  DocumentReader reader(name);
  reader.read(text);
  return reader.rows();
}

}  // namespace bess
