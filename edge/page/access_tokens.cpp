#include "edge/page/access_tokens.h"

#include "shared/host/text.h"

namespace bess {
namespace {

bool is_graphic(std::string_view word) {
  for (const char c : word) {
    if (c <= ' ' || c > '~') return false;
  }
  return !word.empty();
}

/// Every byte is looked at, whichever differs first.
bool equals_in_constant_time(std::string_view given, std::string_view token) {
  unsigned difference = given.size() == token.size() ? 0 : 1;
  for (std::size_t i = 0; i < token.size(); ++i) {
    const char other = i < given.size() ? given[i] : '\0';
    difference |= static_cast<unsigned char>(token[i] ^ other);
  }
  return difference == 0;
}

}  // namespace

bool AccessTokens::parse(std::string_view text, std::string& trouble) {
  people_.clear();
  for (int number = 1; !text.empty(); ++number) {
    const std::string line = one_line(take_line(text));
    const std::size_t name_at = line.find_first_not_of(' ');
    if (name_at == line.npos || line[name_at] == '#') continue;
    const std::size_t name_end = std::min(line.find(' ', name_at), line.size());
    const std::size_t token_at = std::min(line.find_first_not_of(' ', name_end), line.size());
    const std::size_t token_end = line.find_last_not_of(' ') + 1;
    Person person{.name = line.substr(name_at, name_end - name_at),
                  .token = line.substr(token_at, token_end - std::min(token_at, token_end))};
    const bool is_well = is_graphic(person.name) && is_graphic(person.token) &&
                         person.token.size() >= kTokenBytesMin;
    if (!is_well) {
      trouble = "line " + std::to_string(number) + " must be a name and a token of at least " +
                std::to_string(kTokenBytesMin) +
                " characters, such as `openssl rand -hex 16` makes";
      return false;
    }
    people_.push_back(std::move(person));
  }
  if (people_.empty()) trouble = "holds no line \"NAME TOKEN\"";
  return !people_.empty();
}

std::string_view AccessTokens::owner_of(std::string_view token) const {
  std::string_view owner;
  for (const Person& person : people_) {
    if (equals_in_constant_time(token, person.token)) owner = person.name;
  }
  return owner;
}

}  // namespace bess
