#include "workstation/market/feed/market_text.h"

#include "shared/host/json.h"
#include "shared/host/minute_file.h"
#include "shared/host/plain_text.h"
#include "workstation/market/feed/entsoe_xml.h"
#include "workstation/market/feed/market_json.h"
#include "workstation/market/feed/market_minutes.h"

namespace bess {

MarketRows parse_market_text(std::string_view text, std::string_view name, const OwnForm& own) {
  text = plain_text(text, name);
  if (text.find_first_not_of(" \t\r\n") == text.npos)
    fail("{}: the file is empty; download it again", name);
  if (looks_like_xml(text)) return parse_entsoe_xml(text, name);
  if (is_minute_csv(text)) return parse_minute_file_rows(text, name);
  if (is_spreadsheet_minute_csv(text)) {
    return parse_minute_file_rows(from_spreadsheet(text), name);
  }
  return looks_like_json(text) ? parse_market_json(text, name) : parse_market_csv(text, name, own);
}

}  // namespace bess
