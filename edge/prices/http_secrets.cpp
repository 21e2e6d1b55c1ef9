#include "edge/prices/http_secrets.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "shared/file_descriptor.h"

namespace bess {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  return text;
}

/// "Name: value" with a name of letters, digits and dashes, and no control character.
bool is_header(std::string_view line) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  for (const char c : line.substr(0, colon)) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (!is_letter && !(c >= '0' && c <= '9') && c != '-' && c != '_') return false;
  }
  for (const char c : line) {
    if (static_cast<unsigned char>(c) < ' ' || c == 127) return false;
  }
  return true;
}

/// Keeps the header lines of a file's text. False with the number of the first line that is none.
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

/// Contained in any letter case.
bool sounds_secret(std::string_view key) {
  std::string lower(key);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  for (const char* word : {"key", "token", "secret", "password", "passwd", "auth", "signature"}) {
    if (lower.find(word) != std::string::npos) return true;
  }
  return false;
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
    error = std::string(path).append(": others may read this file of secrets: chmod o-rwx it");
    return false;
  }
  char text[2048];
  const ssize_t size = read(file.get(), text, sizeof text);
  if (size < 0 || size == sizeof text) {
    error = std::string(path).append(size < 0 ? ": cannot be read: is it a file?"
                                              : ": is too long (at most 2047 bytes)");
    return false;
  }
  int line_number = 0;
  if (keep_headers({text, static_cast<std::size_t>(size)}, headers, line_number)) return true;
  error = std::string(path) + ":" + std::to_string(line_number) +
          ": is no header; write one \"Name: value\" a line";
  return false;
}

FixedText<511> loggable_url(std::string_view url) {
  std::string shown;
  const std::size_t scheme = url.find("://");
  const std::size_t authority = scheme == std::string_view::npos ? 0 : scheme + 3;
  std::size_t path = url.find_first_of("/?#", authority);
  if (path == std::string_view::npos) path = url.size();
  const std::size_t at = url.substr(0, path).rfind('@');
  const bool has_user = at != std::string_view::npos && at >= authority;
  shown.append(url.substr(0, authority));
  shown.append(url.substr(has_user ? at + 1 : authority, path - (has_user ? at + 1 : authority)));
  std::string_view rest = url.substr(path);
  while (!rest.empty()) {  // piece by piece, each with the separator in front of it
    std::size_t end = rest.find_first_of("?&;", 1);
    if (end == std::string_view::npos) end = rest.size();
    const std::string_view piece = rest.substr(0, end);
    const std::size_t equals = piece.find('=');
    const bool hidden = equals != std::string_view::npos && sounds_secret(piece.substr(0, equals));
    shown.append(hidden ? piece.substr(0, equals + 1) : piece).append(hidden ? "..." : "");
    rest.remove_prefix(end);
  }
  return FixedText<511>(shown);
}

}  // namespace bess
