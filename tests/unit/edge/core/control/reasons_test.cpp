// The table of reasons for people is the one that the program has.
#include "edge/core/control/reasons.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace bess {
namespace {

TEST(Reasons, TheReadmeHasTheTable) {
  std::string table = "| reason | what it means | what to look at |\n|---|---|---|\n";
  bool stops = true;
  for (const ReasonInfo& reason : kReasons) {
    if (stops && reason.effect == ReasonEffect::kGoesOn) {
      table += "| *up to here the battery is not driven: 0 W, then released* | | |\n";
      stops = false;
    }
    table.append("| ").append(reason.name).append(" | ").append(reason.meaning);
    table.append(" | ").append(reason.look_at).append(" |\n");
  }
  std::ifstream file(BESS_SOURCE_DIR "/edge/README.md");
  std::ostringstream text;
  text << file.rdbuf();
  const bool is_there = text.str().find("\n\n" + table + "\n") != std::string::npos;
  EXPECT_TRUE(is_there) << "edge/README.md must have exactly this:\n" << table;
}

}  // namespace
}  // namespace bess
