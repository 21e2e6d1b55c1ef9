// Who may order by the page: one "NAME TOKEN" a line, in a file that others cannot read.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace bess {

class AccessTokens {
 public:
  static constexpr std::size_t kTokenBytesMin = 16;

  /// `text` of a file; false with what is wrong, which never quotes a token.
  bool parse(std::string_view text, std::string& trouble);

  [[nodiscard]] bool is_empty() const { return people_.empty(); }
  /// Whose token it is; empty: nobody's. Takes as long for a wrong one as for a right one.
  [[nodiscard]] std::string_view owner_of(std::string_view token) const;

 private:
  struct Person {
    std::string name;
    std::string token;
  };
  std::vector<Person> people_;
};

}  // namespace bess
