#include "edge/settings/state_config.h"

#include <string>

#include "edge/log/installed_folders.h"

namespace bess {
namespace {

template <int kCapacity>
void keep_path(TomlTable& table, std::string_view key, const std::string& path,
               FixedText<kCapacity>& kept) {
  if (!kept.assign(path)) table.fail(key, "is too long");
}

void keep_run_paths(TomlTable& table, const std::string& path, KeptFiles kept) {
  keep_path(table, "run_folder", path, kept.state.run_folder);
  keep_path(table, "run_folder", path + "/decisions.ring", kept.log.run_ring);
  keep_path(table, "run_folder", path + "/status.json", kept.log.run_status);
  keep_path(table, "run_folder", path + "/metrics.prom", kept.log.run_metrics);
}

}  // namespace

void read_state(TomlTable table, KeptFiles kept) {
  FixedText<255> folder("state");
  table.text("folder", folder);
  if (folder.empty()) table.fail("folder", "must not be empty");
  const std::string path = table.resolved(folder.view());
  // As the service has it; elsewhere nobody says which folder is in memory.
  FixedText<255> run_folder(kInstalledEdge.run_beside(path));
  table.text("run_folder", run_folder);
  table.finish();
  if (!run_folder.empty()) keep_run_paths(table, table.resolved(run_folder.view()), kept);
  keep_path(table, "folder", path, kept.state.folder);
  keep_path(table, "folder", path + "/decisions.ring", kept.log.ring);
  keep_path(table, "folder", path + "/status.json", kept.log.status);
  keep_path(table, "folder", path + "/metrics.prom", kept.log.metrics);
}

void read_log(TomlTable table, EventLogSettings& log) {
  FixedText<255> csv;
  table.text("csv", csv);
  table.integer("days", log.ring_days, 1, 3'660);
  table.finish();
  if (!csv.empty()) keep_path(table, "csv", table.resolved(csv.view()), log.csv);
}

void read_metrics(TomlTable table, EventLogSettings& log) {
  FixedText<255> prometheus;
  table.text("prometheus", prometheus);
  table.finish();
  if (!prometheus.empty()) {
    keep_path(table, "prometheus", table.resolved(prometheus.view()), log.metrics);
  }
}

}  // namespace bess
