// A line of what a page says about where it comes from.
#pragma once

#include <string>

namespace bess {

struct Fact {
  std::string name;
  std::string value;
};

}  // namespace bess
