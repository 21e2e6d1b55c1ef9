#include "edge/storage/update_state.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>

#include "edge/log/text_checksum.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

std::int64_t whole_of(std::string_view text) {
  std::int64_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

void take_line(std::string_view line, UpdateState& state) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return;
  const std::string_view key = line.substr(0, equals);
  const std::string_view value = line.substr(equals + 1);
  struct Text {
    std::string_view key;
    std::string UpdateState::*member;
  };
  constexpr Text kTexts[] = {
      {"phase", &UpdateState::phase},       {"version", &UpdateState::version},
      {"previous", &UpdateState::previous}, {"refused", &UpdateState::refused},
      {"reason", &UpdateState::reason},     {"since_utc", &UpdateState::since_utc}};
  for (const Text& text : kTexts) {
    if (text.key == key) state.*text.member = value;
  }
  if (key == "good") state.good_cycles = whole_of(value);
  if (key == "needed") state.needed_cycles = whole_of(value);
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

/// Of a text without a checksum: what bess-update would not have written.
bool is_plausible(const UpdateEvent& event) {
  constexpr std::string_view kEvents[] = {"trying",      "confirmed", "going_back",
                                          "rolled_back", "failed",    "dismissed"};
  std::int64_t utc_s = 0;
  return parse_utc(event.utc, utc_s) &&
         std::find(std::begin(kEvents), std::end(kEvents), event.event) != std::end(kEvents) &&
         is_hexadecimal(event.student) && is_hexadecimal(event.header_sha256);
}

/// One of the two files, as bess-update writes them.
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

}  // namespace

UpdateState read_update_state(const std::string& folder) {
  const std::string path = folder + "/state";
  const StateText main = read_state_text(path);
  const StateText copy = read_state_text(path + ".copy");
  UpdateState state;
  if (!main.is_there && !copy.is_there) return state;
  // Without a copy it is of a bess-update that wrote neither that nor a checksum.
  const bool main_counts = main.is_whole || (main.is_readable && !copy.is_there);
  if (!main_counts && !copy.is_whole && (main.is_hidden || copy.is_hidden)) {
    state.phase = "hidden";
    state.reason = "the state of the upgrades is not known: " +
                   why_hidden(main.is_hidden ? path : path + ".copy");
    return state;
  }
  if (!main_counts && !copy.is_whole) {
    state.phase = "failed";
    state.reason = "the state of the upgrades is lost: " + path + " and its copy are damaged";
    return state;
  }
  std::istringstream lines(main_counts ? main.text : copy.text);
  for (std::string line; std::getline(lines, line);) take_line(line, state);
  return state;
}

std::string update_note(const UpdateState& state) {
  const std::string cycles =
      std::to_string(state.good_cycles) + " of " + std::to_string(state.needed_cycles);
  const std::string refused = state.refused + " was rolled back: " + state.reason;
  if (state.phase.empty()) return "";
  if (state.phase == "trying") {
    const std::string way_back =
        state.previous.empty() ? "no version before it is kept" : "else back to " + state.previous;
    return state.version + " on trial since " + state.since_utc + ", " + cycles + " good cycles; " +
           way_back;
  }
  if (state.phase == "confirmed") return state.version + " confirmed";
  if (state.phase == "upgrading") return "a new version is being installed";
  if (state.phase == "hidden") return state.reason;
  if (state.phase == "failed" && state.version.empty()) return state.reason;
  if (state.phase == "failed") return state.version + " did not confirm: " + state.reason;
  if (state.phase == "going_back") return state.refused + " is being rolled back: " + state.reason;
  return state.version + "; " + refused;
}

std::string update_trouble(const UpdateState& state) {
  const bool ended_badly = state.phase == "hidden" || state.phase == "failed" ||
                           state.phase == "going_back" || state.phase == "rolled_back";
  return ended_badly ? update_note(state) : "";
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

}  // namespace bess
