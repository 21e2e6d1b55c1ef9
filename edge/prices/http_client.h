// One GET at a time of one URL, bounded in time, bytes and redirects. The only edge file pair that
// knows libcurl's transfers; below price_feed. Everything that it needs for its life is loaded by
// its constructor, before the seal; later it draws from the static arena.
//   names       looked up here (host_addresses), never by libcurl
//   TLS         one file of trusted certificates, kept parsed for a day
//   redirects   at most 3, to https only; headers with secrets never leave the configured host
//   proxies     none, whatever the environment says
#pragma once

#include <cstdint>
#include <string_view>

#include "edge/base/status.h"
#include "edge/prices/host_addresses.h"
#include "shared/fixed_text.h"

namespace bess {

struct HttpSettings {
  FixedText<511> url;
  FixedText<255> ca_file = "/etc/ssl/certs/ca-certificates.crt";
  FixedText<2047> headers;             ///< lines of the header file; secret
  std::int32_t timeout_ms = 5'000;     ///< of one request with its redirects, wall time
  std::int32_t resolve_every_s = 600;  ///< at the latest; sooner when nobody answers
};

class HttpClient {
 public:
  static constexpr std::size_t kAnswerBytesMax = 64 * 1024;  // 100 rows of ods161 are 27 kB
  static constexpr std::size_t kHeaderBytesMax = 32 * 1024;
  static constexpr int kRedirectsMax = 3;

  explicit HttpClient(const HttpSettings& settings);
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;
  ~HttpClient();

  /// kOk: `body` is the whole answer of a 200, until the next call.
  Status get(std::string_view& body);
  /// The same of another URL of that host (kMalformed: of another one), within at most
  /// `timeout_ms`.
  Status get(const char* url, std::int32_t timeout_ms, std::string_view& body);

 private:
  static std::size_t on_body(char* bytes, std::size_t size, std::size_t count, void* client);
  static std::size_t on_header(char* bytes, std::size_t size, std::size_t count, void* client);

  void set_options();
  void set_headers();
  Status fetch(const char* url, std::int64_t deadline_ns, std::string_view& body);
  Status perform(const char* url, HostAddresses& host, bool with_headers, std::int64_t deadline_ns);
  /// kOk with the target when the answer was a redirect that may be followed.
  Status take_redirect(FixedText<1023>& target);

  HttpSettings settings_;
  HostAddresses origin_;
  void* curl_ = nullptr;
  void* headers_ = nullptr;  ///< curl_slist
  std::size_t header_size_ = 0;
  std::size_t answer_size_ = 0;
  char answer_[kAnswerBytesMax];
};

}  // namespace bess
