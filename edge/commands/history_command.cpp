#include "edge/commands/history_command.h"

#include <algorithm>
#include <cstdio>

#include "edge/log/journal.h"
#include "edge/storage/update_state.h"
#include "shared/host/json.h"

namespace bess {
namespace {

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

}  // namespace

int run_history_command(const CommandLine& command_line) {
  const std::string& folder = command_line.update_folder;
  const std::vector<UpdateEvent> events = read_update_history(folder);
  if (events.empty()) {
    report(JournalLevel::kError,
           "%s: no history here: it is kept where bess-edge was installed as a package",
           folder.c_str());
    return 1;
  }
  if (command_line.json) {
    print_json(events);
  } else {
    print_table(events);
  }
  return 0;
}

}  // namespace bess
