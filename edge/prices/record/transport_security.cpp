#include "edge/prices/record/transport_security.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <string>

#include "edge/records/log/battery_name.h"
#include "shared/file_descriptor.h"

namespace bess {

namespace {

struct Place {
  std::string host;  ///< without IPv6 brackets
  std::string port;  ///< empty: the scheme's default
};

/// False if the URL has no host or a non-numeric port.
bool find_place(std::string_view url, Place& place) {
  const UrlParts parts = url_parts(url);
  const std::size_t begin = parts.authority_at + parts.login_bytes;
  std::string_view text = url.substr(begin, parts.path_at - begin);
  const bool is_ipv6 = text.starts_with('[');
  const std::size_t host_end = is_ipv6 ? text.find(']') : text.find(':');
  place.host = text.substr(is_ipv6 ? 1 : 0, host_end - (is_ipv6 ? 1 : 0));
  text.remove_prefix(std::min(host_end, text.size()) + (is_ipv6 ? 1 : 0));
  if (!text.empty()) place.port = text.substr(1);
  constexpr std::string_view kNoHost = " \t\\<>\"^`{|}%";
  return !place.host.empty() && place.host.find_first_of(kNoHost) == place.host.npos &&
         place.port.find_first_not_of("0123456789") == place.port.npos;
}

/// Numeric 127.0.0.0/8 and [::1].
bool is_loopback(const std::string& host) {
  in_addr v4{};
  in6_addr v6{};
  if (inet_aton(host.c_str(), &v4) != 0) return ntohl(v4.s_addr) >> 24 == 127;
  return inet_pton(AF_INET6, host.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

}  // namespace

std::string place_of_url(std::string_view url) {
  Place place;
  if (!find_place(url, place)) return "";
  if (place.port.empty()) place.port = url.starts_with("https://") ? "443" : "80";
  return place.host + ":" + place.port;
}

UrlTransport transport_of(std::string_view url) {
  const bool is_secure = url.starts_with("https://");
  if (!is_secure && !url.starts_with("http://")) return UrlTransport::kUnusable;
  Place place;
  if (!find_place(url, place)) return UrlTransport::kUnusable;
  if (is_secure) return UrlTransport::kSecure;
  return is_loopback(place.host) ? UrlTransport::kLoopback : UrlTransport::kOpen;
}

bool holds_login(std::string_view url) { return url_parts(url).login_bytes > 0; }

namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  return text;
}

/// "Name: value" with a name of letters, digits, - and _, and no control character.
bool is_header(std::string_view line) {
  const std::size_t name_end = line.find_first_not_of(kNameCharacters);
  const bool is_named = name_end != line.npos && name_end > 0 && line[name_end] == ':';
  return is_named && std::ranges::none_of(line, [](char c) {
           return static_cast<unsigned char>(c) < ' ' || c == 127;
         });
}

/// Stores the header lines of a file's text. False with the number of the first invalid line.
bool keep_headers(std::string_view text, FixedText<2047>& headers, int& line_number) {
  std::string kept;
  for (line_number = 1; !text.empty(); ++line_number) {
    const std::size_t end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    if (line.empty() || line.front() == '#') continue;
    if (!is_header(line)) return false;
    kept.append(kept.empty() ? "" : "\n").append(line);
  }
  return headers.assign(kept);
}

/// Parameter names of Elia's Opendatasoft, versions 1 and 2. Any other name may be secret, such as
/// code, sig, appid, apikey and token.
bool is_harmless(std::string_view name) {
  constexpr std::string_view kNames[] = {"dataset", "exclude", "format",   "group_by", "lang",
                                         "limit",   "offset",  "order_by", "refine",   "rows",
                                         "select",  "sort",    "start",    "timezone", "where"};
  return std::ranges::find(kNames, name) != std::end(kNames);
}

/// "name=value" of a query with the value hidden; all of it hidden without a name.
std::string shown_piece(std::string_view piece) {
  const std::size_t equals = std::min(piece.find('='), piece.size());
  const std::string_view name = piece.substr(0, equals);
  if (piece.empty() || is_harmless(name)) return std::string(piece);
  // Trailing = of a bare token is padding.
  const bool has_value = piece.find_first_not_of('=', equals) != std::string_view::npos;
  return has_value ? std::string(name) + "=..." : "...";
}

}  // namespace

bool load_http_headers(const char* path, FixedText<2047>& headers, std::string& error) {
  const FileDescriptor file(open(path, O_RDONLY | O_CLOEXEC));
  struct stat info {};
  if (file.get() < 0 || fstat(file.get(), &info) != 0) {
    error = std::string(path).append(": cannot open the header file: ").append(strerror(errno));
    return false;
  }
  if ((info.st_mode & S_IRWXO) != 0) {
    error = std::string(path).append(": secret, but readable by other users: chmod o-rwx it");
    return false;
  }
  char text[2048];
  const ssize_t size = read(file.get(), text, sizeof text);
  if (size < 0 || size == sizeof text) {
    error = std::string(path).append(size < 0 ? ": cannot be read (is it a file?)"
                                              : ": too long (at most 2047 bytes)");
    return false;
  }
  int line_number = 0;
  if (keep_headers({text, static_cast<std::size_t>(size)}, headers, line_number)) return true;
  error = std::string(path) + ":" + std::to_string(line_number) +
          ": not a header; write one \"Name: value\" per line";
  return false;
}

UrlParts url_parts(std::string_view url) {
  UrlParts parts;
  const std::size_t scheme = url.find("://");
  parts.authority_at = scheme == std::string_view::npos ? 0 : scheme + 3;
  parts.path_at = std::min(url.find_first_of("/?#", parts.authority_at), url.size());
  const std::size_t at =
      url.substr(parts.authority_at, parts.path_at - parts.authority_at).rfind('@');
  if (at != std::string_view::npos) parts.login_bytes = at + 1;
  return parts;
}

FixedText<511> loggable_url(std::string_view url) {
  const UrlParts parts = url_parts(url);
  const std::size_t host_at = parts.authority_at + parts.login_bytes;
  std::size_t query_at = std::min(url.find_first_of("?&;#", parts.path_at), url.size());
  std::string shown(url.substr(0, parts.authority_at));
  shown.append(url.substr(host_at, query_at - host_at));
  while (query_at < url.size()) {  // piece by piece, each after its separator
    shown.push_back(url[query_at++]);
    const std::size_t end = std::min(url.find_first_of("?&;#", query_at), url.size());
    shown.append(shown_piece(url.substr(query_at, end - query_at)));
    query_at = end;
  }
  return FixedText<511>(shown);
}

}  // namespace bess
