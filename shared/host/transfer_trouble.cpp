#include "shared/host/transfer_trouble.h"

#include <curl/curl.h>

#include <cerrno>
#include <cstring>

#include "shared/host/text.h"

namespace bess {
namespace {

using Kind = HttpOutcome::Kind;

constexpr std::size_t kDetailMax = 200;  // of a library's own words in a message

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

bool has(const std::string& text, const char* part) { return text.find(part) != text.npos; }

std::string certificate_trouble(CURL* curl, const std::string& authorities) {
  long verdict = 0;
  curl_easy_getinfo(curl, CURLINFO_SSL_VERIFYRESULT, &verdict);
  switch (verdict) {
    case kNotYetValid:
      return "the server's certificate is not valid yet: is this computer's clock right "
             "(timedatectl)?";
    case kExpired:
      return "the server's certificate has expired: renew it there; or is this computer's clock "
             "wrong (timedatectl)?";
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

TransferTrouble handshake_trouble(const std::string& detail, const std::string& authorities) {
  if (has(detail, "wrong version number") || has(detail, "packet length too long")) {
    return {Kind::kRefused, "no TLS there: is the port right, does the server speak TLS?"};
  }
  if (has(detail, "alert")) {
    return {Kind::kRefused,
            "the server refused the TLS handshake: it knows no common version or cipher"};
  }
  if (has(detail, " routines::")) {
    return {Kind::kRefused,
            "the TLS handshake failed (" + one_line(detail, kDetailMax) +
                "): is the authority the one that signed the server's certificate? " + authorities};
  }
  return {Kind::kUnreachable,
          "the server closed the connection in the TLS handshake: is there no TLS there, is the "
          "port right?"};
}

}  // namespace

TransferTrouble transfer_trouble(void* curl, int code, const std::string& detail,
                                 const std::string& authorities) {
  const std::string words = one_line(
      detail.empty() ? curl_easy_strerror(static_cast<CURLcode>(code)) : detail, kDetailMax);
  switch (code) {
    case CURLE_COULDNT_RESOLVE_HOST:
    case CURLE_COULDNT_RESOLVE_PROXY:
      return {Kind::kUnreachable,
              "the host's name is not known: is it right, does the resolver answer?"};
    case CURLE_COULDNT_CONNECT:
      return {Kind::kUnreachable, connect_trouble(curl)};
    case CURLE_SSL_CONNECT_ERROR:
      return handshake_trouble(detail, authorities);
    case CURLE_PEER_FAILED_VERIFICATION:
      return {Kind::kRefused, certificate_trouble(curl, authorities)};
    case CURLE_SSL_CACERT_BADFILE:
      return {Kind::kRefused, "the certificates of authorities cannot be read: " + authorities};
    case CURLE_GOT_NOTHING:  // as servers of TLS do that are asked without
      return {
          Kind::kTransient,
          "the server closed the connection without an answer: are port and http:// or https:// "
          "right?"};
    case CURLE_OPERATION_TIMEDOUT:
      return {Kind::kTransient, "no answer in time: is the host up, does a firewall swallow it?"};
    case CURLE_PARTIAL_FILE:
    case CURLE_RECV_ERROR:
    case CURLE_SEND_ERROR:
    case CURLE_HTTP2:
    case CURLE_HTTP2_STREAM:
    case CURLE_BAD_CONTENT_ENCODING:
      return {Kind::kTransient, words};
    case CURLE_ABORTED_BY_CALLBACK:
      return {Kind::kInterrupted, words};
    case CURLE_UNSUPPORTED_PROTOCOL:
      if (has(detail, "HTTP/0.9")) {
        return {Kind::kRefused, "the answer is no HTTP: is it https:// instead of http://?"};
      }
      return {Kind::kRefused, words};
    default:
      return {Kind::kRefused, words};
  }
}

}  // namespace bess
