#include "workstation/market/feed/transfer_trouble.h"

#include <curl/curl.h>

#include "shared/host/text.h"

namespace bess {
namespace {

using Kind = HttpOutcome::Kind;

constexpr std::size_t kDetailMax = 200;  // of a library's own words in a message

bool has(const std::string& text, const char* part) { return text.find(part) != text.npos; }

std::string certificate_trouble(const std::string& detail) {
  if (has(detail, "subject name")) {
    return "the server's certificate is of another name than the address has";
  }
  if (has(detail, "not yet valid")) {
    return "the server's certificate is not valid yet: is this computer's clock right?";
  }
  if (has(detail, "has expired")) {
    return "the server's certificate has expired: is this computer's clock right?";
  }
  if (has(detail, "self-signed") || has(detail, "self signed") || has(detail, "unable to ")) {
    return "the server's certificate is of no authority that is known here (SSL_CERT_FILE may name "
           "a "
           "file of others)";
  }
  return "the server's certificate is refused: " + one_line(detail, kDetailMax);
}

TransferTrouble handshake_trouble(const std::string& detail) {
  if (has(detail, "wrong version number") || has(detail, "packet length too long")) {
    return {Kind::kRefused, "no TLS there: is it http:// instead of https://, is the port right?"};
  }
  if (has(detail, "alert")) {
    return {Kind::kRefused,
            "the server refused the TLS handshake: it knows no common version or cipher"};
  }
  return {Kind::kUnreachable, "the server closed the connection in the TLS handshake"};
}

}  // namespace

TransferTrouble transfer_trouble(int code, const std::string& detail) {
  const std::string words = one_line(
      detail.empty() ? curl_easy_strerror(static_cast<CURLcode>(code)) : detail, kDetailMax);
  switch (code) {
    case CURLE_COULDNT_RESOLVE_HOST:
    case CURLE_COULDNT_RESOLVE_PROXY:
    case CURLE_COULDNT_CONNECT:
      return {Kind::kUnreachable, words};
    case CURLE_SSL_CONNECT_ERROR:
      return handshake_trouble(detail);
    case CURLE_PEER_FAILED_VERIFICATION:
      return {Kind::kRefused, certificate_trouble(detail)};
    case CURLE_SSL_CACERT_BADFILE:
      return {Kind::kRefused,
              "the certificates of authorities cannot be read: is SSL_CERT_FILE right?"};
    case CURLE_GOT_NOTHING:  // as servers of TLS do that are asked without
      return {
          Kind::kTransient,
          "the server closed the connection without an answer: are port and http:// or https:// "
          "right?"};
    case CURLE_OPERATION_TIMEDOUT:
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
