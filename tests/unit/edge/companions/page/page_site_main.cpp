// page_site: test site for bess-page, until its input ends; prints the path of its configuration.
#include <cstdio>

#include "tests/unit/edge/companions/page/page_site.h"

int main() {
  const bess::PageSite site;
  std::printf("%s\n", site.config().c_str());
  std::fflush(stdout);
  while (std::getchar() != EOF) {
  }
  return ::testing::Test::HasFailure() ? 1 : 0;
}
