// Published price file: fixed size, two checked parts, replaced atomically. Written by bess-prices,
// read by bess-edge. Another format or a damaged file counts as no prices.
#pragma once

#include <cstdint>
#include <span>

#include "edge/core/base/status.h"
#include "edge/core/control/outlook.h"
#include "edge/prices/record/price_row.h"
#include "shared/price_level.h"

namespace bess {

inline constexpr const char* kPricesFileName = "prices";

/// Price level of the last hours, for a first start.
struct PublishedHistory {
  bool is_done = false;  ///< false: still being fetched, or not needed
  std::int32_t hours = 0;
  std::int32_t rows = 0;
  Status status = Status::kOk;  ///< status at the end of the fetch
  PriceLevel level{};
};

struct PublishedPrices {
  static constexpr std::uint32_t kFormat = 2;

  std::uint32_t format = kFormat;
  std::int64_t written_monotonic_ns = 0;
  std::int64_t answers = 0;        ///< requests completed so far
  Status status = Status::kNoRow;  ///< of the last of them
  PriceRow row{};  ///< newest usable one of the last good answer; minute 0: none yet
  std::int64_t received_monotonic_ns = 0;  ///< of that answer
  std::int32_t fetch_us = 0;
  std::uint32_t model_hash = 0;  ///< outlook model of bess-prices' student; 0: none
  /// Newest minute whose row was received, or is no longer requested.
  std::int64_t served_minute_utc_s = 0;
  PublishedHistory history{};
  std::int64_t outlook_number = 0;  ///< of the second part; 0: none
};

inline constexpr std::size_t kPublishedPricesBytes =
    sizeof(PublishedPrices) + sizeof(std::uint32_t);
inline constexpr std::size_t kPublishedBytesMax =
    kPublishedPricesBytes + sizeof(PublishedOutlook) + sizeof(std::uint32_t);

/// Returns the bytes used of `file`, which holds at least kPublishedBytesMax; `outlook` may be
/// null.
std::size_t encode_published(const PublishedPrices& prices, const PublishedOutlook* outlook,
                             std::span<char> file);
/// kMalformed: damaged, or values out of range; kOtherVersion: another format.
Status decode_published(std::span<const char> file, PublishedPrices& prices);
/// The second part of a file that has one.
Status decode_outlook(std::span<const char> file, PublishedOutlook& outlook);

}  // namespace bess
