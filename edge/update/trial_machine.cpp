#include "edge/update/trial_machine.h"

#include <unistd.h>

#include <charconv>
#include <filesystem>

#include "edge/log/whole_file.h"
#include "edge/update/texts.h"
#include "shared/host/run_program.h"
#include "shared/host/text.h"

namespace bess {
namespace {

constexpr const char* kUnit = "bess-edge.service";
constexpr std::int64_t kSystemctlS = 30;
constexpr std::int64_t kStopS = 150;  ///< the unit has 120 s to give the battery back
constexpr std::string_view kUnitMark =
    "# Of the version that runs, by bess-edge trial: dpkg has delivered another one.\n";

/// "key = 15  # words": a whole number above 0.
void take_setting(std::string_view text, std::string_view key, std::int64_t& value) {
  while (!text.empty()) {
    std::string_view line = take_line(text);
    line = line.substr(std::min(line.find_first_not_of(' '), line.size()));
    if (!line.starts_with(key)) continue;
    line.remove_prefix(key.size());
    line = line.substr(std::min(line.find_first_not_of(' '), line.size()));
    if (!line.starts_with('=')) continue;
    line.remove_prefix(1);
    line = line.substr(std::min(line.find_first_not_of(' '), line.size()));
    std::int64_t found = 0;
    std::from_chars(line.data(), line.data() + line.size(), found);
    if (found > 0) value = found;
  }
}

ProgramResult systemctl(std::vector<std::string> words, std::int64_t timeout_s = kSystemctlS) {
  words.insert(words.begin(), "systemctl");
  return run_and_hear(std::move(words), timeout_s);
}

std::string value_of(std::string_view text, std::string_view key) {
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    if (line.starts_with(key) && line.substr(key.size()).starts_with('=')) {
      return std::string(line.substr(key.size() + 1));
    }
  }
  return "";
}

}  // namespace

TrialLimits TrialMachine::limits() const {
  TrialLimits limits;
  const std::string text = text_of(path("/etc/bess/update.conf"));
  take_setting(text, "good_cycles", limits.good_cycles);
  take_setting(text, "deadline_s", limits.deadline_s);
  take_setting(text, "poll_s", limits.poll_s);
  take_setting(text, "first_cycle_s", limits.first_cycle_s);
  take_setting(text, "upgrade_s", limits.upgrade_s);
  return limits;
}

std::string TrialMachine::delivered() {
  const ProgramResult run =
      run_and_hear({"dpkg-query", "-W", "-f", "${db:Status-Abbrev}${Version}", "bess-edge"}, 30);
  return run.is_well() ? one_line(run.output) : "";
}

TrialUnit TrialMachine::unit() const {
  const ProgramResult run = systemctl({"show", "-p", "ActiveState", "-p", "NRestarts", kUnit});
  TrialUnit unit;
  const std::string active = value_of(run.output, "ActiveState");
  unit.is_stopped = active == "inactive";
  unit.has_failed = active == "failed";
  const std::string restarts = value_of(run.output, "NRestarts");
  std::from_chars(restarts.data(), restarts.data() + restarts.size(), unit.restarts);
  return unit;
}

std::string TrialMachine::last_error(std::int64_t since_utc_s) {
  const ProgramResult run =
      run_and_hear({"journalctl", "_SYSTEMD_UNIT=bess-edge.service", "-p", "err", "-n", "1", "-o",
                    "cat", "--no-pager", "--since", "@" + std::to_string(since_utc_s)},
                   20);
  return run.is_well() ? one_line(run.output, 200) : "";
}

std::string TrialMachine::boot_id() { return one_line(text_of("/proc/sys/kernel/random/boot_id")); }

std::string TrialMachine::process_version() const {
  const std::string pid = value_of(systemctl({"show", "-p", "MainPID", kUnit}).output, "MainPID");
  std::error_code none;
  const std::string program =
      std::filesystem::read_symlink(path("/proc/" + pid + "/exe"), none).string();
  const std::string versions = store_.folder() + "/versions/";
  if (!program.starts_with(versions)) return "";
  return program.substr(versions.size(), program.find('/', versions.size()) - versions.size());
}

bool TrialMachine::settle(const TrialState& state, std::string& error) const {
  const std::string running = running_version(state);
  const std::string judging = judging_version(state);
  const auto point = [&](std::string_view link, const std::string& version) {
    if (version.empty() || store_.pointed(link) == version) return true;
    return store_.point(link, version, error) ||
           (store_.use_reserve() && store_.point(link, version, error));
  };
  if (!point("current", running) || !point("confirmed", judging)) return false;
  if (!running.empty()) settle_unit_file(running);
  return true;
}

void TrialMachine::settle_unit_file(const std::string& version) const {
  const std::string wanted = text_of(store_.folder_of(version) + "/systemd/bess-edge.service");
  const std::string delivered = text_of(path("/usr/lib/systemd/system/bess-edge.service"));
  const std::string place = path("/etc/systemd/system/bess-edge.service");
  const std::string found = text_of(place);
  const bool is_ours = found.starts_with(kUnitMark);
  if (!found.empty() && !is_ours) return;  // a person's own
  const bool is_needed = !wanted.empty() && wanted != delivered;
  const std::string text = is_needed ? std::string(kUnitMark) + wanted : std::string();
  if (text == found) return;
  const bool is_done =
      is_needed ? replace_file_durably(place.c_str(), text) : unlink(place.c_str()) == 0;
  if (is_done && has_systemd()) systemctl({"daemon-reload"});
}

bool TrialMachine::has_systemd() const {
  return access(path("/run/systemd/system").c_str(), F_OK) == 0;
}

bool TrialMachine::hand_over(bool keeps_order) const {
  if (!has_systemd()) return true;  // a root that is being made, not a machine that runs
  systemctl({"try-restart", "--no-block", "bess-notify.service"});
  const bool is_active = systemctl({"is-active", "--quiet", kUnit}).is_well();
  if (is_active && keeps_order) return systemctl({"reload", kUnit}).is_well();
  if (is_active) return systemctl({"restart", "--no-block", kUnit}).is_well();
  return start();
}

void TrialMachine::stop() const {
  if (has_systemd()) systemctl({"stop", kUnit}, kStopS);
}

bool TrialMachine::start() const {
  if (!has_systemd()) return true;
  systemctl({"reset-failed", kUnit});
  return systemctl({"start", "--no-block", kUnit}).is_well();
}

void TrialMachine::pin(const std::string& refused_all) const {
  const std::string folder = path("/etc/apt/preferences.d");
  if (access(folder.c_str(), F_OK) != 0) return;
  const std::string place = folder + "/bess-edge-rolled-back.pref";
  std::string text;
  for (std::size_t at = 0; at < refused_all.size();) {
    const std::size_t end = std::min(refused_all.find(' ', at), refused_all.size());
    text += "Package: bess-edge\nPin: version ";
    text.append(refused_all, at, end - at).append("\nPin-Priority: -1\n\n");
    at = end + 1;
  }
  if (text.empty()) {
    unlink(place.c_str());
  } else if (text_of(place) != text) {
    static_cast<void>(replace_file_durably(place.c_str(), text));
  }
}

}  // namespace bess
