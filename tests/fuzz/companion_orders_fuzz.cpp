// Fields of an order from outside, as name=value&...: words of bess-edge alone come of them.
#include "edge/companion/orders.h"
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
  const Order order = read_order(fields_of(text));
  must(order.words.empty() != order.complaint.empty(), "an order or a complaint");
  for (const std::string& word : order.words) must(is_plain(word), "words of bess-edge alone");
  return 0;
}
