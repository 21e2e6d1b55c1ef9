// What reaches bess-page from outside: a host, an origin, an order's fields, and the file of
// tokens. Lines: host, origin, fields as name=value&..., a token, then the file.
#include "edge/companion/orders.h"
#include "edge/page/access_tokens.h"
#include "edge/page/request_guard.h"
#include "shared/host/text.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

bess::OrderFields fields_of(std::string_view form) {
  bess::OrderFields fields;
  while (!form.empty()) {
    const std::size_t end = std::min(form.find('&'), form.size());
    const std::string_view pair = form.substr(0, end);
    const std::size_t is = std::min(pair.find('='), pair.size());
    fields[std::string(pair.substr(0, is))] = pair.substr(std::min(is + 1, pair.size()));
    form.remove_prefix(std::min(end + 1, form.size()));
  }
  return fields;
}

/// A word that bess-edge understands: no space, nothing for a shell, and no option but ours.
bool is_plain(std::string_view word) {
  const auto is_of = [word](std::string_view letters) {
    return word.find_first_not_of(letters) == word.npos;
  };
  if (word.starts_with("--")) return is_of("-abcdefghijklmnopqrstuvwxyz");
  return is_of("0123456789-") || (word.ends_with('m') && is_of("0123456789m")) || word == "hold" ||
         word == "limit" || word == "clear";
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bess;
  const std::string text(text_of(data, size));
  std::string_view rest = text;
  const std::string host(take_line(rest));
  const std::string origin(take_line(rest));
  const std::string_view form = take_line(rest);
  const std::string_view token = take_line(rest);

  PageSettings settings;
  settings.hosts = {"battery.example.org"};
  if (is_our_origin(origin, settings) && !origin.empty()) {
    must(origin.starts_with("http"), "an origin of ours is a page");
  }
  if (is_our_host(host, settings)) {
    must(host.starts_with("127.0.0.1") || (host[0] | 32) == 'l' || (host[0] | 32) == 'b' ||
             host[0] == '[',
         "a host of ours begins as one of its names");
  }

  const Order order = read_order(fields_of(form));
  must(order.words.empty() != order.complaint.empty(), "an order or a complaint");
  for (const std::string& word : order.words) must(is_plain(word), "words of bess-edge alone");

  AccessTokens tokens;
  std::string trouble;
  must(tokens.parse(rest, trouble) == trouble.empty(), "refused with a reason");
  must(tokens.owner_of("").empty(), "nothing is no token");
  if (!tokens.owner_of(token).empty()) {
    must(token.size() >= AccessTokens::kTokenBytesMin, "no short token");
  }
  return 0;
}
