#include "edge/update/version_proof.h"

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <string_view>

#include "edge/update/texts.h"
#include "edge/update/version_store.h"
#include "shared/file_descriptor.h"
#include "shared/host/json.h"
#include "shared/host/run_program.h"

namespace bess {
namespace {

constexpr std::int64_t kProgramS = 60;  ///< a Pi replays its days in two seconds

/// The value of "name=value" among words.
std::string word_of(std::string_view text, std::string_view name) {
  const std::size_t at = text.find(name);
  if (at == std::string_view::npos) return "";
  const std::string_view rest = text.substr(at + name.size());
  return std::string(rest.substr(0, rest.find_first_of(" \n")));
}

bool is_certified(const std::string& folder, std::string& error) {
  const std::string header = folder + "/share/student_weights.h";
  const ProgramResult sum = run_and_hear({"sha256sum", "--", header}, kProgramS);
  const std::string found = sum.output.substr(0, sum.output.find(' '));
  const std::string claimed = certificate_fact(folder, "header_sha256");
  if (!sum.is_well() || claimed.empty() || found != claimed) {
    return refuse(error, {"its certificate is of another header: not what was proved"});
  }
  const ProgramResult decided = run_and_hear({folder + "/bin/bess-edge", "signature"}, kProgramS);
  if (!decided.is_well()) {
    return refuse(error, {"its program does not run: ", decided.complaint()});
  }
  for (const char* const member : {"signature", "student"}) {
    const std::string told = word_of(decided.output, std::string(member) + "=");
    const std::string wanted = certificate_fact(folder, member);
    if (!told.empty() && told == wanted) continue;
    return refuse(error, {"its program has ", member, " ", told, ", its certificate ", wanted});
  }
  return true;
}

/// The settings as they will be read once this version runs: with its own maps.
bool takes_settings(const ProofPlaces& places, std::string& error) {
  if (access(places.settings.c_str(), F_OK) != 0) return true;  // the unit waits for them
  std::string text = text_of(places.settings);
  const std::string from = places.share + "/";
  const std::string to = places.version_folder + "/share/";
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at)) {
    text.replace(at, from.size(), to);
    at += to.size();
  }
  std::string trial = places.settings + ".XXXXXX";  // beside them: paths in them may be relative
  const FileDescriptor file(
      mkostemp(trial.data(), O_CLOEXEC));  // for root alone: there may be secrets in it
  const bool is_written = file.get() >= 0 && write(file.get(), text.data(), text.size()) ==
                                                 static_cast<ssize_t>(text.size());
  const std::string& read = is_written ? trial : places.settings;
  const ProgramResult run = run_and_hear(
      {places.version_folder + "/bin/bess-edge", "status", "--json", "--no-lock", "--config", read},
      kProgramS);
  unlink(trial.c_str());
  // Its exit code tells of the controller; that it tells at all is what counts.
  if (run.output.find("\"health\"") != std::string::npos) return true;
  std::string why = run.complaint();
  for (std::size_t at = why.find(trial); at != std::string::npos; at = why.find(trial)) {
    why.replace(at, trial.size(), places.settings);
  }
  return refuse(error, {"it refuses this machine's settings: ", why});
}

}  // namespace

std::string certificate_fact(const std::string& version_folder, const char* member) {
  const Json certificate = Json::parse(text_of(version_folder + "/share/certificate.json"));
  return certificate.value()[member].text_or("");
}

bool is_proved(const ProofPlaces& places, std::string& error) {
  return VersionStore::is_whole(places.version_folder, error) &&
         is_certified(places.version_folder, error) && takes_settings(places, error);
}

}  // namespace bess
