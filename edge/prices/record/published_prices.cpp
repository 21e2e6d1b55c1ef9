#include "edge/prices/record/published_prices.h"

#include <cstring>
#include <type_traits>

#include "shared/crc32.h"

namespace bess {
namespace {

static_assert(std::is_trivially_copyable_v<PublishedPrices>);
static_assert(std::is_trivially_copyable_v<PublishedOutlook>);

bool is_status(Status status) { return static_cast<int>(status) < kStatusCount; }

template <typename Part>
std::size_t put(const Part& part, std::span<char> at) {
  std::memcpy(at.data(), &part, sizeof part);
  const std::uint32_t sum = crc32_of(at.data(), sizeof part);
  std::memcpy(at.data() + sizeof part, &sum, sizeof sum);
  return sizeof part + sizeof sum;
}

template <typename Part>
bool take(std::span<const char> at, Part& part) {
  std::uint32_t sum = 0;
  if (at.size() < sizeof part + sizeof sum) return false;
  std::memcpy(&sum, at.data() + sizeof part, sizeof sum);
  if (sum != crc32_of(at.data(), sizeof part)) return false;
  std::memcpy(&part, at.data(), sizeof part);
  return true;
}

}  // namespace

std::size_t encode_published(const PublishedPrices& prices, const PublishedOutlook* outlook,
                             std::span<char> file) {
  const std::size_t size = put(prices, file);
  return outlook == nullptr ? size : size + put(*outlook, file.subspan(size));
}

Status decode_published(std::span<const char> file, PublishedPrices& prices) {
  std::uint32_t format = 0;
  if (file.size() < sizeof format) return Status::kMalformed;
  std::memcpy(&format, file.data(), sizeof format);
  if (format != PublishedPrices::kFormat) return Status::kOtherVersion;
  PublishedPrices found;
  if (!take(file, found) || !is_status(found.status) || !is_status(found.history.status)) {
    return Status::kMalformed;
  }
  prices = found;
  return Status::kOk;
}

Status decode_outlook(std::span<const char> file, PublishedOutlook& outlook) {
  if (file.size() < kPublishedPricesBytes || !take(file.subspan(kPublishedPricesBytes), outlook)) {
    return Status::kMalformed;
  }
  const OutlookPlanRows& plan_rows = outlook.plan_rows;
  const bool is_sound = is_status(plan_rows.feed) && plan_rows.ticks >= 0 &&
                        plan_rows.ticks <= OutlookPlanRows::kTicks && plan_rows.levels >= 0 &&
                        plan_rows.levels <= OutlookPlanRows::kLevels;
  return is_sound ? Status::kOk : Status::kMalformed;
}

}  // namespace bess
