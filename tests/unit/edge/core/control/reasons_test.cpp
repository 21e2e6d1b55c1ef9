// Documented table of reasons equals the program's.
#include "edge/core/control/reasons.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

/// The manual's tables of reasons, in two parts, row by row those of the program.
TEST(Reasons, TheManualHasTheTable) {
  const std::string text = text_of_file(BESS_SOURCE_DIR "/shared/manual/guides/troubleshooting.md");
  for (const ReasonEffect effect : {ReasonEffect::kRests, ReasonEffect::kGoesOn}) {
    std::string table = "|code|meaning|remedy|\n|---|---|---|\n";
    for (const ReasonInfo& reason : kReasons) {
      const bool drives = reason.effect == ReasonEffect::kGoesOn;
      if (drives != (effect == ReasonEffect::kGoesOn)) continue;
      table.append("|`").append(reason.name).append("`|").append(reason.meaning);
      table.append("|").append(reason.look_at).append("|\n");
    }
    const bool is_there = text.find("\n\n" + table + "\n") != std::string::npos;
    EXPECT_TRUE(is_there) << "troubleshooting.md must have exactly this:\n" << table;
  }
}

}  // namespace
}  // namespace bess
