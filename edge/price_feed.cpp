#include "edge/price_feed.h"

#include <cjson/cJSON.h>
#include <curl/curl.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <memory>

#include "shared/check.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::int64_t kClockToleranceS = 5;  // of the server's clock against ours

using Json = std::unique_ptr<cJSON, decltype(&cJSON_Delete)>;

std::chrono::steady_clock::time_point steady_at(std::int64_t monotonic_ns) {
  return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(monotonic_ns));
}

bool parse_row(const cJSON* item, const PriceFeedSettings& settings, std::int64_t now_utc_s,
               PriceRow& row) {
  const cJSON* time = cJSON_GetObjectItemCaseSensitive(item, settings.time_field.c_str());
  const cJSON* price = cJSON_GetObjectItemCaseSensitive(item, settings.price_field.c_str());
  if (!cJSON_IsString(time) || !cJSON_IsNumber(price)) return false;  // null: not published yet
  if (!parse_utc_text(time->valuestring, row.minute_utc_s)) return false;
  if (row.minute_utc_s % 60 != 0) return false;  // not the start of a minute
  if (row.minute_utc_s + 60 > now_utc_s + kClockToleranceS) return false;  // cannot exist yet
  const double centi = price->valuedouble * kCentiPerEur;
  if (!std::isfinite(centi) || std::fabs(centi) > kPlausiblePriceMaxCentiEurPerMwh) return false;
  row.price_centi_eur_per_mwh = static_cast<std::int32_t>(std::lround(centi));
  return true;
}

Status status_of_curl(CURLcode code) {
  switch (code) {
    case CURLE_OPERATION_TIMEDOUT:
      return Status::kTimeout;
    case CURLE_WRITE_ERROR:
      return Status::kTooLarge;
    case CURLE_COULDNT_RESOLVE_HOST:
      return Status::kNameUnresolved;
    case CURLE_SSL_CONNECT_ERROR:
    case CURLE_SSL_CACERT_BADFILE:
    case CURLE_PEER_FAILED_VERIFICATION:
      return Status::kTlsRefused;
    case CURLE_OUT_OF_MEMORY:
      return Status::kNoMemory;
    default:
      return Status::kNotConnected;
  }
}

}  // namespace

Status parse_newest_price(std::string_view json, const PriceFeedSettings& settings,
                          std::int64_t now_utc_s, PriceRow& row) {
  const Json root(cJSON_ParseWithLength(json.data(), json.size()), &cJSON_Delete);
  if (root == nullptr) return Status::kMalformed;
  const cJSON* rows = root.get();
  if (cJSON_IsObject(rows)) {
    rows = cJSON_GetObjectItemCaseSensitive(rows, settings.rows_field.c_str());
  }
  if (!cJSON_IsArray(rows)) return Status::kMalformed;
  bool found = false;
  const cJSON* item = nullptr;
  cJSON_ArrayForEach(item, rows) {
    PriceRow candidate;
    if (!parse_row(item, settings, now_utc_s, candidate)) continue;
    if (!found || candidate.minute_utc_s > row.minute_utc_s) row = candidate;
    found = true;
  }
  return found ? Status::kOk : Status::kNoRow;
}

PriceFeed::PriceFeed(const PriceFeedSettings& settings, const ScaledClock& clock)
    : settings_(settings), clock_(clock) {
  curl_global_init(CURL_GLOBAL_DEFAULT);
  CURL* curl = curl_easy_init();
  BESS_CHECK(curl != nullptr);
  curl_ = curl;
  curl_easy_setopt(curl, CURLOPT_URL, settings_.url.c_str());
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_TIMEOUT_MS, static_cast<long>(settings_.timeout_ms));
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT_MS, static_cast<long>(settings_.timeout_ms));
  curl_easy_setopt(curl, CURLOPT_HTTP_VERSION, CURL_HTTP_VERSION_1_1);
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_USERAGENT, "bess-edge");
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, &PriceFeed::on_bytes);
  curl_easy_setopt(curl, CURLOPT_WRITEDATA, this);
  if (!settings_.ca_file.empty()) {
    curl_easy_setopt(curl, CURLOPT_CAINFO, settings_.ca_file.c_str());
    curl_easy_setopt(curl, CURLOPT_CAPATH, nullptr);  // else the store is parsed at each handshake
  }
  thread_ = std::thread([this] { run(); });
}

PriceFeed::~PriceFeed() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
  curl_easy_cleanup(static_cast<CURL*>(curl_));
}

void PriceFeed::request(std::int64_t minute_utc_s, std::int64_t start_monotonic_ns,
                        std::int64_t deadline_monotonic_ns) {
  {
    const std::lock_guard lock(mutex_);
    job_ = {.minute_utc_s = minute_utc_s,
            .start_ns = start_monotonic_ns,
            .deadline_ns = deadline_monotonic_ns,
            .number = job_.number + 1};
  }
  changed_.notify_all();
}

bool PriceFeed::wait(std::int64_t until_monotonic_ns) {
  std::unique_lock lock(mutex_);
  return changed_.wait_until(lock, steady_at(until_monotonic_ns),
                             [this] { return served_number_ == job_.number; });
}

PriceReport PriceFeed::latest() {
  const std::lock_guard lock(mutex_);
  return report_;
}

void PriceFeed::run() {
  while (true) {
    Job job;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stopping_ || served_number_ != job_.number; });
      if (stopping_) return;
      job = job_;
    }
    serve(job);
    {
      const std::lock_guard lock(mutex_);
      served_number_ = job.number;
    }
    changed_.notify_all();
  }
}

void PriceFeed::serve(const Job& job) {
  const std::int64_t spacing_ns =
      clock_.wall_ns(settings_.wait_s * kNanosecondsPerSecond / settings_.requests_per_cycle);
  for (int i = 0; i < settings_.requests_per_cycle; ++i) {
    const std::int64_t start_ns = job.start_ns + i * spacing_ns;
    if ((i > 0 && start_ns >= job.deadline_ns) || !pause_until(start_ns)) return;
    const std::int64_t request_ns = clock_ns(CLOCK_MONOTONIC);
    PriceRow row;
    const Status status = fetch_once(row);
    publish(status, row, request_ns);
    if (status == Status::kOk && row.minute_utc_s >= job.minute_utc_s) return;
  }
}

/// False when the feed is being stopped.
bool PriceFeed::pause_until(std::int64_t until_ns) {
  std::unique_lock lock(mutex_);
  return !changed_.wait_until(lock, steady_at(until_ns), [this] { return stopping_; });
}

void PriceFeed::publish(Status status, const PriceRow& row, std::int64_t start_ns) {
  const std::int64_t now_ns = clock_ns(CLOCK_MONOTONIC);
  const std::lock_guard lock(mutex_);
  report_.status = status;
  if (status != Status::kOk) return;
  // An older row than the one known is a stale cache talking; an equal one may carry a correction.
  if (report_.has_row && row.minute_utc_s < report_.minute_utc_s) return;
  const bool is_new = !report_.has_row || row.minute_utc_s > report_.minute_utc_s;
  report_.has_row = true;
  report_.minute_utc_s = row.minute_utc_s;
  report_.price_centi_eur_per_mwh = row.price_centi_eur_per_mwh;
  report_.fetch_us = static_cast<std::int32_t>((now_ns - start_ns) / 1'000);
  if (is_new) report_.received_monotonic_ns = now_ns;
}

Status PriceFeed::fetch_once(PriceRow& row) {
  CURL* curl = static_cast<CURL*>(curl_);
  answer_size_ = 0;
  const CURLcode code = curl_easy_perform(curl);
  if (code != CURLE_OK) return status_of_curl(code);
  long http_code = 0;
  curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &http_code);
  if (http_code != 200) return Status::kHttpError;
  return parse_newest_price({answer_, answer_size_}, settings_,
                            clock_.now_utc_ns() / kNanosecondsPerSecond, row);
}

std::size_t PriceFeed::on_bytes(char* bytes, std::size_t size, std::size_t count, void* feed) {
  auto* self = static_cast<PriceFeed*>(feed);
  const std::size_t added = size * count;
  if (added > kAnswerBytesMax - self->answer_size_) return 0;  // aborts the transfer
  std::memcpy(self->answer_ + self->answer_size_, bytes, added);
  self->answer_size_ += added;
  return added;
}

}  // namespace bess
