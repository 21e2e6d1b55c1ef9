// `bess-edge trial`: the supervisor of upgrades on the device itself. What is decided: trial.h;
// what is kept: trial_state.h, version_store.h.
#pragma once

#include <string>

namespace bess {

/// `verb`: announce VERSION, begin, supervise, look, recover, go-back REASON, dismiss, allow
/// VERSION. Exit codes: 0 done, 1 refused or failed: the line says why, 2 the command line is bad.
int run_trial_verb(const std::string& verb, const std::string& argument);

}  // namespace bess
