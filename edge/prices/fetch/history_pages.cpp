#include "edge/prices/fetch/history_pages.h"

namespace bess {

bool HistoryPages::goes_on(Status status, int items, std::int64_t oldest_before_utc_s) {
  const bool has_row = status != Status::kNoRow;
  status_ = has_row ? status : Status::kOk;
  offset_ += items;
  const bool is_older = oldest_utc_s_ < oldest_before_utc_s;  // else the server has no pages
  return status_ == Status::kOk && items > 0 && (is_older || !has_row) && !has_all_hours() &&
         offset_ + kRowsPerPage <= kRowsMax;
}

void HistoryPages::take(const PriceRow& row) {
  history_.add(row.minute_utc_s, row.price_centi_eur_per_mwh);
  oldest_utc_s_ = std::min(oldest_utc_s_, row.minute_utc_s);
}

std::string page_url(std::string_view url, int offset) {
  url = url.substr(0, url.find('#'));
  const std::size_t query_at = url.find('?');
  std::string page(url.substr(0, query_at));
  const char* separator = "?";
  std::string_view rest = query_at == std::string_view::npos ? "" : url.substr(query_at + 1);
  while (!rest.empty()) {
    const std::size_t end = rest.find('&');
    const std::string_view key = rest.substr(0, end);
    rest = end == std::string_view::npos ? "" : rest.substr(end + 1);
    if (key.starts_with("limit=") || key.starts_with("offset=")) continue;
    page.append(separator).append(key);
    separator = "&";
  }
  return page + separator + "limit=" + std::to_string(HistoryPages::kRowsPerPage) +
         "&offset=" + std::to_string(offset);
}

}  // namespace bess
