// `bess-edge history`: which versions and weights this machine has run, and what became of them.
#include <algorithm>
#include <cstdio>

#include "edge/commands/command_list.h"
#include "edge/log/journal.h"
#include "edge/update/trial_state.h"
#include "shared/host/json.h"

namespace bess {
namespace {

struct HistoryGiven {
  bool json = false;
  std::string folder = kUpdateFolder;
};

using O = OptionsOf<HistoryGiven>;
constexpr CommandOption kOptions[] = {
    O::flag<&HistoryGiven::json>("--json"),
    O::text<&HistoryGiven::folder>("--folder"),
};

constexpr const char* kHelp =
    R"(bess-edge history: which versions and weights this machine has run, and what became of them

  bess-edge history [--json] [--folder FOLDER] [--config FILE]

  --json           a list of objects: utc, event, version, student, header_sha256, reason
  --folder FOLDER  where it is kept; default /var/lib/bess-update
  --config FILE    as every command has it; the history is the machine's, and needs none

Events: trying (on trial), confirmed, comparing (the version before runs: does it do better?),
going_back and rolled_back (with the reason), refused (not let in), failed (nothing to go back
to), broken_off (the power went while dpkg was at it), withdrawn (dpkg gave it up), dismissed,
allowed. The column "certificate" is the beginning of header_sha256, of the exported header.
Exit codes: 0 done   1 no history   2 the command line is bad

  bess-edge history
  bess-edge history --json | jq '.[-1].event'
)";

void print_json(const std::vector<UpdateEvent>& events) {
  Json list = Json::list();
  for (const UpdateEvent& e : events) {
    list.add(Json::object({{"utc", e.utc},
                           {"event", e.event},
                           {"version", e.version},
                           {"student", e.student},
                           {"header_sha256", e.header_sha256},
                           {"reason", e.reason}}));
  }
  std::fputs(list.text().c_str(), stdout);
}

void print_table(const std::vector<UpdateEvent>& events) {
  std::size_t widest = std::string("version").size();
  for (const UpdateEvent& e : events) widest = std::max(widest, e.version.size());
  const int width = static_cast<int>(widest);
  std::printf("%-20s  %-11s  %-*s  %-8s  %-16s  %s\n", "utc", "event", width, "version", "student",
              "certificate", "reason");
  for (const UpdateEvent& e : events) {
    std::printf("%-20s  %-11s  %-*s  %-8s  %-16.16s  %s\n", e.utc.c_str(), e.event.c_str(), width,
                e.version.c_str(), e.student.c_str(), e.header_sha256.c_str(), e.reason.c_str());
  }
}

int run_history(const HistoryGiven& given, SettingsFile&) {
  const std::string& folder = given.folder;
  const UpdateHistory history = read_update_history(folder);
  if (!history.trouble.empty()) return failed(history.trouble);
  if (history.damaged_lines > 0) {
    report(JournalLevel::kWarning, "%s/history: %d damaged lines are left out", folder.c_str(),
           history.damaged_lines);
  }
  if (given.json) {
    print_json(history.events);
  } else {
    print_table(history.events);
  }
  return 0;
}

}  // namespace

const EdgeCommand kHistoryCommand = {.name = "history",
                                     .usage = "history",
                                     .does = "versions that this machine has run",
                                     .help = kHelp,
                                     .options = kOptions,
                                     .settings = EdgeCommand::Settings::kIfAsked,
                                     .run = run_with<HistoryGiven, run_history>};

}  // namespace bess
