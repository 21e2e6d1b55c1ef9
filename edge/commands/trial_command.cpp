// `bess-edge trial`: a new version on this machine, judged by the one before.
#include "edge/commands/command_list.h"
#include "edge/update/trial_run.h"

namespace bess {
namespace {

struct TrialGiven {
  std::string verb;
  std::string argument;
};

/// What is to be done, and with what; neither is an option.
template <std::string TrialGiven::*kMember>
bool take_word(void* given, std::string_view value, std::string&) {
  std::string& word = static_cast<TrialGiven*>(given)->*kMember;
  if (!word.empty() || value.starts_with('-')) return false;
  word = value;
  return !word.empty();
}
constexpr CommandOption kOptions[] = {{"", false, take_word<&TrialGiven::verb>},
                                      {"", false, take_word<&TrialGiven::argument>}};

constexpr const char* kHelp =
    R"(bess-edge trial: judges a new version on this machine, and goes back to the one before

  bess-edge trial announce VERSION    before dpkg unpacks it (preinst); exit code 1: it was rolled
                                      back here
  bess-edge trial withdraw VERSION    dpkg has given that up (postrm, postinst): no fault of its
                                      own
  bess-edge trial begin               after dpkg has delivered it (postinst): proved, kept, handed
                                      over to
  bess-edge trial supervise           until it has confirmed itself or is rolled back
                                      (bess-trial.service)
  bess-edge trial look                one look of that, for a supervisor of one's own
  bess-edge trial recover             at boot, before the controller (bess-recover.service)
  bess-edge trial go-back REASON      by hand, to the version before
  bess-edge trial dismiss             after a roll-back: health tells of it no longer
  bess-edge trial allow VERSION       let in again what was rolled back

The versions are folders in /var/lib/bess-edge/versions; "current" there is a link to the one that
runs. The limits are in /etc/bess/update.conf. Needs root. edge/update/README.md.
Exit codes: 0 done   1 refused or failed: the line says why   2 the command line is bad

  bess-edge trial go-back "it trades too much"
)";

const char* complaint(const TrialGiven& given) {
  return given.verb.empty() ? "trial needs what is to be done, such as trial look" : nullptr;
}

int run_trial(const TrialGiven& given, SettingsFile&) {
  return run_trial_verb(given.verb, given.argument);
}

}  // namespace

const EdgeCommand kTrialCommand = {.name = "trial",
                                   .usage = "trial ...",
                                   .does = "judges a new version, goes back to the one before",
                                   .help = kHelp,
                                   .options = kOptions,
                                   .settings = EdgeCommand::Settings::kNone,
                                   .run = run_with<TrialGiven, run_trial, complaint>};

}  // namespace bess
