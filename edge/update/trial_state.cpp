#include "edge/update/trial_state.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>

#include "edge/log/journal.h"
#include "edge/log/text_checksum.h"
#include "edge/log/whole_file.h"
#include "edge/update/texts.h"
#include "shared/host/text.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

using S = TrialState;

struct TextKey {
  std::string_view key;
  std::string S::*member;
};
constexpr TextKey kTexts[] = {{"version", &S::version},         {"previous", &S::previous},
                              {"announced", &S::announced},     {"refused", &S::refused},
                              {"refused_all", &S::refused_all}, {"reason", &S::reason},
                              {"since_utc", &S::since_utc},     {"boot", &S::boot},
                              {"delivered", &S::delivered},     {"mark", &S::mark},
                              {"window", &S::window},           {"shared", &S::shared},
                              {"bad_cause", &S::bad_cause}};
struct NumberKey {
  std::string_view key;
  std::int64_t S::*member;
};
/// `needed` is the last line: a text of an older program, without checksum, is whole when it ends
/// with it.
constexpr NumberKey kNumbers[] = {
    {"good", &S::good_cycles}, {"elapsed_s", &S::elapsed_s}, {"rest_s", &S::rest_s},
    {"bad_run", &S::bad_run},  {"same", &S::same},           {"other", &S::other},
    {"boots", &S::boots},      {"restarts", &S::restarts},   {"passed", &S::passed},
    {"worse", &S::worse},      {"needed", &S::needed_cycles}};
struct FlagKey {
  std::string_view key;
  bool S::*member;
};
constexpr FlagKey kFlags[] = {{"fresh", &S::is_fresh}, {"handed_over", &S::is_handed_over}};

constexpr std::size_t kValueBytesMax = 400;

std::int64_t whole_of(std::string_view text) {
  std::int64_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

void take_state_line(std::string_view line, TrialState& state) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return;
  const std::string_view key = line.substr(0, equals);
  const std::string_view value = line.substr(equals + 1);
  if (key == "phase") state.phase = trial_phase_of(value);
  for (const TextKey& text : kTexts) {
    if (text.key == key) state.*text.member = value;
  }
  for (const NumberKey& number : kNumbers) {
    if (number.key == key) state.*number.member = whole_of(value);
  }
  for (const FlagKey& flag : kFlags) {
    if (flag.key == key) state.*flag.member = value == "1";
  }
}

std::string state_text(const TrialState& state) {
  std::string text = "phase=";
  text.append(trial_phase_name(state.phase)).append("\n");
  const auto add = [&](std::string_view key, std::string_view value) {
    text.append(key).append("=").append(value).append("\n");
  };
  for (const TextKey& key : kTexts) add(key.key, one_line(state.*key.member, kValueBytesMax));
  for (const FlagKey& key : kFlags) add(key.key, state.*key.member ? "1" : "0");
  for (const NumberKey& key : kNumbers) add(key.key, std::to_string(state.*key.member));
  text.append(checksum_end(text, kCommentChecksum).view());
  return text;
}

/// 0, or an errno.
int read_all_of(const std::string& path, std::string& text) {
  errno = 0;
  std::ifstream file(path);
  if (!file) return errno == 0 ? EIO : errno;
  std::ostringstream bytes;
  bytes << file.rdbuf();
  text = bytes.str();
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored) ? EISDIR : 0;
}

std::string why_hidden(const std::string& path) {
  return path + " cannot be read by this user; sudo chmod a+r makes it readable";
}

bool is_hexadecimal(std::string_view text) {
  return text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

/// Of a text without a checksum: what was not written here.
bool is_plausible(const UpdateEvent& event) {
  std::int64_t utc_s = 0;
  return parse_utc(event.utc, utc_s) &&
         std::find(std::begin(kUpdateEvents), std::end(kUpdateEvents), event.event) !=
             std::end(kUpdateEvents) &&
         is_hexadecimal(event.student) && is_hexadecimal(event.header_sha256);
}

/// One of the two files.
struct StateText {
  std::string text;
  bool is_there = false;
  bool is_hidden = false;    ///< from this user
  bool is_readable = false;  ///< a text, which its checksum does not contradict
  bool is_whole = false;     ///< by its checksum, or by its last line where it has none
};

StateText read_state_text(const std::string& path) {
  StateText state;
  const int cause = read_all_of(path, state.text);
  state.is_there = cause != ENOENT;
  state.is_hidden = cause == EACCES;
  const TextState checked = check_text(state.text, kCommentChecksum);
  state.is_readable = state.text.starts_with("phase=") && checked != TextState::kBroken;
  const std::size_t last = state.text.rfind("\nneeded=");
  const bool ends_well =
      last != std::string::npos && state.text.find('\n', last + 1) == state.text.size() - 1;
  state.is_whole = checked == TextState::kIntact || (state.is_readable && ends_well);
  return state;
}

/// A folder in place of a file would keep nothing: it is set aside.
void make_way(const std::string& path) {
  std::error_code failed;
  if (!std::filesystem::is_directory(path, failed)) return;
  const std::string aside = path + ".folder";
  std::filesystem::remove_all(aside, failed);
  std::filesystem::rename(path, aside, failed);
  report(JournalLevel::kError, "%s is a folder: it is set aside as %s", path.c_str(),
         aside.c_str());
}

/// What metrics and history may hold inside quotes and between tabs.
std::string plain(std::string_view text) {
  std::string kept = one_line(text, kValueBytesMax);
  for (char& c : kept) {
    if (c == '"' || c == '\\') c = '\'';
  }
  return kept;
}

/// Empty where dpkg is content.
std::string half_installed(const TrialState& state) {
  const std::string mend = dpkg_mend(state.delivered);
  if (mend.empty()) return "";
  return joined({"dpkg has it half installed (", state.delivered, "): ", mend});
}

void add_gauge(std::string& text, std::string_view name, std::string_view help,
               std::string_view value) {
  text.append("# HELP ").append(name).append(" ").append(help).append("\n# TYPE ").append(name);
  text.append(" gauge\n").append(name).append(value).append("\n");
}

}  // namespace

ReadTrialState read_trial_state(const std::string& folder) {
  const std::string path = folder + "/state";
  const StateText main = read_state_text(path);
  const StateText copy = read_state_text(path + ".copy");
  ReadTrialState read;
  if (!main.is_there && !copy.is_there) return read;
  // Without a copy it is of a program that wrote neither that nor a checksum.
  const bool main_counts = main.is_whole || (main.is_readable && !copy.is_there);
  if (!main_counts && !copy.is_whole && (main.is_hidden || copy.is_hidden)) {
    read.state.phase = TrialPhase::kHidden;
    read.damage = read.state.reason = "the state of the upgrades is not known: " +
                                      why_hidden(main.is_hidden ? path : path + ".copy");
    return read;
  }
  if (!main_counts && !copy.is_whole) {
    read.state.phase = TrialPhase::kFailed;
    read.damage = read.state.reason =
        "the state of the upgrades is lost: " + path + " and its copy are damaged";
    return read;
  }
  if (!main_counts) read.damage = path + " is damaged: its copy counts";
  if (main_counts && copy.is_there && !copy.is_whole) read.damage = path + ".copy is damaged";
  std::istringstream lines(main_counts ? main.text : copy.text);
  for (std::string line; std::getline(lines, line);) take_state_line(line, read.state);
  return read;
}

bool write_trial_state(const std::string& folder, const TrialState& state, std::string& error) {
  const std::string path = folder + "/state";
  const std::string text = state_text(state);
  for (const std::string& place : {path, path + ".copy"}) {
    make_way(place);
    make_way(place + ".new");
    if (replace_file_durably(place.c_str(), text)) continue;
    FileMessage message;
    static_cast<void>(fail_with_errno(place.c_str(), "cannot be written", message));
    error = message.view();
    return false;
  }
  // Told again with the next state: not worth a failure.
  static_cast<void>(replace_file((folder + "/update.prom").c_str(), trial_metrics(state)));
  return true;
}

std::string trial_metrics(const TrialState& state) {
  std::string text;
  const bool is_on_trial =
      state.phase == TrialPhase::kTrying || state.phase == TrialPhase::kComparing;
  add_gauge(text, "bess_update_on_trial", "1 while an upgrade has not confirmed itself.",
            is_on_trial ? " 1" : " 0");
  add_gauge(text, "bess_update_good_cycles", "Good cycles of the version on trial.",
            " " + std::to_string(state.good_cycles));
  const auto labels = [&](const std::string& version) {
    std::string value = "{version=\"";
    value.append(plain(version)).append("\",reason=\"").append(plain(state.reason));
    return value.append("\"} 1");
  };
  if (state.phase == TrialPhase::kFailed) {
    add_gauge(text, "bess_update_failed",
              "1 while a version runs that did not confirm itself and has none before it.",
              labels(state.version));
  }
  if (!state.refused.empty()) {
    add_gauge(text, "bess_update_rolled_back",
              "1 after a version was rolled back, until another one is confirmed.",
              labels(state.refused));
  }
  return text;
}

std::string dpkg_mend(std::string_view delivered) {
  constexpr std::size_t kLetters = 3;  // dpkg-query's ${db:Status-Abbrev}: wanted, status, error
  if (delivered.size() < kLetters) return "";
  const char status = delivered[1];
  // Unpacked in part: the package itself is needed again. `configure` does not end that.
  if (delivered[2] == 'R' || status == 'H') return "apt install --reinstall bess-edge";
  const bool waits_for_scripts = status == 'U' || status == 'F' || status == 'W' || status == 't';
  return waits_for_scripts ? "dpkg --configure -a" : "";
}

std::string update_note(const TrialState& state) {
  const std::string cycles = std::to_string(state.good_cycles) + " of " +
                             std::to_string(state.needed_cycles) + " good cycles";
  const bool is_resting =
      !state.shared.empty() && is_shared(state, trial_cause_of(state.bad_cause));
  switch (state.phase) {
    case TrialPhase::kUnknown:
      return "";
    case TrialPhase::kTrying:
      return joined({state.version, " on trial since ", state.since_utc, ", ", cycles,
                     is_resting ? ", resting (" + state.bad_cause + ")" : std::string(), "; ",
                     state.previous.empty() ? "no version before it is kept"
                                            : "else back to " + state.previous});
    case TrialPhase::kComparing:
      return joined(
          {state.previous, " runs to compare it with ", state.version, ": ", state.reason});
    case TrialPhase::kConfirmed: {
      const std::string half = half_installed(state);
      return joined({state.version, " confirmed", half.empty() ? "" : "; ", half});
    }
    case TrialPhase::kUpgrading:
      return joined(
          {state.announced.empty() ? "a new version" : state.announced, " is being installed"});
    case TrialPhase::kHidden:
      return state.reason;
    case TrialPhase::kFailed:
      if (state.version.empty()) return state.reason;
      return joined({state.version, " did not confirm: ", state.reason});
    case TrialPhase::kGoingBack:
      return joined({state.refused, " is being rolled back: ", state.reason});
    case TrialPhase::kRolledBack:
      break;
  }
  // dpkg goes on believing in what it unpacked.
  const std::string half = half_installed(state);
  const bool dpkg_differs = half.empty() && state.delivered.ends_with(" " + state.refused);
  return joined({state.version, "; ", state.refused, " was rolled back: ", state.reason,
                 dpkg_differs ? " (dpkg still has it: " + state.delivered + ", it does not run)"
                              : std::string(),
                 half.empty() ? "" : "; ", half});
}

std::string update_trouble(const TrialState& state) {
  const bool ended_badly =
      state.phase == TrialPhase::kHidden || state.phase == TrialPhase::kFailed ||
      state.phase == TrialPhase::kComparing || state.phase == TrialPhase::kGoingBack ||
      state.phase == TrialPhase::kRolledBack;
  // apt installs nothing at all on such a machine, no security update either.
  const bool is_half = state.phase == TrialPhase::kConfirmed && !dpkg_mend(state.delivered).empty();
  return ended_badly || is_half ? update_note(state) : "";
}

UpdateHistory read_update_history(const std::string& folder) {
  const std::string path = folder + "/history";
  UpdateHistory history;
  std::string text;
  switch (const int cause = read_all_of(path, text)) {
    case 0:
      break;
    case ENOENT:
      history.trouble =
          folder + ": no history here: it is kept where bess-edge was installed as a package";
      return history;
    case EACCES:
      history.trouble = why_hidden(path);
      return history;
    default:
      history.trouble = path + " cannot be read: " + std::strerror(cause);
      return history;
  }
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    constexpr std::size_t kFields = 6;
    std::array<std::string, kFields> fields;
    std::size_t count = 0;
    std::size_t begin = 0;
    for (std::size_t end = 0; end != std::string::npos && count < kFields; begin = end + 1) {
      end = line.find('\t', begin);
      fields[count++] = line.substr(begin, end == std::string::npos ? end : end - begin);
    }
    const UpdateEvent event{fields[0], fields[1], fields[2], fields[3], fields[4], fields[5]};
    const bool is_torn = count != kFields || lines.eof();
    if (is_torn || !is_plausible(event)) {
      ++history.damaged_lines;
    } else {
      history.events.push_back(event);
    }
  }
  return history;
}

bool add_to_history(const std::string& folder, const UpdateEvent& event) {
  std::string line;
  for (const std::string* field : {&event.utc, &event.event, &event.version, &event.student,
                                   &event.header_sha256, &event.reason}) {
    line.append(plain(*field)).append(field == &event.reason ? "\n" : "\t");
  }
  make_way(folder + "/history");
  const int fd = open((folder + "/history").c_str(),  // NOLINT: mode_t is what open takes
                      O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0644);
  if (fd < 0) return false;
  const bool is_written = write(fd, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  const bool is_kept = is_written && fsync(fd) == 0;
  return close(fd) == 0 && is_kept;
}

}  // namespace bess
