// History pages: rows of the last days from the price server, before the loop starts, for the price
// level of a first start. Pages as in Opendatasoft v2.1 (limit, offset), newest rows first, so that
// rows received before a failure or the deadline have the largest weight.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "edge/app/settings/price_config.h"
#include "edge/prices/fetch/price_json.h"
#include "edge/prices/record/published_prices.h"
#include "shared/scaled_clock.h"

namespace bess {

/// `url` with a limit of 100 rows and an offset, replacing its own.
std::string page_url(std::string_view url, int offset);

using PageFetch = std::function<PriceAnswer(const char* url, std::int32_t timeout_ms)>;

/// Price level of the hours before now, within kHistoryWait_s. Status other than kOk: ended early;
/// rows received so far count. Runs on the caller's thread.
PublishedHistory fetch_history(const PriceConfig& price, const ScaledClock& clock,
                               const PageFetch& fetch_page,
                               const std::function<bool()>& stop_requested);

}  // namespace bess
