#include "edge/notify/connection_trouble.h"

#include <cerrno>
#include <cstring>

#include "edge/notify/curl_handle.h"
#include "shared/host/text.h"

namespace bess {
namespace {

/// OpenSSL's verdicts on a certificate (x509_vfy.h), as libcurl hands them on.
enum Verdict : long {
  kNoIssuer = 2,
  kNotYetValid = 9,
  kExpired = 10,
  kSelfSigned = 18,
  kSelfSignedInChain = 19,
  kNoLocalIssuer = 20,
  kLeafNotVerified = 21,
  kUntrusted = 27
};

std::string certificate_trouble(long verdict, const std::string& authorities) {
  switch (verdict) {
    case kNotYetValid:
      return "the server's certificate is not valid yet: is this machine's clock right "
             "(timedatectl)?";
    case kExpired:
      return "the server's certificate has expired: renew it there; or is this machine's clock "
             "wrong "
             "(timedatectl)?";
    case kNoIssuer:
    case kSelfSigned:
    case kSelfSignedInChain:
    case kNoLocalIssuer:
    case kLeafNotVerified:
    case kUntrusted:
      return "the server's certificate is of no authority that is known here: " + authorities;
    case 0:
    case 1:  // the chain was not even asked for: the name comes first
      return "the server's certificate is of another name: is it the host that is configured?";
    default:
      return "the server's certificate is refused, OpenSSL's verdict " + std::to_string(verdict) +
             " (openssl verify knows it)";
  }
}

std::string connect_trouble(CURL* curl) {
  long cause = 0;
  curl_easy_getinfo(curl, CURLINFO_OS_ERRNO, &cause);
  if (cause == ECONNREFUSED) return "connection refused: does the server run, is the port right?";
  if (cause == 0) return "no connection: is the network up, do host and port answer?";
  return std::string("no connection: ") + std::strerror(static_cast<int>(cause));
}

int stop_when_asked(void* stop, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return static_cast<const std::stop_token*>(stop)->stop_requested() ? 1 : 0;
}

/// By what libcurl had to say of it: words of OpenSSL, or of a connection that was just cut.
std::string handshake_trouble(const std::string& detail, const std::string& authorities) {
  const bool is_openssl = detail.find(" routines::") != detail.npos;
  if (!is_openssl || detail.find("wrong version number") != detail.npos) {
    return "no TLS there: is the port right, does the server speak TLS?";
  }
  return "the TLS handshake failed (" + one_line(detail, 120) +
         "): is the authority the one that signed the server's certificate? " + authorities;
}

std::string trouble_of(CURL* curl, CURLcode code, const char* detail,
                       const std::string& authorities) {
  long verdict = 0;
  switch (code) {
    case CURLE_OK:
      return "";
    case CURLE_COULDNT_RESOLVE_HOST:
      return "the host's name is not known: is it right, does the resolver answer?";
    case CURLE_COULDNT_CONNECT:
      return connect_trouble(curl);
    case CURLE_OPERATION_TIMEDOUT:
      return "no answer in time: is the host up, does a firewall swallow it?";
    case CURLE_SSL_CONNECT_ERROR:
      return handshake_trouble(detail, authorities);
    case CURLE_SSL_CACERT_BADFILE:
      return "no authority can be read: " + authorities;
    case CURLE_PEER_FAILED_VERIFICATION:
      curl_easy_getinfo(curl, CURLINFO_SSL_VERIFYRESULT, &verdict);
      return certificate_trouble(verdict, authorities);
    case CURLE_GOT_NOTHING:
    case CURLE_RECV_ERROR:
    case CURLE_SEND_ERROR:
      return "the server closed the connection without an answer";
    default:
      return curl_easy_strerror(code);
  }
}

}  // namespace

std::string perform_transfer(void* curl, const std::string& authorities,
                             const std::stop_token& stop) {
  char detail[CURL_ERROR_SIZE] = "";
  curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, detail);
  curl_easy_setopt(curl, CURLOPT_NOPROGRESS, 0L);
  curl_easy_setopt(curl, CURLOPT_XFERINFOFUNCTION, stop_when_asked);
  curl_easy_setopt(curl, CURLOPT_XFERINFODATA, const_cast<std::stop_token*>(&stop));
  const CURLcode code = curl_easy_perform(curl);
  curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, nullptr);
  return trouble_of(curl, code, detail, authorities);
}

std::string probe_connection(const Place& place, const std::string& authorities,
                             const std::stop_token& stop) {
  constexpr long kProbeMsMax = 10'000;
  const Curl curl(curl_easy_init());
  if (curl == nullptr) return "no memory";
  const bool is_ipv6 = place.host.find(':') != std::string::npos;
  const std::string host = is_ipv6 ? "[" + place.host + "]" : place.host;
  const std::string url = (place.ca_file.empty() ? "http://" : "https://") + host;
  curl_easy_setopt(curl.get(), CURLOPT_URL, url.c_str());
  curl_easy_setopt(curl.get(), CURLOPT_PORT, static_cast<long>(place.port));
  curl_easy_setopt(curl.get(), CURLOPT_CONNECT_ONLY, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_PROXY, "");
  curl_easy_setopt(curl.get(), CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_TIMEOUT_MS, kProbeMsMax);
  curl_easy_setopt(curl.get(), CURLOPT_SSL_ENABLE_ALPN, 0L);
  if (!place.ca_file.empty()) {
    curl_easy_setopt(curl.get(), CURLOPT_CAINFO, place.ca_file.c_str());
    curl_easy_setopt(curl.get(), CURLOPT_CAPATH, nullptr);
  }
  return perform_transfer(curl.get(), authorities, stop);
}

}  // namespace bess
