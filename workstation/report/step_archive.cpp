#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <stdexcept>

#include "workstation/report/page_data.h"

namespace bess {
namespace {

static_assert(std::endian::native == std::endian::little, "the page's arrays are little-endian");

constexpr double kMilliPerEur = 1000;
constexpr int kSecondsPerMinute = 60;
/// Larger prices are refused when steps are made.
static_assert(1'000'000 * kMilliPerEur < std::numeric_limits<std::int32_t>::max());

/// One array: `value` of each item.
template <typename Number, typename Items, typename Value>
void append(std::string& bytes, const Items& items, Value value) {
  for (const auto& item : items) {
    const auto number = static_cast<Number>(std::invoke(value, item));
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
}

std::int32_t milli_of(double eur_per_mwh) {
  return static_cast<std::int32_t>(std::lround(eur_per_mwh * kMilliPerEur));
}

void append_market(std::span<const MarketStep> steps, const ClassOfStep& class_of,
                   std::string& bytes) {
  using Step = const MarketStep&;
  append<std::int32_t>(bytes, steps, [](Step s) { return s.utc_s / kSecondsPerMinute; });
  append<std::int32_t>(bytes, steps, [](Step s) { return price_centi_of(s.observed_eur_per_mwh); });
  append<std::int32_t>(bytes, steps, [](Step s) { return milli_of(s.paid_eur_per_mwh); });
  append<std::int16_t>(bytes, steps, [](Step s) {
    return s.quarter_hour * kMinutesPerQuarterHour + s.minute_of_quarter_hour;
  });
  append<std::int8_t>(bytes, steps, class_of);
}

void append_policy(std::span<const StepRecord> records, std::string& bytes) {
  using Record = const StepRecord&;
  append<float>(bytes, records, &StepRecord::profit_eur);
  append<float>(bytes, records, &StepRecord::power_w);
  append<std::int16_t>(bytes, records,
                       [](Record r) { return std::lround(r.soc_frac * kSocFullE4); });
  append<std::int8_t>(bytes, records, &StepRecord::action);
}

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(),
                Z_BEST_COMPRESSION) != Z_OK) {
    throw std::runtime_error("zlib could not compress the steps of the days");
  }
  packed.resize(size);
  return packed;
}

}  // namespace

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t b = 0; b < 3; ++b) {
      group = group << 8 | (b < count ? static_cast<std::uint8_t>(bytes[i + b]) : 0u);
    }
    for (std::size_t d = 0; d < 4; ++d) {
      text += d <= count ? kDigits[group >> (18 - 6 * d) & 63] : '=';
    }
  }
  return text;
}

Json step_archive(const MarketSteps& market, const std::vector<MarketDay>& days,
                  const std::vector<PolicySteps>& policies, const std::vector<std::size_t>& kept,
                  const ClassOfStep& class_of) {
  std::vector<std::size_t> first_record{0};  // by day
  for (const MarketDay& day : days) first_record.push_back(first_record.back() + day.step_count);
  std::string bytes;
  Json index = Json::list();
  for (const std::size_t d : kept) {
    const MarketDay& day = days[d];
    append_market(market.of(day), class_of, bytes);
    for (const PolicySteps& policy : policies) {
      append_policy({policy.records.data() + first_record[d], day.step_count}, bytes);
    }
    index.add(Json::object({{"date", day.date()}, {"steps", day.step_count}}));
  }
  return Json::object({{"policies", Json::list_from(policies, &PolicySteps::name)},
                       {"days", std::move(index)},
                       {"data", base64(deflated(bytes))}});
}

}  // namespace bess
