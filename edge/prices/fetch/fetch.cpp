#include "edge/prices/fetch/fetch.h"

#include <curl/curl.h>

#include <algorithm>
#include <string_view>

#include "shared/host/text.h"

namespace bess {
namespace {

Status status_of(const HttpOutcome& outcome) {
  if (outcome.kind == HttpOutcome::Kind::kDone) return Status::kOk;
  if (outcome.kind == HttpOutcome::Kind::kBusy) return Status::kServerBusy;
  if (outcome.status == 200) return Status::kNotConnected;  // truncated
  if (outcome.status != 0) return Status::kHttpError;
  switch (outcome.transfer_code) {
    case CURLE_COULDNT_RESOLVE_HOST:
    case CURLE_COULDNT_RESOLVE_PROXY:
      return Status::kNameUnresolved;
    case CURLE_OPERATION_TIMEDOUT:
      return Status::kTimeout;
    case CURLE_SSL_CONNECT_ERROR:
    case CURLE_SSL_CACERT_BADFILE:
    case CURLE_PEER_FAILED_VERIFICATION:
      return Status::kTlsRefused;
    case CURLE_WRITE_ERROR:
    case CURLE_OUT_OF_MEMORY:
      return Status::kTooLarge;
    case CURLE_UNSUPPORTED_PROTOCOL:
    case CURLE_URL_MALFORMAT:
      return Status::kHttpError;
    default:
      return Status::kNotConnected;
  }
}

}  // namespace

FetchResult fetch(const HttpSettings& settings, const std::string& url, std::int32_t timeout_ms,
                  const StopRequested& stop_requested, std::size_t bytes_max) {
  HttpRequest request{.url = url,
                      .limits = {.deadline_s = std::min(timeout_ms, settings.timeout_ms) / 1'000.0,
                                 .bytes_max = bytes_max},
                      .user_agent = "bess-prices",
                      .ca_file = settings.ca_file.c_str(),
                      .authorities = "install ca-certificates, or set ca_file"};
  std::string_view lines = settings.headers.view();
  while (!lines.empty()) request.headers.emplace_back(take_line(lines));
  HttpOutcome outcome = http_request(request, stop_requested);
  const Status status = status_of(outcome);
  const bool may_be_the_key = outcome.status / 100 == 4 || outcome.status == 0;
  if (status == Status::kHttpError && may_be_the_key) {
    outcome.reason += " (check url and the key in header_file)";
  }
  return {.status = status,
          .body = std::move(outcome.body),
          .reason = std::move(outcome.reason),
          .wait_s = outcome.wait_s.value_or(0)};
}

}  // namespace bess
